"""Extremes of nodal unknowns over an entity, which may lie between its nodes, and values at single ones."""

from dataclasses import dataclass

import numpy as np

from restshape.fem.facets import facet_basis
from restshape.fem.observer import REDUCTIONS, Function
from restshape.fem.space import PlaneSpace
from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.scene.model import Quantity

PARTS = 10
"""Of a side of second order, in which an extreme between its nodes is looked for."""

EXTREMES = ("max", "min", "absmax", "peak")
"""Reductions without a derivative: another mesh may have the extreme elsewhere."""


@dataclass(frozen=True, eq=False)
class Extreme:
    """A function of a state: the extreme of the unknowns at nodes, or of their length where several columns count.

    Args:
        value: of the state, at nodes alone.
        space: of first or second order.
        quantity: says which extreme it is, and where.
        nodes: (k,) at which it is taken.
        columns: of the unknowns.
    """

    value: Function
    space: PlaneSpace
    quantity: Quantity
    nodes: np.ndarray | slice
    columns: list[int]

    def __call__(self, *state: object) -> float:
        """The value at a state."""
        return self.value(*state)

    @property
    def reads(self) -> np.ndarray | None:
        """Nodes (k,) whose unknowns alone it hangs on; None: it may hang on all."""
        return None if isinstance(self.nodes, slice) else self.nodes

    def between_nodes(self, x: np.ndarray) -> float:
        """The extreme of unknowns x (n, f), in the sides or triangles of second order around the node that has it."""
        reduce = REDUCTIONS[str(self.quantity.reduce)]
        at_nodes = self._sizes(x[self.nodes])
        signed = np.abs(at_nodes) if self.quantity.reduce in ("absmax", "peak") else at_nodes
        best = np.argmin(signed) if self.quantity.reduce == "min" else np.argmax(signed)
        node = np.arange(len(x))[self.nodes][best]
        places, basis = self._around()
        own = places[(places == node).any(axis=1)]
        inside = self._sizes(np.einsum("qi,eif->eqf", basis, x[own]).reshape(-1, x.shape[1]))
        return reduce(np.concatenate([at_nodes, inside]))

    def _sizes(self, x: np.ndarray) -> np.ndarray:
        chosen = x[:, self.columns]
        return chosen[:, 0] if len(self.columns) == 1 else np.linalg.norm(chosen, axis=1)

    def _around(self) -> tuple[np.ndarray, np.ndarray]:
        """Triangles or sides (m, k) of the entity, none of a vertex; values (q, k) of their basis inside them."""
        space, at = self.space, self.quantity.at
        s = np.linspace(0.0, 1.0, PARTS + 1)
        cells = np.arange(len(space.cells)) if at is None else space.cells_of(at)
        if at is not None and not len(cells):
            return space.facets[space.facets_of(at)], facet_basis(3, s)
        points = np.array([(a, b) for a in s for b in s if a + b <= 1.0 + 1e-9])
        return space.cells[cells], quadratic_basis(points)[0]
