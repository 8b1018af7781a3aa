"""The thickness of a body over its plane outline: a number, or a formula of the place."""

import numpy as np

from restshape.errors import ReplayProblem
from restshape.outputs.si_numbers import si
from restshape.scene.duals import Dual
from restshape.scene.expressions import Expression, Value


class Thickness:
    """A thickness [m] as a function of places in the plane.

    Args:
        value: a number [m], or a formula of x and y [m] that gives one.
        parameters: value of each named parameter of the scene.
    """

    def __init__(self, value: Value, parameters: dict[str, float]) -> None:
        self.value, self.parameters = value, parameters

    @property
    def varies(self) -> bool:
        """Whether the thickness depends on the place."""
        return isinstance(self.value, Expression)

    def at(self, X: np.ndarray) -> np.ndarray:
        """Thickness (n,) [m] at places X (n, 2) [m].

        Raises:
            ReplayProblem: it is not positive, or not a number, somewhere.
        """
        if not self.varies:
            return np.full(len(X), float(self.value))
        result = self.value.evaluate(X[:, 0], X[:, 1], self.parameters)
        require_material(X, result)
        return result

    def rate(self, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """How fast (n,) the thickness changes at places X (n, 2) [m] that move with dX (n, 2).

        Raises:
            ReplayProblem: the formula has no derivative somewhere.
        """
        if not self.varies:
            return np.zeros(len(X))
        result = self.value.rate(Dual(X[:, 0], dX[:, 0]), Dual(X[:, 1], dX[:, 1]), self.parameters)
        bad = np.flatnonzero(~np.isfinite(result))
        if len(bad):
            x, y = X[bad[0]]
            raise ReplayProblem(f"the thickness has no derivative at x = {x:g} m, y = {y:g} m")
        return result


def require_material(X: np.ndarray, thickness: np.ndarray) -> None:
    """Make sure that thicknesses (n,) [m] at places X (n, 2) [m] are positive numbers.

    Raises:
        ReplayProblem: one is not.
    """
    bad = np.flatnonzero(~(np.isfinite(thickness) & (thickness > 0.0)))
    if len(bad):
        x, y = X[bad[0]]
        raise ReplayProblem(f"the thickness is {si(float(thickness[bad[0]]), 'm')} at x = {x:g} m, y = {y:g} m")
