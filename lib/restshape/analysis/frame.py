"""What an analysis is told of a frame."""

from dataclasses import dataclass

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.scene.model import Scene


@dataclass
class Frame:
    """One frame as an analysis sees it.

    Args:
        mesh: nodes at their new places.
        changed_cells: (k,) int32 cells that flips have changed since the last frame.
        old_mesh: the mesh before this one, when the mesh was made anew in this frame.
        scene: with the values that hold now.
        hand: the gesture, and the place of the hand in its coordinates.
    """

    mesh: Mesh
    changed_cells: np.ndarray
    old_mesh: Mesh | None
    scene: Scene
    hand: tuple[object, tuple[float, float]]
