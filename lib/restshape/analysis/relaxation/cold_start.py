"""How cloth falls from where it is laid: soft at first, with hinges, and from coarse meshes to fine ones."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from restshape.algebra.descent import MEMORY
from restshape.analysis.relaxation.equilibrium import ROUGH, Arrival, Rest
from restshape.physics.cloth.parameters import HINGE_STIFFNESS
from restshape.physics.cloth.sheet import Fabric

SOFT = (0.01, 0.05)
"""Parts of the membrane's stiffness that cloth falls with at first: soft cloth finds its folds in large steps."""
ROUNDS, LAST_ROUNDS = 4, 2
"""Tangents of a descent with a soft membrane, on coarse meshes and on the finest one."""
STIFF_ROUNDS = 30
"""Tangents of a descent of hinges in place of Morley's triangles, with all of the membrane's stiffness."""


def stand_in(fabric: Fabric) -> Fabric:
    """The fabric with hinges in place of Morley's triangles, which have four times as many unknowns."""
    return replace(fabric, kind="hinge", hinge_factor=HINGE_STIFFNESS["plate"]) if fabric.kind == "morley" else fabric


def fall(
    ways: Sequence[Rest],
    carry: Callable[[int, np.ndarray], np.ndarray],
    x: np.ndarray,
    most: int,
    arrival: Arrival,
    stiff: bool,
) -> np.ndarray:
    """Positions on the finest mesh, near rest, from a start x (n, 3) on the coarsest one.

    Args:
        ways: from the coarsest mesh to the finest.
        carry: takes positions on the mesh of a level to the next one.
        most: steps in all.
        stiff: the last of the ways stands in for another one: it descends with all of its stiffness too.
    """
    last = len(ways) - 1
    for level, way in enumerate(ways):
        # Stiff triangles of a coarse mesh would not let the cloth fold.
        for part in SOFT if level == 0 else SOFT[-1:]:
            way.sheet.soften(part)
            way.begin()
            if level == 0 and part == SOFT[0]:
                way.fall(x, ROUGH, arrival)
            rounds = ROUNDS if level < last else LAST_ROUNDS
            way.descend(x, ROUGH, min(most, rounds * MEMORY), arrival)
        if level < last:
            x = carry(level, x)
    way.sheet.soften(1.0)
    way.begin()
    if stiff:
        way.descend(x, ROUGH, min(most, STIFF_ROUNDS * MEMORY), arrival)
    return x


def loosen(way: Rest, x: np.ndarray, most: int, arrival: Arrival) -> None:
    """Soft for a while, from positions x (n, 3), which are changed, that a stiff membrane leaves in small steps."""
    for part in SOFT:
        way.sheet.soften(part)
        way.begin()
        # Beside an unstable equilibrium forces are small, and grow at first.
        way.fall(x, min(ROUGH, 0.1 * way.residual(x)), arrival)
        way.descend(x, ROUGH, min(most, ROUNDS * MEMORY), arrival)
    way.sheet.soften(1.0)
    way.begin()
