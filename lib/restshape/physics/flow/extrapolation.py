"""Guesses at a flow after a time step, from those at the ends of the last steps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

MOST = 3
"""Largest order of the polynomials in time."""


@dataclass(frozen=True, eq=False)
class Extrapolation:
    """Extrapolates unknowns in time, by the order that would have predicted the last ones best.

    A flow that changes smoothly is predicted by polynomials of higher order, one that begins suddenly by what it was.

    Args:
        times: at the ends of the last steps, the newest first [s].
        values: (k, f, n) unknowns then, column after column.

    Source: docs/theory/flow.md.
    """

    times: tuple[float, ...] = ()
    values: np.ndarray | None = None

    def after(self, time: float, x: np.ndarray) -> Extrapolation:
        """With the unknowns x (n, f) at a later time [s]; a copy is kept."""
        if self.values is None:
            return Extrapolation((time,), x.T[None].copy())
        kept = min(len(self.times), MOST + 1)
        return Extrapolation((time, *self.times[:kept]), np.concatenate([x.T[None], self.values[:kept]]))

    def __call__(self, time: float, groups: Sequence[slice]) -> np.ndarray:
        """The unknowns (n, f) at a time [s]; groups: columns of those that change alike, each column in one."""
        assert self.values is not None, "nothing is known yet"
        known, count = self.values, len(self.times) - 1
        if count < 1:
            return np.ascontiguousarray(known[0].T)
        # What each order makes of the newest values, from those before, less what they are.
        weights = np.zeros((count, count + 1))
        weights[:, 0] = -1.0
        for order in range(count):
            weights[order, 1 : order + 2] = lagrange(self.times[1 : order + 2], self.times[0])
        missed = (weights @ known.reshape(count + 1, -1)).reshape(count, *known.shape[1:])
        errors = np.einsum("kfn,kfn->kf", missed, missed)
        out = np.empty(known.shape[1:])
        for columns in groups:
            order = int(np.argmin(errors[:, columns].sum(axis=1)))
            ahead = lagrange(self.times[: order + 1], time)
            np.einsum("k,kfn->fn", ahead, known[: order + 1, columns], out=out[columns])
        return np.ascontiguousarray(out.T)


class TimeGuess:
    """Guesses at the unknowns after a time step, as long as each step goes on from the one before.

    Args:
        groups: columns of the unknowns that change alike, each column in one.
    """

    def __init__(self, groups: Sequence[slice]) -> None:
        self._groups, self._series = groups, Extrapolation()
        self._last: np.ndarray | None = None

    def __call__(self, x: np.ndarray, time: float, ahead: float) -> np.ndarray:
        """The unknowns (n, f) at a time ahead, from x (n, f) at a time [s]: what `keep` took last, or a new start."""
        if x is not self._last:
            self._series = Extrapolation()
            self.keep(x, time)
        return self._series(ahead, self._groups)

    def keep(self, x: np.ndarray, time: float) -> None:
        """Take in the unknowns x (n, f) that were found at a time [s]; they are not changed afterwards."""
        self._series, self._last = self._series.after(time, x), x


def lagrange(times: Sequence[float], time: float) -> list[float]:
    """Weights (k,) of values at times with which their polynomial has its value at another time."""
    return [prod((time - b) / (a - b) for b in times if b != a) for a in times]
