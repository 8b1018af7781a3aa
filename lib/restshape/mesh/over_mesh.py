"""What spaces have in common: counts of their nodes and cells, and what those over a mesh take from it."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from restshape.mesh.transfer import FieldNodes, transfer
from restshape.shape.outline import Outline


class Base(Protocol):
    """What is asked of a mesh, or of a space, that others are over."""

    @property
    def outline(self) -> Outline: ...
    @property
    def topology(self) -> int: ...
    @property
    def cell_region(self) -> np.ndarray: ...
    def cells_of(self, name: str) -> np.ndarray: ...


class NodesAndCells:
    """Nodes at `X` (n, d) and cells (ne, k) of them, each with the unknowns of its own nodes."""

    X: np.ndarray
    cells: np.ndarray
    dim: int

    @property
    def n_nodes(self) -> int:
        """Number of nodes."""
        return len(self.X)

    @property
    def n_cells(self) -> int:
        """Number of cells."""
        return len(self.cells)

    @property
    def dofs(self) -> np.ndarray:
        """Nodes (ne, k) whose unknowns a cell has: its own."""
        return self.cells

    @property
    def dof_X(self) -> np.ndarray:
        """Material coordinates (n, d) [m] of the nodes that have unknowns: all of them."""
        return self.X

    def at_dofs(self, field: np.ndarray) -> np.ndarray:
        """A field (n, k) of the nodes by the rows of unknowns: as it is."""
        return field

    def project(self, old: FieldNodes, field: np.ndarray) -> np.ndarray:
        """Unknowns (n, f) of another space at the nodes of this one; see `transfer`."""
        return transfer(old, self, field)


class OverMesh(NodesAndCells):
    """Nodes and cells over a mesh, whose entities and connectivity they have.

    Args:
        base: the mesh, or the space, that they are over.
    """

    def __init__(self, base: Base) -> None:
        self.base = base

    @property
    def outline(self) -> Outline:
        """The outline whose entities the mesh resolves."""
        return self.base.outline

    @property
    def topology(self) -> int:
        """Version of the connectivity."""
        return self.base.topology

    @property
    def cell_region(self) -> np.ndarray:
        """Region (ne,) of each cell, see `Mesh`."""
        return self.base.cell_region

    def cells_of(self, name: str) -> np.ndarray:
        """Cells inside an entity; see `Mesh.cells_of`.

        Raises:
            UserError: there is no such entity.
        """
        return self.base.cells_of(name)
