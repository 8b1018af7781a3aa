"""Gaps in a spectrum, and modes that others have overtaken."""

import numpy as np

from restshape.algebra.eigenproblems.davidson import Found
from restshape.arrays import Reals

WIDE = 1.5
"""A ratio of neighbouring eigenvalues that is wide enough: beyond it the upper one may be a search that has not found
the next mode yet, and a factor midway would lie above hundreds of modes."""


def gap(values: Reals, count: int) -> tuple[float, int]:
    """A shift in the first wide or else the widest gap behind the `count` lowest of values (k,), k > count, and how
    many lie below it.

    Nearer to the lower end: the upper values of an iteration that has not converged for them come down yet.
    """
    last = len(values) - 1
    places = range(min(count, last), last + 1)
    ratios = {k: min(WIDE, values[k] / values[k - 1]) for k in places if k > 0}
    if not ratios:
        return 1.5 * float(values[0]), 1
    k = max(ratios, key=lambda place: ratios[place])
    return float(values[k - 1] * (0.6 + 0.4 * ratios[k])), k


def apart(found: Found, count: int, shift: float, tolerance: float, distances: Reals | None = None) -> bool:
    """Whether the `count` lowest stay so: none of the others below a shift is still to come down among them.

    As many values below a shift as there are eigenvalues say nothing yet of the lowest, where one of them has not
    converged: it may stand for any.

    Args:
        found: eigenpairs.
        count: how many are wanted.
        shift: below which they have been counted.
        tolerance: of the residuals of those that have converged.
        distances: (k,) how far an eigenvalue is from each value at most; default: the share of it that its residual is.
    """
    below = max(count, int(np.sum(found.values < shift)))
    values, residuals = found.values[:below], found.residuals[:below]
    distances = residuals * np.abs(values) if distances is None else distances[:below]
    above = values - distances > values[:count][-1]
    return bool(np.all((residuals <= tolerance) | above))


def fallen(before: Found, after: Found, count: int, tolerance: float) -> int:
    """1 where the `count` lowest are others than before, as a lower one has come in among them; else 0."""
    old, new = before.values[:count], after.values[:count]
    return int(len(old) != len(new) or bool(np.any(new < old - tolerance * np.abs(old))))
