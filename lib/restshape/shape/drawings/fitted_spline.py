"""Cubic splines that stay within a tolerance of any smooth curve."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restshape.arrays import Reals
from restshape.bounds import SPLINE_POINTS
from restshape.errors import UserError
from restshape.shape.curves import spline_weights

WITHIN = 1e-6
"""Largest distance between a curve and the spline that stands for it, over the size of the curve's box."""
SMOOTH = ("smooth", "smooth")
SPANS = 4
"""Spans to begin with."""
PROBES = np.array([0.25, 0.5, 0.75])
"""Shares of a span where the distance is measured."""


def fitted_spline(
    curve: Callable[[Reals], Reals], low: float, high: float, source: str
) -> tuple[Reals, tuple[float, ...]]:
    """A spline through points of a curve that stays within `WITHIN` of it; spans that do not are halved until they do.

    Args:
        curve: gives points (n, 2) [m] of parameters (n,).
        low, high: parameters of its ends.
        source: what the curve is, for messages.

    Returns:
        The points (n, 2) and knots (n,) from 0 to 1 of a spline edge with smooth ends.

    Raises:
        UserError: that takes more than `bounds.SPLINE_POINTS`, or a coordinate is not finite.
    """
    s = np.linspace(0.0, 1.0, SPANS + 1)
    while len(s) <= SPLINE_POINTS:
        points = curve(low + (high - low) * s)
        within = WITHIN * float(np.ptp(points, axis=0).max())
        probes = (s[:-1, None] + np.diff(s)[:, None] * PROBES).ravel()
        there = spline_weights(tuple(s.tolist()), SMOOTH, probes) @ points
        off = np.hypot(*(there - curve(low + (high - low) * probes)).T).reshape(-1, len(PROBES)).max(axis=1)
        bad = ~(off <= within)
        if not bad.any():
            return points, tuple(s.tolist())
        s = np.union1d(s, 0.5 * (s[:-1] + s[1:])[bad])
    what = f"{source} bends too much for a spline of {SPLINE_POINTS} points"
    raise UserError(what, do="cut it into several curves, or smooth it")
