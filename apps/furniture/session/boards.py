"""What stands for a mesh where planks have none: their boxes, one hexahedron each."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter

import numpy as np
from restshape_apps.furniture.session.plank_frame import PlankFrame

from restshape.mesh.advance import MeshUpdate

CORNERS = np.array([0, 4, 6, 2, 1, 5, 7, 3], dtype=np.int32)
"""Corners of a plank, as `Plank.corners` counts them, in VTK's order of a hexahedron."""


@dataclass(eq=False)
class Boards:
    """The planks of a frame.

    Args:
        frame: of the session.
        X: (8 n, 3) corners [m].
        cells: (n, 8) of each plank.
        topology: number of their layout.
    """

    frame: PlankFrame
    X: np.ndarray
    cells: np.ndarray
    topology: int
    interpolations: tuple[()] = ()


class MovingBoards:
    """The planks of a session, frame after frame; moved ones are level 1, others idle."""

    def __init__(self) -> None:
        self.mesh: Boards | None = None
        self._before: Boards | None = None
        self._topology = 0

    @property
    def field_mesh(self) -> Boards:
        """Where fields live."""
        return self.mesh

    def area(self) -> float:
        """Planks have no mesh in the plane."""
        return float("nan")

    def other_meshes(self, old: Boards | None) -> tuple[()]:
        """None: planks are no mesh of which there could be another one."""
        return ()

    @property
    def linear_motion(self) -> None:
        """None: forces of feet and joints are not linear in the hand."""

    def solved(self) -> None:
        """Nothing: planks have no edges that flip."""

    def update(self, frame: PlankFrame) -> MeshUpdate:
        """Take in a frame."""
        start = perf_counter()
        self._before = old = self.mesh
        same = old is not None and old.frame.design is frame.design and np.array_equal(old.frame.gamma, frame.gamma)
        if same:
            self.mesh = Boards(frame, old.X, old.cells, old.topology)
            return MeshUpdate.nothing()
        furniture = frame.design.furniture
        if old is None or len(old.cells) != furniture.count:
            self._topology += 1
            cells = 8 * np.arange(furniture.count, dtype=np.int32)[:, None] + CORNERS
        else:
            cells = old.cells
        self.mesh = Boards(frame, furniture.corners(frame.gamma), cells, self._topology)
        advance = MeshUpdate.nothing()
        moves = frame.change not in ("start", "none", "values")
        stages = {"relocate": perf_counter() - start}
        return MeshUpdate(int(moves), 0, advance.changed_cells, advance.min_quality, stages=stages)

    def rollback(self) -> None:
        """Restore the frame before the last one."""
        self.mesh = self._before
