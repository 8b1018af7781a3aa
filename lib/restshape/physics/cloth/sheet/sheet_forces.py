"""Energy and forces of cloth by itself, membrane, weight and bending, in one pass over elements that are kept."""

from operator import is_not

import numpy as np

from restshape import _kernels
from restshape.fem.elements import HINGE, MEMBRANE, MORLEY
from restshape.fem.integral import Integral
from restshape.physics.cloth.sheet.bending import HingeBending, MorleyBending
from restshape.physics.cloth.sheet.membrane import Membrane

BENT = (HINGE["flap4"].name, MORLEY["tri6"].name)
"""Elements that bend in the same pass."""

NOWHERE, WEIGHTLESS = np.empty((0, 3), np.int32), np.zeros(9)
"""No triangles, and parameters of these."""


class SheetForces:
    """Both at the last place, and what of the elements depends on material and stiffness alone.

    Args:
        membrane: of the law of St. Venant and Kirchhoff; bending: None: nothing bends.
    """

    def __init__(self, membrane: Membrane, bending: HingeBending | MorleyBending | None) -> None:
        self.membrane, self.bending = membrane, bending
        self._key: tuple[object, ...] = ()
        self._sheet: _kernels.Sheet | None = None
        self._bent: _kernels.Sheet | None = None
        self._others: list[Integral] = []
        self._known: tuple[np.ndarray, float, np.ndarray] | None = None

    @staticmethod
    def serves(membrane: Membrane) -> bool:
        """Whether a membrane is of that law."""
        return membrane.element.name == MEMBRANE["tri3"].name

    def at(self, X: np.ndarray, x: np.ndarray, version: int) -> tuple[float, np.ndarray]:
        """Energy [J] and its gradient (n, 3) [N], to be read only, at x (n, 3) [m].

        Args:
            X: (n, 2) material coordinates [m].
            x: positions.
            version: another one whenever material or stiffness may be others in the same arrays.
        """
        self._follow(X, version)
        known = self._known
        if known is None or not _kernels.same_values(known[0], x):
            out = np.empty_like(x)
            energy = self._sheet.evaluate(x, out)
            for integral in self._others:
                energy += float(integral.energies(x).sum())
                integral.add_residual(x, out)
            known = self._known = x.copy(), energy, out
        return known[1], known[2]

    def bend(self, X: np.ndarray, x: np.ndarray, version: int, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the forces of bending alone at x (n, 3) [m]; arguments as of `at`."""
        self._follow(X, version)
        self._bent.evaluate(x, out)
        for integral in self._others:
            integral.add_residual(x, out)

    def _follow(self, X: np.ndarray, version: int) -> None:
        """Keep elements as they are now."""
        key = (version, X, self.membrane.parameters, self.bending.parameters if self.bending else None)
        if len(self._key) != len(key) or key[0] != self._key[0] or any(map(is_not, key[1:], self._key[1:])):
            self._prepare(X)
            self._key, self._known = key, None

    def _prepare(self, X: np.ndarray) -> None:
        own, bent = self.membrane.integral(X), self.bending.integrals(X) if self.bending else []
        first = [one for one in bent[:1] if one.element.name in BENT]
        self._others = bent[len(first) :]
        name, cells, stiffness = "", np.empty((0, 0), np.int32), np.empty(0)
        for one in first:
            name, cells, stiffness = one.element.name, one.entities, one.parameters
        self._sheet = _kernels.Sheet(X, own.entities, own.parameters, name, cells, stiffness)
        self._bent = _kernels.Sheet(X, NOWHERE, WEIGHTLESS, name, cells, stiffness)
