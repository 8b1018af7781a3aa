"""Where straight lines meet chains of them."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from restshape.arrays import Reals


def crossings(a: Reals, b: Reals, chain: Reals) -> Iterator[tuple[float, float]]:
    """Where the segment from a to b meets a chain (m, 2), its ends counted."""
    along, pieces, off = b - a, np.diff(chain, axis=0), chain[:-1] - a
    area = along[0] * pieces[:, 1] - along[1] * pieces[:, 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        s = (off[:, 0] * pieces[:, 1] - off[:, 1] * pieces[:, 0]) / area
        t = (off[:, 0] * along[1] - off[:, 1] * along[0]) / area
    for k in np.flatnonzero((s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0)):
        x, y = a + s[k] * along
        yield float(x), float(y)
