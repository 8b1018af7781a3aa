"""Values of a scene, numbers or expressions of the place, evaluated at nodes."""

from collections.abc import Sequence

import numpy as np

from restshape.bounds import NUMBER
from restshape.errors import ReplayProblem
from restshape.scene.duals import Dual
from restshape.scene.expressions import Expression, Value
from restshape.scene.units import LEAST, SYMBOLS


def varies(value: Value | Sequence[Value]) -> bool:
    """Whether a value, or any component of it, is an expression of the place."""
    if isinstance(value, (list, tuple)):
        return any(varies(component) for component in value)
    return isinstance(value, Expression)


class Nodal:
    """A scalar value of the scene as a function of places (n, 2) [m]."""

    def __init__(self, value: Value, parameters: dict[str, float], where: str) -> None:
        self.value, self.parameters, self.where = value, parameters, where

    def __call__(self, X: np.ndarray) -> np.ndarray:
        """The values (n,).

        Raises:
            ReplayProblem: one is not finite or beyond `bounds.NUMBER`, or below the least that there is of its
                dimension.
        """
        if not isinstance(self.value, Expression):
            return np.full(len(X), self.value)
        with np.errstate(all="ignore"):
            result = np.broadcast_to(self.value.evaluate(X[:, 0], X[:, 1], self.parameters), len(X))
        beyond = ~(np.abs(result) <= NUMBER)
        if beyond.any():
            first = float(result[beyond][0])
            what = f"{first:.6g}, beyond {NUMBER:g}," if np.isfinite(first) else "not a finite number"
            self._refuse(f"the expression is {what}", X, beyond)
        dimension = self.value.wanted or ""
        least, what = LEAST.get(dimension, (-np.inf, ""))
        below = result < least
        if below.any():
            value = f"{result[below][0]:.6g} {SYMBOLS[dimension]}"
            self._refuse(f"a {dimension} of {value} is below {what},", X, below)
        return result

    def _refuse(self, what: str, X: np.ndarray, bad: np.ndarray) -> None:
        x, y = X[np.flatnonzero(bad)[0]][:2]
        raise ReplayProblem(f"{self.where}: {what} at x = {x:g} m, y = {y:g} m")

    def rate(self, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """How fast (n,) the value changes at places X (n, 2) [m] that move with dX (n, 2)."""
        if not isinstance(self.value, Expression):
            return np.zeros(len(X))
        with np.errstate(all="ignore"):
            result = self.value.rate(Dual(X[:, 0], dX[:, 0]), Dual(X[:, 1], dX[:, 1]), self.parameters)
        if not np.all(np.isfinite(result)):
            self._refuse("the expression has no derivative", X, ~np.isfinite(result))
        return result


NOTHING = Nodal(0.0, {}, "")


class Product:
    """The product of two scalar values of the scene as a function of places."""

    def __init__(self, first: Nodal, second: Nodal) -> None:
        self.first, self.second = first, second

    def __call__(self, X: np.ndarray) -> np.ndarray:
        """The values (n,) at places X (n, 2) [m].

        Raises:
            ReplayProblem: one is not finite, or below the least that there is of its dimension.
        """
        return self.first(X) * self.second(X)

    def rate(self, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """How fast (n,) the product changes at places X (n, 2) [m] that move with dX (n, 2)."""
        return self.first.rate(X, dX) * self.second(X) + self.first(X) * self.second.rate(X, dX)


def evaluate(values: Sequence[Value], X: np.ndarray, parameters: dict[str, float], where: str) -> np.ndarray:
    """A vector value of the scene at places X (n, 2) [m]: (n, 2)."""
    return np.column_stack([Nodal(value, parameters, where)(X) for value in values])


def rates(
    values: Sequence[Value], X: np.ndarray, dX: np.ndarray, parameters: dict[str, float], where: str
) -> np.ndarray:
    """How fast (n, 2) a vector value of the scene changes at places X (n, 2) [m] that move with dX (n, 2)."""
    return np.column_stack([Nodal(value, parameters, where).rate(X, dX) for value in values])
