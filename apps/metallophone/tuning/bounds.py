"""Bounds of freedoms: those that are given, or how far a freedom may move outline and thickness."""

import numpy as np
from restshape_apps.metallophone.tuning.bar import Bar
from restshape_apps.metallophone.tuning.motions import Motions

from restshape.errors import UserError

REACH = 0.15
"""Share of the size of the shape that a freedom may move the outline by, where no bound is given."""
LEAST = 0.1
"""Share of itself that a parameter keeps at least, likewise."""
THINNER = 0.5
"""Share of the thickness that a freedom may change it by, likewise."""
NARROWER = 0.9
"""Share of the radius of a hole that it may lose, likewise: no other number of a shape has to be above 0."""


def bounded(bar: Bar, motions: Motions, start: np.ndarray, given: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper bounds (k,) of the freedoms: those that are given, else by how far a freedom moves what.

    Raises:
        UserError: a freedom starts beyond a bound that is given.
    """
    tiny = np.finfo(float).tiny
    most = np.minimum(
        REACH * bar.outline.size / np.maximum(motions.reach, tiny), THINNER / np.maximum(motions.thinning, tiny)
    )
    radii = np.array([freedom.key[-1] == "radius" for freedom in bar.freedoms])
    least = np.where(radii, np.maximum(start - most, (1.0 - NARROWER) * start), start - most)
    low = np.where(np.isnan(given[:, 0]), least, given[:, 0])
    high = np.where(np.isnan(given[:, 1]), start + most, given[:, 1])
    low, high = _of_one_sign(bar, start, given, low, high)
    for freedom, a, b in zip(bar.freedoms, low, high):
        if not a <= freedom.start <= b:
            what = f"{freedom.name} is {freedom.start:g}, which lies beyond its bounds {a:g} and {b:g}"
            raise UserError(what, "--bound", "widen the bound, or begin at another value (--set)")
    return low, high


def _of_one_sign(
    bar: Bar, start: np.ndarray, given: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The bounds (k,), those of parameters off 0 where none is given: a formula may divide by them."""
    named = np.array([freedom.key[0] == "parameters" for freedom in bar.freedoms], dtype=bool)
    positive, negative = (named & np.isnan(given[:, k]) & (sign * start > 0.0) for k, sign in ((0, 1.0), (1, -1.0)))
    return (
        np.where(positive, np.maximum(low, LEAST * start), low),
        np.where(negative, np.minimum(high, LEAST * start), high),
    )


def refuse_idle(bar: Bar, motions: Motions) -> None:
    """Refuses a freedom that moves neither the outline nor the thickness."""
    for freedom, size in zip(bar.freedoms, np.diag(motions.metric)):
        if not size > 0.0:
            what = f"{freedom.name} changes neither the outline nor the thickness"
            raise UserError(what, "--by", "leave it out, or name a freedom that does")
