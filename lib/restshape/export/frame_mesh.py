"""The mesh of one frame with its fields: from a recording, or generated for the shape."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from restshape.application import application_of
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.generate import generate
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.replay.recording.recording import Recording
from restshape.scene.model import Scene
from restshape.scene.plan import plan
from restshape.shape.outline import Outline

CELL_TYPES = {5: "triangle", 22: "triangle6", 10: "tetra", 24: "tetra10", 12: "hexahedron"}
"""meshio's names of cells by VTK's numbers."""
PLACED = "displacement"
"""The field that moves nodes of a flat cloth into space."""


@dataclass(frozen=True, eq=False)
class Texture:
    """Places in a flat pattern as texture coordinates: u = (x - low x) / size, v = (y - low y) / size.

    Args:
        low: (2,) lower corner of the box around the pattern [m]; size: the longer side of it [m].
        values: (n, 2) u and v of the nodes, from 0 to 1.
    """

    low: np.ndarray
    size: float
    values: np.ndarray

    @property
    def words(self) -> str:
        """What they are, for people."""
        x, y = self.low
        return (
            f"texture: u = (x - {x:.9g} m) / {self.size:.9g} m, v = (y - {y:.9g} m) / {self.size:.9g} m, of the pattern"
        )


@dataclass(frozen=True, eq=False)
class FrameMesh:
    """Nodes and cells with their fields.

    Args:
        X: (n, 2 or 3) rest positions [m]; cells: (ne, k) nodes of each cell, corners first.
        cell_type: as meshio names it.
        at_points: fields (n,) or (n, c) by name; in_cells: (ne,) or (ne, c).
    """

    X: np.ndarray
    cells: np.ndarray
    cell_type: str
    at_points: dict[str, np.ndarray] = field(default_factory=dict)
    in_cells: dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def flat(self) -> bool:
        """Whether it lies in the plane, so that a body over it needs a thickness."""
        return self.X.shape[1] == 2 and self.placed is None

    @property
    def texture(self) -> Texture | None:
        """Texture coordinates of a mesh that has a flat pattern; None of another one."""
        if self.X.shape[1] != 2:
            return None
        low = self.X.min(axis=0)
        size = float(np.ptp(self.X, axis=0).max()) or 1.0
        return Texture(low, size, (self.X - low) / size)

    @property
    def placed(self) -> np.ndarray | None:
        """Positions (n, 3) [m] of a flat mesh whose nodes a displacement moves in space; None of another one."""
        moved = self.at_points.get(PLACED)
        if moved is None or moved.ndim != 2 or moved.shape[1] != 3 or self.X.shape[1] != 2:
            return None
        return np.column_stack([self.X, np.zeros(len(self.X))]) + moved


def mesh_of_recording(recording: Recording, row: int) -> FrameMesh:
    """The mesh and the fields of a recorded frame.

    Raises:
        UserError: the cells are of a kind that is not known here.
    """
    number = recording.cell_type(row)
    if number not in CELL_TYPES:
        raise UserError(f"its cells are of VTK's type {number}", str(recording.path), "replay the scene again")
    fields = {name: info for name, info in recording.fields.items() if info.first_frame <= row}
    at = {
        where: {name: recording.field(row, name) for name, info in fields.items() if info.where == where}
        for where in ("point_data", "cell_data")
    }
    return FrameMesh(*recording.mesh(row), CELL_TYPES[number], at["point_data"], at["cell_data"])


def mesh_of_shape(scene: Scene, outline: Outline) -> FrameMesh:
    """A new mesh of a shape, triangles of the scene's sizes and element order, with the region of each.

    Raises:
        UserError: the shape cannot be meshed.
    """
    order = 1 if scene.mesh.levels > 1 else plan(scene, application_of(scene)).order
    try:
        mesh = generate(outline, scene.mesh.model_copy(update={"order": order}))
    except ReplayProblem as problem:
        raise UserError(str(problem), str(scene.path), "change mesh.size") from problem
    regions = {"region": mesh.cell_region}
    if order == 1:
        return FrameMesh(mesh.X, mesh.cells, "triangle", in_cells=regions)
    space = LagrangeSpace(mesh)
    return FrameMesh(space.X, space.cells, "triangle6", in_cells=regions)
