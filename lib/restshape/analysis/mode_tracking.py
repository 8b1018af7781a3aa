"""Modes that are followed from frame to frame: by their shape, not by the rank of their frequency."""

import numpy as np
from scipy.optimize import linear_sum_assignment

SAME = 0.3
"""Modal assurance criterion (MAC) above which two modes may be the same one. Modes that meet and part again share
theirs: half each where they turn by 45 degrees in a frame."""


def upright(modes: np.ndarray, heavy: np.ndarray) -> None:
    """Make the component of largest size positive: a mode's sign means nothing, but must not depend on luck.

    Args:
        modes: (k, n), changed in place; heavy: (k, n) their products M phi, likewise.
    """
    for mode, weight in zip(modes, heavy):
        # The first one of nearly the largest, for symmetric modes have several.
        top = np.flatnonzero(np.abs(mode) > 0.999 * np.abs(mode).max())[0]
        if mode[top] < 0.0:
            mode *= -1.0
            weight *= -1.0


class Following:
    """Gives each mode a number that it keeps for as long as it is computed, across crossings too.

    Attributes:
        numbers: (k,) of the modes of the last frame, in the order of their frequencies.
    """

    def __init__(self) -> None:
        self.numbers = np.empty(0, dtype=int)
        self._next = 1

    def begin(self, count: int, first: np.ndarray) -> None:
        """Number modes that none has gone before.

        Args:
            count: how many there are.
            first: indices of those that get the lowest numbers, in their order.
        """
        order = [*first, *(k for k in range(count) if k not in set(first))]
        self.numbers = np.empty(count, dtype=int)
        self.numbers[order] = np.arange(1, count + 1)
        self._next = count + 1

    def __call__(self, before: np.ndarray, after: np.ndarray, heavy: np.ndarray, sizes: np.ndarray) -> None:
        """Number the modes of a frame as those before that look most like them, and turn them the same way.

        Args:
            before: (k, n) modes that `numbers` are of, on the nodes of now.
            after: (m, n) modes of now, whose signs are changed in place; heavy: (m, n) their products M phi, likewise.
            sizes: (k,) phi^T M phi of the modes before, in the mass of now.
        """
        overlap = before @ heavy.T
        # Carried to another mesh the old modes are not of unit mass any more; new ones are. A body that was thrown off
        # its old place takes nothing of its modes along.
        mac = overlap**2 / np.where(sizes > 0.0, sizes, np.inf)[:, None]
        rows, columns = linear_sum_assignment(-mac)
        numbers = np.full(len(after), -1)
        for row, column in zip(rows, columns):
            if mac[row, column] >= SAME:
                numbers[column] = self.numbers[row]
                if overlap[row, column] < 0.0:
                    after[column] *= -1.0
                    heavy[column] *= -1.0
        for column in np.flatnonzero(numbers < 0):
            numbers[column], self._next = self._next, self._next + 1
        self.numbers = numbers
