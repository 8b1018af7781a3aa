"""Recovered stresses at few nodes of a large solid, from the cells around them alone."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restshape.fem.entity_sets import cells_around
from restshape.fem.observer import Function, reduction
from restshape.fem.part_space import CellPatch
from restshape.physics.elasticity.shared_solid import SolidPart, WholeSolid, rows_at
from restshape.scene.model import Quantity

LEAST_CELLS = 5_000
"""Cells below which the stresses of all nodes take about as long as a patch."""
FEW = 1 / 50
"""Of the nodes: around more of them there are too many cells."""


def at_few(solid: WholeSolid, nodes: np.ndarray) -> bool:
    """Whether these nodes are few of many."""
    return len(solid.space.cells) >= LEAST_CELLS and len(nodes) <= FEW * len(solid.space.X)


def local_stress(solid: WholeSolid, quantity: Quantity, nodes: np.ndarray, cells: np.ndarray) -> Function:
    """The function of x (n, 2) [m] that is a recovered stress [Pa] at nodes (k,), with the bits of the whole.

    Args:
        solid: whole.
        quantity: which component, and how its values are reduced.
        nodes: where; cells: whose regions' stress counts, those of all where there are none.
    """
    component, space = str(quantity.stress), solid.space
    known: tuple[SolidPart[CellPatch], np.ndarray, Callable[[np.ndarray], float]] | None = None

    def stress(x: np.ndarray, *_: object) -> float:
        nonlocal known
        if known is None or not known[0].space.fits:
            part = SolidPart(solid, CellPatch(space, cells_around(space, nodes)))
            rows = rows_at(part, nodes, space.cell_region[cells])
            seen = part.space.nodes[part.nodal_stress.recovery.nodes[rows]]
            known = part, rows, reduction(space, quantity, seen)  # type: ignore[arg-type]
        part, rows, reduce = known
        return reduce(part.nodal_stress.component(component, part.follow(x))[rows])

    return stress
