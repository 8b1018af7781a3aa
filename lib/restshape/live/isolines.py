"""Lines along which a field of the nodes has one value, as marks."""

from __future__ import annotations

from math import floor, log10

import numpy as np

from restshape.analysis.modal.nodal_lines import linear_triangles, nodal_lines
from restshape.arrays import Indices, Reals
from restshape.live.shown_marks import Lines, Mark
from restshape.outputs.si_numbers import digits_apart, si

LEVELS = 8
"""Lines of different values at most."""


def isolines(name: str, X: Reals, cells: Indices, values: Reals, unit: str) -> list[Mark]:
    """The lines of round values of a field, which is linear between nodes; nothing where it is the same everywhere.

    Args:
        name: of the field; X: (n, 2) [m] of the nodes; cells: (ne, 3) or (ne, 6) of triangles.
        values: (n,) in `unit`.
    """
    low, high = float(values.min()), float(values.max())
    if not high > low:
        return []
    levels, triangles = round_levels(low, high), linear_triangles(cells)
    digits, points, words = digits_apart(levels, 3), list[Reals](), list[str]()
    of_corners = values[triangles]
    least, most = of_corners.min(axis=1), of_corners.max(axis=1)
    for level in levels:
        near = triangles[(least <= level) & (most >= level)]
        found = nodal_lines(near, values - level)
        if count := len(found.sides):
            points.append(found.ends(X).reshape(-1, 2))
            words += [si(level, unit, digits), *[""] * (count - 1)]
    if not points:
        return []
    together = np.concatenate(points)
    return [Lines(name, together, range(0, len(together), 2), "guide", None, words)]


def round_levels(low: float, high: float) -> list[float]:
    """Multiples of 1, 2 or 5 times a power of ten between two values, `LEVELS` at most."""
    least = (high - low) / LEVELS
    power = 10.0 ** floor(log10(least))
    step = next(k * power for k in (1.0, 2.0, 5.0, 10.0) if k * power >= least)
    first = floor(low / step) + 1
    return [k * step for k in range(first, floor(high / step) + 1) if low < k * step < high]
