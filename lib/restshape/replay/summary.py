"""What a replay was, summed up for programs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restshape.arrays import Reals
from restshape.replay.tally import Summary, Tally

if TYPE_CHECKING:
    from restshape.analysis.analysis import RowValues


def percentiles(ms: Reals) -> dict[str, float]:
    """Median, 95th and 99th percentile [ms] of frame times; zeros when there are none."""
    values = np.percentile(ms, (50, 95, 99)) if len(ms) else np.zeros(3)
    return dict(zip(("p50", "p95", "p99"), map(float, values)))


def summarise(rows: list[RowValues], policy: str, ranks: int, estimated_quantity: str = "") -> Summary:
    """Counts, times and quantities of a replay from its rows, and the `rows`.

    Args:
        rows: of all frames.
        policy: its name.
        ranks: how many.
        estimated_quantity: what the error estimates are of.
    """
    tally = Tally()
    for row in rows:
        tally.add(row)
    return tally.summary(policy, ranks, estimated_quantity) | {"rows": rows}
