"""The best schedule of refreshes by a table of what all frames cost with the preconditioners of all others."""

import math

import numpy as np

from restshape.algebra.reuse.schedule import Schedule


def best_schedule(refresh, frame, window=math.inf, slack=math.inf, looked=None):
    """The least cost, and the frames in which that schedule refreshes.

    Args:
        refresh: (n,) cost of a refresh at frame j, or (n, n) where it depends on the refresh i before it (row i).
        frame: (n, n) cost of frame j with the preconditioner of frame i <= j (row i).
        window, slack: of the schedule; looked: takes the costs that were asked for.
    """
    n = len(frame)
    table, made = np.broadcast_to(refresh, (n, n)), Schedule(window, slack)
    for j in range(n):

        def cost(i, j=j):
            if looked is not None:
                looked.append((i, j))
            return float(frame[i][j])

        made.add(lambda i, j=j: float(table[i, j]), cost)
    return made.best()
