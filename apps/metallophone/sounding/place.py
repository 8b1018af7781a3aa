"""Where a plate is struck, and how its modes move there."""

from collections.abc import Sequence

import numpy as np

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.errors import UserError
from restshape.mesh.transfer import Transfer

ROUND = 0.1
"""Share of a triangle's height by which a curved outline may lie outside it."""


def mode_shapes(analysis: ModalAnalysis) -> np.ndarray:
    """Displacements (k, n, 3) of the plane nodes in the modes that the scene asks for, each of unit modal mass."""
    state = analysis.state
    return state.body.shapes(state.modes.vectors[state.modes.chosen])


def struck_place(analysis: ModalAnalysis, at: Sequence[float] | None) -> tuple[np.ndarray, np.ndarray]:
    """The place (2,) [m] that is struck, and how far each mode (k,) moves there, along the blow.

    A mallet strikes plates and solids at right angles to their plane, so that modes in the plane hardly sound. Models
    that know motion in the plane alone are struck along the motion of each mode.

    Args:
        analysis: of a frame.
        at: the place [m]; None: the node inside at which mode 1 moves most.

    Raises:
        UserError: the place is off the plate, or in a hole of it.
    """
    space, shapes = analysis.space, mode_shapes(analysis)
    if at is None:
        size = np.linalg.norm(shapes[0], axis=1)
        size[np.unique(space.facets)] = 0.0
        node = int(np.argmax(size))
        return space.X[node].copy(), _along_blow(analysis, shapes[:, node])
    place = np.array(at, dtype=float)
    if not on_plate(space.X[space.cells[:, :3]], place):
        (left, low), (right, high) = space.X.min(axis=0), space.X.max(axis=0)
        what = f"({at[0]:g}, {at[1]:g}) m lies off the plate, or in a hole of it"
        spans = f"it goes from {left:.4g} to {right:.4g} m along x, from {low:.4g} to {high:.4g} m along y"
        raise UserError(what, f"--at {at[0]:g} {at[1]:g}", f"name a place on the plate, in metres: {spans}")
    by_node = shapes.transpose(1, 0, 2).reshape(len(space.X), -1)
    moved = Transfer(space, place[None])(by_node).reshape(-1, 3)
    return place, _along_blow(analysis, moved)


def _along_blow(analysis: ModalAnalysis, moved: np.ndarray) -> np.ndarray:
    """The sizes (k,) of displacements (k, 3) along a blow."""
    return np.abs(moved[:, 2]) if "z" in analysis.state.body.axes else np.linalg.norm(moved, axis=1)


def on_plate(corners: np.ndarray, place: np.ndarray) -> bool:
    """Whether a place (2,) lies in one of the triangles (ne, 3, 2), or just outside, where the outline is curved."""
    a, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    area, to = np.cross(u, v), place - a
    s, t = np.cross(to, v) / area, np.cross(u, to) / area
    return bool((np.minimum(np.minimum(s, t), 1.0 - s - t) >= -ROUND).any())
