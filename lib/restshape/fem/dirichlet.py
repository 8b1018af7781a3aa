"""Dirichlet conditions: unknowns whose values supports prescribe."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from restshape.errors import UserError
from restshape.fem.nodal_values import Nodal, varies
from restshape.fem.sliding import Sliding
from restshape.scene.expressions import Value

AGREES = 1e-9
"""Relative difference below which two values prescribed at one node are the same."""
ROUNDING = 1e-12
"""Share of the largest prescribed value by which they may differ besides: formulas of the place give almost 0 for 0."""


@dataclass(frozen=True, eq=False)
class Prescribed:
    """One component that a condition of the scene prescribes on some nodes.

    Args:
        where: its key in the scene, for messages.
        component: column of the unknowns.
        nodes: (k,) int32.
        value: number or expression of the place.
    """

    where: str
    component: int
    nodes: np.ndarray
    value: Value


class Dirichlet:
    """Prescribed unknowns of one space.

    Args:
        shape: (n, f) of the unknowns.
        conditions: in the order of the scene.
        parameters: of the scene, for expressions.
        unit: of the values, for messages.
        sliding: nodes at which the first two unknowns are those of a vector along edges; None: there are none.

    Attributes:
        mask: (n, f) uint8, 1 where an unknown is prescribed.
        values: (n, f) prescribed values, 0 elsewhere.
        constrained: (k,) indices of the prescribed ones among all n f unknowns.
        varies: whether a value changes when nodes move.
        nonzero: whether a prescribed value is not 0.
    """

    def __init__(
        self,
        shape: tuple[int, int],
        conditions: Sequence[Prescribed],
        parameters: dict[str, float],
        unit: str = "m",
        sliding: Sliding | None = None,
    ) -> None:
        self.conditions, self.parameters, self.unit, self.sliding = tuple(conditions), parameters, unit, sliding
        self.mask, self.values = np.zeros(shape, dtype=np.uint8), np.zeros(shape)
        for condition in self.conditions:
            self.mask[condition.nodes, condition.component] = 1
        self.constrained = np.flatnonzero(self.mask.ravel())
        self._once = sum(len(condition.nodes) for condition in self.conditions) == len(self.constrained)
        # Numbers are evaluated once; formulas again and again.
        self._changing = tuple(condition for condition in self.conditions if varies(condition.value))
        self.varies, self._evaluated = bool(self._changing), False
        self.nonzero = False

    def evaluate(self, X: np.ndarray) -> None:
        """Set `values` for nodes X (n, d) [m]; values that are numbers only the first time.

        Raises:
            UserError: two conditions prescribe different values at one node.
            ReplayProblem: an expression has no number somewhere.
        """
        if self.sliding:
            self.sliding.update(X)
        if self._evaluated and not self._changing:
            return
        if self._once:
            for condition in self._changing if self._evaluated else self.conditions:
                values = Nodal(condition.value, self.parameters, condition.where)(X[condition.nodes])
                self.values[condition.nodes, condition.component] = values
        else:
            self._evaluate_together(X)
        self._evaluated = True
        self.nonzero = bool(np.any(self.values))

    def rate(self, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """Rates (n, f) of the prescribed values where nodes X (n, d) [m] move with dX (n, d); 0 elsewhere."""
        out = np.zeros(self.values.shape)
        for condition in self.conditions:
            value = Nodal(condition.value, self.parameters, condition.where)
            out[condition.nodes, condition.component] = value.rate(X[condition.nodes], dX[condition.nodes])
        return out

    def apply(self, x: np.ndarray) -> None:
        """Set the prescribed unknowns of x (n, f)."""
        x.ravel()[self.constrained] = self.values.ravel()[self.constrained]
        if self.sliding:
            self.sliding.project(x)

    def zero(self, out: np.ndarray) -> None:
        """Set `out` (n, f) to 0 at prescribed unknowns."""
        out.ravel()[self.constrained] = 0.0
        if self.sliding:
            self.sliding.project(out)

    def _evaluate_together(self, X: np.ndarray) -> None:
        """Set `values` where conditions have nodes in common."""
        given = np.full_like(self.values, np.nan)
        found = [Nodal(one.value, self.parameters, one.where)(X[one.nodes]) for one in self.conditions]
        rounding = ROUNDING * max(np.abs(values).max(initial=0.0) for values in found)
        for condition, values in zip(self.conditions, found):
            nodes, column = condition.nodes, condition.component
            self._check_agreement(condition, values, given[nodes, column], X, rounding)
            given[nodes, column] = values
        np.copyto(self.values, np.nan_to_num(given))

    def _check_agreement(
        self, condition: Prescribed, values: np.ndarray, before: np.ndarray, X: np.ndarray, rounding: float
    ) -> None:
        largest = np.maximum(np.abs(values), np.abs(before))
        clash = np.flatnonzero(np.abs(values - before) > AGREES * largest + rounding)
        if not len(clash):
            return
        first = clash[0]
        x, y = X[condition.nodes[first]][:2]
        kind = "edges" if condition.where.startswith("boundary.") else "supports"
        raise UserError(
            f"two {kind} prescribe different values at ({x:.6g}, {y:.6g}) m: "
            f"{values[first]:.6g} {self.unit} and {before[first]:.6g} {self.unit}",
            condition.where,
            f"let {kind} that meet agree where they meet",
        )
