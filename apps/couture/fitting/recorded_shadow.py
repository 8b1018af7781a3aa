"""The shadow of a recorded drape."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restshape.errors import UserError
from restshape.export.edited_frame import row_of
from restshape.export.frame_mesh import mesh_of_recording
from restshape.physics.cloth.drape_shadow import DrapeShadow, ShadowEdge, count_folds
from restshape.replay.recording.recording import Recording

NARROW = 0.02
"""Area over that of the flat cloth below which a shadow is none of a drape."""


@dataclass(frozen=True, eq=False)
class RecordedShadow:
    """The shadow of a frame.

    Args:
        row: of the frame; count: of frames.
        edge: of the shadow; area: of it [m^2]; folds: around it.
    """

    row: int
    count: int
    edge: ShadowEdge
    area: float
    folds: int


def recorded_shadow(path: Path, frame: int) -> RecordedShadow:
    """The shadow of a frame of a recording, as it is seen from the middle of its border.

    Raises:
        UserError: there is no such frame, or it is not of cloth in space, or hangs upright.
    """
    with Recording(path) as recording:
        if not recording.n:
            raise UserError("the recording holds no frames", str(path), "run the replay again")
        row = row_of(frame, recording.n, "the recording")
        mesh = mesh_of_recording(recording, row)
        count = recording.n
    places = mesh.placed
    if places is None or not np.isfinite(places).all():
        raise UserError("the recording is not of cloth in space", str(path), "name one of a scene of couture")
    edge, area = shadow_of(mesh.X, mesh.cells, places, f"{path}, frame {row}")
    return RecordedShadow(row, count, edge, area, count_folds(edge.radii))


def shadow_of(X: np.ndarray, cells: np.ndarray, places: np.ndarray, where: str) -> tuple[ShadowEdge, float]:
    """The edge of a cloth's shadow and its area [m^2].

    Args:
        X: (n, 2) rest positions [m]; cells: (m, 3) triangles; places: (n, 3) of the nodes [m].
        where: it is from.

    Raises:
        UserError: it is no outline around its middle.
    """
    shadow = DrapeShadow(cells, outer_border(X, cells))
    edge, area = shadow.edge(places, shadow.middle(places)), shadow.area(places)
    bare, share = int((edge.radii <= 0.0).sum()), 2.0 * area / float(np.abs(_twice_areas(X, cells)).sum())
    if share < NARROW:
        what = f"the shadow has {100 * share:.2g} % of the area of the flat cloth: it hangs upright"
    elif bare:
        what = f"there is no cloth in {100 * bare / len(edge.radii):.2g} % of the directions from the shadow's middle"
    else:
        return edge, area
    raise UserError(what, where, "name a frame in which the cloth lies around its support (--frame)")


def outer_border(X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Edges (k, 2) around the pieces of a flat cloth, without those of holes.

    Args:
        X: (n, 2) rest positions [m].
        cells: (m, 3) triangles, either way round.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    left = np.where((_twice_areas(X, cells) > 0.0)[:, None], cells, cells[:, [0, 2, 1]])
    sides = np.concatenate([left[:, [0, 1]], left[:, [1, 2]], left[:, [2, 0]]])
    _, first, counts = np.unique(np.sort(sides, axis=1), axis=0, return_index=True, return_counts=True)
    found = sides[first[counts == 1]]
    a, b = X[found[:, 0]], X[found[:, 1]]
    links = coo_array((np.ones(len(found)), found.T), shape=(len(X), len(X)))
    loop = connected_components(links, directed=False)[1][found[:, 0]]
    # Cloth is left of its border: loops around holes go the other way.
    areas = np.bincount(loop, a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return found[areas[loop] > 0.0]


def _twice_areas(X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Twice the areas (m,) [m^2] of flat triangles, positive counter-clockwise."""
    a, b = X[cells[:, 1]] - X[cells[:, 0]], X[cells[:, 2]] - X[cells[:, 0]]
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
