"""Quantities of what stays in a drag with a reach: linear ones follow the unknowns of its border by a vector each."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from restshape.fem.assembled import Assembled
from restshape.fem.observer import Function
from restshape.fem.problem import STIFFNESS, SteadyProblem

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from restshape.fem.derivative import Differentiable

LINEAR = 1e-12
"""Difference of derivatives at two states, relative, up to which a quantity is linear."""


class Condensed(Protocol):
    """A part of a problem that is solved for by itself, with the rest condensed onto its border.

    Attributes:
        problem: all of it.
    """

    problem: SteadyProblem

    def stays(self) -> np.ndarray:
        """Which nodes (n,) have cells alone that stay, or are on the border."""

    def at_border(self) -> np.ndarray:
        """The free unknowns (m,) of the border at the last solve, less what is prescribed."""

    def seen_from_border(self, load: np.ndarray) -> np.ndarray:
        """The vector (m,) whose product with the border's unknowns is that of `load` (n, f) with all that follow."""


class BorderQuantities:
    """The linear quantities that hang on nodes which stay alone, all cells around them included.

    With the derivative g of one, inside and on the border, it changes by (g_B - K_BI K_II^-1 g_I) . du_B: one
    substitution for each, once.

    Args:
        part: what is solved for; its last solve is the state that changes are counted from.
        whole: gives the unknowns (n, f) of all there.
        functions: quantities by name; those that are no such ones are left out.

    Source: docs/theory/substructures.md.
    """

    def __init__(self, part: Condensed, whole: Callable[[], np.ndarray], functions: Mapping[str, Function]) -> None:
        self.functions, self._start = functions, part.at_border()
        stays = part.stays()
        self.values: dict[str, float] = {}
        slopes = []
        for name, function in functions.items():
            nodes = getattr(function, "reads", None)
            if nodes is None or not hasattr(function, "derivative") or not stays[nodes].all():
                continue
            slope = self._slope(part, cast("Differentiable", function), whole())
            if slope is not None:
                self.values[name] = float(function(whole()))
                slopes.append(slope)
        self._slopes = np.array(slopes).reshape(len(slopes), len(self._start))

    @staticmethod
    def _slope(part: Condensed, function: Differentiable, x: np.ndarray) -> np.ndarray | None:
        """How a quantity changes with the unknowns of the border (m,); None where that is not linear."""
        # Another state, in no proportion to this one, which may be 0.
        elsewhere = x + np.cos(np.arange(x.size)).reshape(x.shape)
        found, other = function.derivative(x), function.derivative(elsewhere)
        size = np.abs(found.load).max()
        if found.energy is not None or not np.allclose(other.load, found.load, rtol=0.0, atol=LINEAR * size):
            return None
        load = found.load
        if found.lift is not None:
            load = load + Assembled(part.problem.integrals(STIFFNESS)).tangent_product(x, found.lift)
        return part.seen_from_border(load)

    def __call__(self, part: Condensed) -> dict[str, float]:
        """Their values after the last solve."""
        changes = self._slopes @ (part.at_border() - self._start)
        return {name: value + float(change) for (name, value), change in zip(self.values.items(), changes)}
