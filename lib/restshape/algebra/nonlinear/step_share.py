"""How much of a step may be gone, where something must not be passed on the way."""

from collections.abc import Callable

from restshape.arrays import Reals

StepShare = Callable[[Reals, Reals], float]
"""Of values (n, f) and a step (n, f): the largest share of the step, in (0, 1], that may be gone."""


def whole_step(x: Reals, d: Reals) -> float:
    """All of every step: nothing stands in the way."""
    return 1.0
