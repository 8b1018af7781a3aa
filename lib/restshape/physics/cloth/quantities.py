"""Quantities of interest of cloth: numbers that a scene asks for, taken from its positions."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restshape.errors import UserError
from restshape.fem.averages import mean_over
from restshape.fem.entity_sets import observed_nodes
from restshape.fem.quantity import REDUCTIONS, area
from restshape.physics.cloth.sheet import Sheet
from restshape.scene.model import Quantity

AXES = "xyz"


class ClothObserver:
    """Evaluates the quantities of a scene for cloth.

    Args:
        sheet: the cloth.
        quantities: by name, as in the scene.
        flat: (corners, 3) where the cloth was cut [m], from which displacements are counted.

    Raises:
        UserError: a quantity has no meaning for cloth, or names a place that is not there.
    """

    def __init__(self, sheet: Sheet, quantities: dict[str, Quantity], flat: np.ndarray) -> None:
        self.sheet, self.mesh, self.flat = sheet, sheet.mesh, flat
        self.functions = {name: self._function(name, quantity) for name, quantity in quantities.items()}

    def __call__(self, x: np.ndarray) -> dict[str, float]:
        """All quantities at positions x (n, 3) [m]."""
        return {name: float(function(x)) for name, function in self.functions.items()}

    def _function(self, name: str, quantity: Quantity) -> Callable[[np.ndarray], float]:
        if quantity.area:
            cells = self.mesh.cells_of(quantity.at) if quantity.at else slice(None)
            return lambda x: area(self.mesh, cells)
        if quantity.energy:
            return self._energy(name, quantity)
        if not (quantity.displacement or quantity.reaction):
            raise UserError(
                f"cloth has no quantity of the kind {quantity.kind!r}",
                f"quantities.{name}",
                "use displacement, reaction, energy or area",
            )
        nodes = observed_nodes(self.mesh, name, quantity)
        if quantity.reaction:
            column = AXES.index(quantity.reaction)
            return lambda x: self.reactions(x)[nodes, column].sum()
        return self._displacement(quantity, nodes)

    def reactions(self, x: np.ndarray) -> np.ndarray:
        """Forces (corners, 3) [N] of supports on the nodes."""
        out = np.empty_like(x)
        self.sheet.unheld(x, out)
        return self.sheet.corners(out)

    def _displacement(self, quantity: Quantity, nodes: np.ndarray | slice) -> Callable[[np.ndarray], float]:
        take = mean_over(self.mesh, quantity.at, nodes) if quantity.take == "mean" else REDUCTIONS[quantity.take]

        def moved(x: np.ndarray) -> np.ndarray:
            return (self.sheet.corners(x) - self.flat)[nodes]

        if quantity.displacement == "magnitude":
            return lambda x: take(np.linalg.norm(moved(x), axis=1))
        column = AXES.index(quantity.displacement)
        return lambda x: take(moved(x)[:, column])

    def _energy(self, name: str, quantity: Quantity) -> Callable[[np.ndarray], float]:
        kinds = {
            "strain": lambda x: self.sheet.stretching(x) + self.sheet.bent(x),
            "membrane": self.sheet.stretching,
            "bending": self.sheet.bent,
            "potential": self.sheet.energy,
        }
        if quantity.energy not in kinds:
            raise UserError(
                f"cloth at rest has no {quantity.energy!r} energy",
                f"quantities.{name}.energy",
                f"use one of: {', '.join(kinds)}",
            )
        if quantity.at is not None:
            raise UserError("energies of cloth are those of all of it", f"quantities.{name}.at", "leave it out")
        return kinds[quantity.energy]
