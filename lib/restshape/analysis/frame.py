"""What an analysis knows of a frame."""

from dataclasses import dataclass

import numpy as np

from restshape.mesh.lagrange_space import EdgeInterpolation, LagrangeSpace, interpolated
from restshape.mesh.mesh import Mesh
from restshape.mesh.reach import MovingPart
from restshape.scene.model import Scene


@dataclass
class Frame:
    """One frame as an analysis sees it.

    Args:
        mesh: nodes at their new places, of second order where the scene asks for it.
        changed_cells: (k,) int32 cells that flips have changed since the last frame.
        old_mesh: the mesh before this one, when the mesh is rebuilt in this frame.
        scene: with the values that hold now.
        hand: the gesture, and the place of the hand in its coordinates.
        interpolations: second order: what flips did to nodes in the middle of edges of the mesh solved on last.
        edit_ended: an edit has come to its end in this frame, or before it.
        part: what alone moves, and has flips, for as long as it is the same; None: everything.
    """

    mesh: Mesh | LagrangeSpace
    changed_cells: np.ndarray
    old_mesh: Mesh | LagrangeSpace | None
    scene: Scene
    hand: tuple[object, tuple[float, float]]
    interpolations: tuple[EdgeInterpolation, ...] = ()
    edit_ended: bool = False
    part: MovingPart | None = None

    def interpolate(self, field: np.ndarray) -> np.ndarray:
        """A field (n, f) of the last frame's solution, at nodes of flipped edges taken where they are now."""
        return interpolated(field, self.interpolations)
