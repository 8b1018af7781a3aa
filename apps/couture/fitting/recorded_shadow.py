"""The shadow of a recorded drape."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from restshape.errors import UserError
from restshape.export.edited_frame import row_of
from restshape.export.frame_mesh import mesh_of_recording
from restshape.physics.cloth.drape_shadow import DrapeShadow, ShadowEdge, count_folds
from restshape.replay.recording import Recording


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
        UserError: there is no such frame, or it is not of cloth in space.
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
    shadow = DrapeShadow(mesh.cells, _border(mesh.cells))
    edge = shadow.edge(places, shadow.middle(places))
    return RecordedShadow(row, count, edge, shadow.area(places), count_folds(edge.radii))


def _border(cells: np.ndarray) -> np.ndarray:
    """Edges (k, 2) that one triangle of cells (m, 3) has."""
    sides = np.sort(np.concatenate([cells[:, [0, 1]], cells[:, [1, 2]], cells[:, [2, 0]]]), axis=1)
    edges, counts = np.unique(sides, axis=0, return_counts=True)
    return edges[counts == 1]
