"""How often a force swings: the period between its turning points, followed from time step to time step."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isnan, nan

import numpy as np

from restshape.fem.observer import Function
from restshape.scene.model import Quantity

Sample = tuple[float, float]
"""A time [s] and the value then."""

CYCLES = 4
"""Full cycles, the last ones, over which a period is taken."""
FEWEST = 2
"""Full cycles without which there is no period."""
REGULAR = 0.2
"""Part of the period by which each of these cycles may differ from it."""
STILL = 1e-3
"""A coefficient of lift that goes to and fro by less does not swing."""
TURNED = 0.2
"""Part of the last swing by which a value goes back after a turning point."""

SAMPLES = 8
"""Time steps without which a cycle is one of the steps, not of the flow."""

STEADY_NOTE = "a steady flow does not swing: it has no Strouhal number"


@dataclass(frozen=True)
class Swing:
    """The turning points of a value in time; `after` gives them with one more sample.

    Args:
        last: the last two samples.
        turns: the last turning points, in turn from above and from below; the first sample counts as one.
        farthest: the point that will be the next one, as far as is known; None: it is not known which way it lies.
        rising: that is one from above.
    """

    last: tuple[Sample, ...] = ()
    turns: tuple[Sample, ...] = ()
    farthest: Sample | None = None
    rising: bool = True

    def after(self, time: float, value: float) -> Swing:
        """The swing with the value of a later time [s]."""
        here = time, value
        last = (*self.last, here)[-2:]
        if self.farthest is None:
            first = self.turns[0] if self.turns else here
            away = abs(value - first[1]) > STILL
            return replace(self, last=last, turns=(first,), farthest=here if away else None, rising=value > first[1])
        sign = 1.0 if self.rising else -1.0
        farthest = self.farthest
        if sign * (value - farthest[1]) > 0.0:
            return replace(self, last=last, farthest=here)
        if len(self.last) == 2 and self.last[1] == farthest:
            farthest = _vertex(*self.last, here)
        back = max(STILL, TURNED * abs(farthest[1] - self.turns[-1][1]))
        if sign * (farthest[1] - value) <= back:
            return replace(self, last=last, farthest=farthest)
        turns = (*self.turns, farthest)[-2 * CYCLES - 2 :]
        return replace(self, last=last, turns=turns, farthest=here, rising=not self.rising)

    @property
    def period(self) -> float:
        """The mean length of the last full cycles that are as long as each other [s].

        Not a number where there are too few, they are over, or they take too few time steps to be those of the flow.
        """
        times = [time for time, _ in self.turns]
        # From above to above and from below to below: every two turning points make a full cycle with the one between.
        cycles = [after - before for before, after in zip(times, times[2:])]
        for count in range(len(cycles), 2 * FEWEST - 2, -1):
            own = cycles[-count:]
            period = sum(own) / count
            if period < SAMPLES * (self.last[-1][0] - self.last[0][0]):
                return nan
            if self.last[-1][0] - times[-1] <= period and all(abs(one - period) <= REGULAR * period for one in own):
                return period
        return nan


def _vertex(before: Sample, top: Sample, after: Sample) -> Sample:
    """The turning point of the parabola through three samples, of which the middle one is the highest or lowest."""
    (t0, v0), (t1, v1), (t2, v2) = before, top, after
    first, second = (v1 - v0) / (t1 - t0), (v2 - v1) / (t2 - t1)
    if first == second:
        return top
    # The slope goes from `first` at the middle of the first step to `second` at that of the second one.
    time = 0.5 * (t0 + t1) + first / (first - second) * 0.5 * (t2 - t0)
    curvature = 2.0 * (second - first) / (t2 - t0)
    return time, v1 - 0.5 * curvature * (time - t1) ** 2


@dataclass(frozen=True, eq=False)
class Swings:
    """How the lifts have swung that a scene asks the Strouhal numbers of.

    Args:
        lifts: their coefficients, functions of the unknowns x (n, f), by the names of the quantities.
        known: by these names, over all time steps.
    """

    lifts: Mapping[str, Function] = field(default_factory=dict)
    known: Mapping[str, Swing] = field(default_factory=dict)

    def after(self, time: float, x: np.ndarray) -> Swings:
        """The swings with those of the unknowns x (n, f) after a time step that ends at a time [s]."""
        if not self.lifts:
            return self
        known = {name: self.known.get(name, Swing()).after(time, lift(x)) for name, lift in self.lifts.items()}
        return replace(self, known=known)

    def numbers(self, quantities: Mapping[str, Quantity]) -> dict[str, float]:
        """The Strouhal numbers of a scene's quantities, not a number where a lift does not swing."""
        known = {name: self.known.get(name, Swing()) for name in self.lifts}
        return {
            name: quantities[name].strouhal.length / (one.period * quantities[name].strouhal.speed)
            for name, one in known.items()
        }


def still_note(numbers: Mapping[str, float]) -> dict[str, str]:
    """The note of a frame's row where some of these Strouhal numbers are none."""
    names = [name for name, number in numbers.items() if isnan(number)]
    if not names:
        return {}
    what = f"the lift has not swung regularly for {FEWEST} full cycles of {SAMPLES} time steps or more"
    return {"note": f"{', '.join(names)[:80]}: {what}"}
