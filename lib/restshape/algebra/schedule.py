"""The best schedule of refreshes in hindsight."""

import numpy as np

from restshape.arrays import Reals


def best_schedule(refresh_costs: Reals, frame_costs: Reals) -> tuple[float, list[int]]:
    """The least cost of all schedules, and the frames in which it refreshes; frame 0 always does.

    Dynamic programming over the last refresh.

    Args:
        refresh_costs: (n,) of a refresh at frame j, or (n, n) where it depends on the refresh i before it (row i).
        frame_costs: (n, n) of frame j with the preconditioner of frame i <= j (row i); inf where it is not to be used.

    Source: docs/theory/levels-of-reuse.md.
    """
    n = len(frame_costs)
    refresh = np.broadcast_to(refresh_costs, (n, n))
    # spent[i, j]: frames i..j with the preconditioner of frame i.
    spent = np.cumsum(np.triu(frame_costs), axis=1)
    best, before = np.full(n, np.inf), np.full(n, -1)
    first = np.diagonal(refresh)
    for j in range(n):
        if j == 0:
            best[0] = first[0]
            continue
        costs = best[:j] + spent[:j, j - 1] + refresh[:j, j]
        before[j] = int(np.argmin(costs))
        best[j] = costs[before[j]]
    if n == 0:
        return 0.0, []
    whole = best + spent[:, -1]
    at = int(np.argmin(whole))
    refreshes = []
    while at >= 0:
        refreshes.append(at)
        at = int(before[at])
    return float(whole.min()), refreshes[::-1]
