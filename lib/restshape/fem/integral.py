"""An integral of an element's residual over cells, facets or points of a space."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from restshape import _kernels
from restshape.algebra.operator import MatrixTerm


@dataclass(frozen=True, eq=False)
class Integral:
    """`factor` times the sum of an element's residuals over some of a space's entities.

    Args:
        element: what is integrated.
        X: (n, d) material coordinates [m] of the space, by reference.
        entities: (m, k) int32 nodes of each cell, facet or point.
        parameters: (p,) the same everywhere, or (m, p); the element's `parameters` name the columns.
        factor: of the residual, and with it of tangent and energy.
        block: of the operator that the entities were registered as; None, whatever is given, where the element has no
            tangent.
        rate: gives the rates, shaped like the parameters, with which they change when nodes move with rates (n, d). The
            residual is evaluated with them in place of the parameters, so that it must be linear in those that change,
            and 0 where they are; None where they are constant.
        coefficients: (n, c) nodal coefficients [their units are the element's], such as a velocity that carries; None
            where the element has none.
        dofs: (m, k) int32 nodes whose unknowns each entity has, rows of x; None: `entities`. Others at seams, under
            periodicity, and of elements whose fields have nodes of their own, which number single unknowns.
        coefficient_rate: gives the rates (n, c) with which the coefficients change when nodes move with rates (n, d);
            None where they are constant.
    """

    element: _kernels.Element
    X: np.ndarray
    entities: np.ndarray
    parameters: np.ndarray
    factor: float = 1.0
    block: int | None = 0
    rate: Callable[[np.ndarray], np.ndarray | None] | None = None
    coefficients: np.ndarray | None = None
    dofs: np.ndarray | None = None
    coefficient_rate: Callable[[np.ndarray], np.ndarray] | None = None

    def __post_init__(self) -> None:
        if not self.element.has_tangent:
            object.__setattr__(self, "block", None)

    @property
    def _columns(self) -> tuple[np.ndarray | None, np.ndarray | None]:
        """What only some elements need."""
        return self.coefficients, self.dofs

    def of(self, cells: slice) -> "Integral":
        """The integral over some of the entities, by reference; itself of all."""
        if cells == slice(None):
            return self
        parameters = self.parameters[cells] if self.parameters.ndim > 1 else self.parameters
        dofs = None if self.dofs is None else self.dofs[cells]
        return replace(self, entities=self.entities[cells], parameters=parameters, dofs=dofs, block=None)

    def add_residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None = None) -> None:
        """Add the residual at x (n, f) to `out` (n, f), of the entities (k,) int32 of a subset alone where given."""
        if self.factor == 1.0:
            self.element.residual(self.X, x, self.entities, self.parameters, out, subset, *self._columns)
        else:
            own = np.zeros_like(out)
            self.element.residual(self.X, x, self.entities, self.parameters, own, subset, *self._columns)
            out += self.factor * own

    def add_tangent_product(self, x: np.ndarray, d: np.ndarray, out: np.ndarray) -> None:
        """Add (dr/dx) d, at x (n, f) along d (n, f), to `out` (n, f)."""
        self._add_rates(x, np.zeros_like(self.X), out, d, None)

    def add_design_product(self, x: np.ndarray, dX: np.ndarray, out: np.ndarray, dx: np.ndarray | None = None) -> None:
        """Add (dr/dX) dX + (dr/dx) dx to `out` (n, f), with the rates of coefficients and parameters.

        Args:
            x: (n, f) unknowns; dx: (n, f) their rates, None where they are constant.
            dX: (n, d) rates of the material coordinates.
        """
        rates = None if self.coefficient_rate is None else np.ascontiguousarray(self.coefficient_rate(dX))
        self._add_rates(x, dX, out, dx, rates)
        changes = None if self.rate is None else self.rate(dX)
        if changes is not None:
            replace(self, parameters=changes).add_residual(x, out)

    def _add_rates(
        self, x: np.ndarray, dX: np.ndarray, out: np.ndarray, dx: np.ndarray | None, dw: np.ndarray | None
    ) -> None:
        own = out if self.factor == 1.0 else np.zeros_like(out)
        w, dofs = self._columns
        self.element.design(self.X, dX, x, self.entities, self.parameters, own, dx, w, dw, dofs)
        if own is not out:
            out += self.factor * own

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Energies (m,) of the entities at x (n, f), whose derivative is the residual."""
        found = self.element.energy(self.X, x, self.entities, self.parameters, *self._columns)
        return found if self.factor == 1.0 else self.factor * found

    def term(self, x: np.ndarray, coefficient: float = 1.0, residual_factor: float | None = None) -> MatrixTerm:
        """The integral at x (n, f) as a term of `algebra.operator.Operator.assemble`."""
        assert self.block is not None, "without a block there is no tangent"
        coefficient = coefficient * self.factor
        given: tuple[float | np.ndarray, ...] = () if residual_factor is None else (residual_factor,)
        if self.coefficients is not None:
            given = (coefficient if residual_factor is None else residual_factor, self.coefficients)
        return (self.block, self.element, self.X, x, self.parameters, coefficient, *given)

    def stress(self, x: np.ndarray, points: np.ndarray | None = None) -> np.ndarray:
        """Stresses (m, p, c) of the cells at reference points (p, d), or (m, c) at centroids, at x (n, f)."""
        shape = (len(self.entities),) if points is None else (len(self.entities), len(points))
        out = np.empty((*shape, self.element.stress_components))
        self.element.stress(self.X, x, self.entities, self.parameters, out, points, *self._columns)
        return out

    def work_derivatives(self, x: np.ndarray, axes: np.ndarray | None = None) -> np.ndarray:
        """Derivatives (m, k, d) of each entity's x . r(x) by the places of its k nodes, at a constant x (n, f).

        Each node of each entity is moved by itself, all entities at once.

        Args:
            x: unknowns.
            axes: along which nodes are moved, derivatives along others are 0; None: all.
        """
        m, nodes = self.entities.shape
        dofs = self.entities if self.dofs is None else self.dofs
        X = np.ascontiguousarray(self.X[self.entities].reshape(m * nodes, -1))
        x = np.ascontiguousarray(x[dofs].reshape(dofs.size, -1))
        own, own_dofs = (np.arange(part.size, dtype=np.int32).reshape(part.shape) for part in (self.entities, dofs))
        w = None
        if self.coefficients is not None:
            w = np.ascontiguousarray(self.coefficients[self.entities].reshape(m * nodes, -1))
        found = np.zeros((m, nodes, X.shape[1]))
        for i in range(nodes):
            for axis in range(X.shape[1]) if axes is None else axes:
                dX, out = np.zeros_like(X), np.zeros_like(x)
                dX[own[:, i], axis] = 1.0
                self.element.design(X, dX, x, own, self.parameters, out, None, w, None, own_dofs)
                found[:, i, axis] = (x * out).reshape(m, -1).sum(axis=1)
        return found if self.factor == 1.0 else self.factor * found


class Term(Protocol):
    """What sums are made of: an `Integral`, or what behaves like one."""

    @property
    def block(self) -> int | None: ...

    def add_residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None = None) -> None:
        """As `Integral.add_residual`."""

    def add_tangent_product(self, x: np.ndarray, d: np.ndarray, out: np.ndarray) -> None:
        """As `Integral.add_tangent_product`."""

    def add_design_product(self, x: np.ndarray, dX: np.ndarray, out: np.ndarray, dx: np.ndarray | None = None) -> None:
        """As `Integral.add_design_product`."""

    def energies(self, x: np.ndarray) -> np.ndarray:
        """As `Integral.energies`."""

    def term(self, x: np.ndarray, coefficient: float = 1.0, residual_factor: float | None = None) -> MatrixTerm:
        """As `Integral.term`."""
