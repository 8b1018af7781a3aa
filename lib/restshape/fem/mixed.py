"""Several fields with nodes of their own over one space, such as a velocity on all nodes and a pressure on corners."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from restshape.fem.space import Space
from restshape.mesh.lagrange_space import EdgeInterpolation
from restshape.mesh.mesh import Mesh
from restshape.mesh.transfer import Transfer
from restshape.shape.outline import Outline

Layout = Sequence[tuple[str, int, int]]
"""Of each field its name, on how many nodes of a cell it lives, the first ones, and its components; see `Element`."""


class MixedSpace:
    """A `Space` whose unknowns are single numbers, rows of x (m, 1), field by field on the nodes that have it.

    The unknowns of a node follow each other, so that those of each rank are contiguous as its nodes are.

    Args:
        base: nodes and cells, by reference.
        layout: of the element that reads the unknowns: its `layout`.

    Attributes:
        dofs: (ne, k) int32 unknowns of each cell, in the layout's order: field after field, in a field node after node.
        node_offsets: (ranks + 1,) int32 unknowns of rank r are node_offsets[r]:node_offsets[r + 1].
        node: (m,) the node that each unknown is at.
    """

    def __init__(self, base: Space, layout: Layout) -> None:
        self.base, self.layout = base, tuple(layout)
        n = len(base.X)
        counts = np.zeros(n, dtype=np.int64)
        self._place: dict[str, np.ndarray] = {}
        for name, nodes, components in self.layout:
            place = np.full(n, -1)
            with_field = np.unique(base.cells[:, :nodes])
            place[with_field] = counts[with_field]
            self._place[name] = place
            counts[with_field] += components
        self._first = np.concatenate([[0], np.cumsum(counts)])
        self.node = np.repeat(np.arange(n), counts)
        self.node_offsets = self._first[base.node_offsets].astype(np.int32)
        self.dofs = self._dofs_of(base.cells)

    # --- fields -------------------------------------------------------------------------------------------------------

    def rows(self, name: str, nodes: np.ndarray | None = None) -> np.ndarray:
        """The unknowns (k, components) of a field at nodes (k,), by default at all that have it, in their order.

        Raises:
            ValueError: one of the nodes does not have the field.
        """
        place, components = self._place[name], next(many for known, _, many in self.layout if known == name)
        nodes = np.flatnonzero(place >= 0) if nodes is None else nodes
        if np.any(place[nodes] < 0):
            raise ValueError(f"the field {name!r} does not live on all of these nodes")
        return (self._first[nodes] + place[nodes])[:, None] + np.arange(components)

    def values(self, name: str, x: np.ndarray) -> np.ndarray:
        """A field (k, components) of unknowns x (m, 1), on the nodes that have it, in their order."""
        return x[:, 0][self.rows(name)]

    def _dofs_of(self, cells: np.ndarray) -> np.ndarray:
        parts = [self.rows(name, cells[:, :nodes].ravel()).reshape(len(cells), -1) for name, nodes, _ in self.layout]
        return np.ascontiguousarray(np.hstack(parts), dtype=np.int32)

    # --- as a space ---------------------------------------------------------------------------------------------------

    @property
    def dof_X(self) -> np.ndarray:
        """Material coordinates (m, d) [m] of the node that each unknown is at."""
        return self.base.X[self.node]

    @property
    def dim(self) -> int:
        """Of the cells."""
        return self.base.dim

    @property
    def cell_type(self) -> str:
        """Shape and order of the cells."""
        return self.base.cell_type

    @property
    def X(self) -> np.ndarray:
        """Material coordinates (n, d) [m] of the nodes."""
        return self.base.X

    @property
    def cells(self) -> np.ndarray:
        """Nodes (ne, k) of the cells."""
        return self.base.cells

    @property
    def corners(self) -> np.ndarray:
        """Corners (ne, c) of the cells."""
        return self.base.corners

    @property
    def cell_region(self) -> np.ndarray:
        """0, or i + 1 for the i-th region of the outline (ne,)."""
        return self.base.cell_region

    @property
    def topology(self) -> int:
        """Version of the connectivity."""
        return self.base.topology

    @property
    def geometry(self) -> int:
        """Version of the positions."""
        return self.base.geometry

    @property
    def outline(self) -> Outline:
        """The outline whose entities the mesh resolves."""
        return self.base.outline

    @property
    def mesh(self) -> Mesh:
        """The plane mesh below."""
        return self.base.mesh

    @property
    def interpolations(self) -> tuple[EdgeInterpolation, ...]:
        """What flips did to nodes since the last solution."""
        return self.base.interpolations

    def nodes_of(self, name: str) -> np.ndarray:
        """Nodes of an entity; see `Space.nodes_of`."""
        return self.base.nodes_of(name)

    def cells_of(self, name: str) -> np.ndarray:
        """Cells inside an entity; see `Space.cells_of`."""
        return self.base.cells_of(name)

    def at_dofs(self, field: np.ndarray) -> np.ndarray:
        """A field (n, k) of the nodes as one (m, k) of the unknowns: of each that of its node."""
        return field[self.node]

    def project(self, old: MixedSpace, field: np.ndarray) -> np.ndarray:
        """Unknowns (m, 1) from those (m_old, 1) of another mesh: each field by itself, on its own cells."""
        found = np.zeros((len(self.node), 1))
        for name, nodes, _ in self.layout:
            rows = self.rows(name)
            # Corners are numbered in the order of the mesh's nodes.
            cells = old.base if nodes == old.cells.shape[1] else old.mesh
            found[rows, 0] = Transfer(cells, self.X[self.node[rows[:, 0]]])(old.values(name, field))
        return found

    def follow(self, changed: np.ndarray) -> np.ndarray:
        """Go where the mesh below is; the cells that are others than before. Corners stay corners under flips."""
        cells = self.base.follow(changed)
        self.dofs[cells] = self._dofs_of(self.base.cells[cells])
        return cells

    def interpolate(self, field: np.ndarray, interpolations: tuple[EdgeInterpolation, ...]) -> np.ndarray:
        """Unknowns (m, 1) after flips: fields on all nodes of cells at their new places, those on corners as they are.

        Args:
            field: before the flips; it stays as it is.
            interpolations: what the flips did, in their order.
        """
        found = field.copy()
        for name, nodes, _ in self.layout:
            if nodes == self.cells.shape[1]:
                rows = self.rows(name)
                found[rows, 0] = self.base.interpolate(field[rows, 0], interpolations)
        return found
