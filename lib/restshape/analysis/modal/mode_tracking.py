"""Mode ids that follow modes from frame to frame by their shape, not by the rank of their frequency."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import permutations

import numpy as np

SAME = 0.3
"""Modal assurance criterion (MAC) above which two modes may be the same one. Modes that meet and part again share
theirs: half each where they turn by 45 degrees in a frame."""
FEW = 6
"""Modes whose 720 orders at most are all tried."""


def normalise_signs(modes: np.ndarray, mass_products: np.ndarray) -> None:
    """Make the component of largest size positive: a mode's sign means nothing, but must not depend on luck.

    Args:
        modes: (k, n), changed in place; mass_products: (k, n) their products M phi, likewise.
    """
    for mode, weight in zip(modes, mass_products):
        # The first one of nearly the largest, for symmetric modes have several.
        top = np.flatnonzero(np.abs(mode) > 0.999 * np.abs(mode).max())[0]
        if mode[top] < 0.0:
            mode *= -1.0
            weight *= -1.0


@dataclass(frozen=True, eq=False)
class ModeIds:
    """The id of each mode, which it keeps for as long as it is computed, across crossings too.

    Args:
        ids: (k,) of the modes of a frame, in the order of their frequencies.
        free: the next id that no mode has had.
    """

    ids: np.ndarray
    free: int

    @classmethod
    def first(cls, count: int, chosen: np.ndarray) -> ModeIds:
        """Ids of modes that none has gone before.

        Args:
            count: how many there are.
            chosen: indices of those that get the lowest ids, in their order.
        """
        order = [*chosen, *(k for k in range(count) if k not in set(chosen))]
        ids = np.empty(count, dtype=int)
        ids[order] = np.arange(1, count + 1)
        return cls(ids, count + 1)

    @classmethod
    def none(cls) -> ModeIds:
        """Those of no mode."""
        return cls(np.empty(0, dtype=int), 1)

    def reordered(self, order: np.ndarray) -> ModeIds:
        """The same where mode k is what was mode order[k]."""
        return ModeIds(self.ids[order], self.free)

    def recalled(self, known: np.ndarray, chosen: np.ndarray) -> ModeIds:
        """Ids of which chosen modes have those that they had on this shape; others that have one of these get new ones.

        Args:
            known: (k,) ids that there were, by rank.
            chosen: (m,) indices of these modes now, by rank.
        """
        count = min(len(known), len(chosen))
        ids, free = self.ids.copy(), self.free
        ids[chosen[:count]] = known[:count]
        others = np.setdiff1d(np.arange(len(ids)), chosen[:count])
        for column in others[np.isin(ids[others], known[:count])]:
            ids[column], free = free, free + 1
        return ModeIds(ids, free)

    def track(self, before: np.ndarray, after: np.ndarray, mass_products: np.ndarray, sizes: np.ndarray) -> ModeIds:
        """The ids of the modes of a frame: of those before that look most like them, whose signs they take.

        Args:
            before: (k, n) modes that these ids are of, on the nodes of now.
            after: (m, n) modes of now, whose signs are changed in place.
            mass_products: (m, n) their products M phi, likewise.
            sizes: (k,) phi^T M phi of the modes before, in the mass of now.
        """
        overlap = before @ mass_products.T
        # Transferred to a new mesh old modes are not of unit mass any more; new ones are. A body that was thrown off
        # its old place takes nothing of its modes along.
        mac = overlap**2 / np.where(sizes > 0.0, sizes, np.inf)[:, None]
        ids, free = np.full(len(after), -1), self.free
        for row, column in enumerate(assigned(mac)):
            if column < 0:
                continue
            if mac[row, column] >= SAME:
                ids[column] = self.ids[row]
                if overlap[row, column] < 0.0:
                    after[column] *= -1.0
                    mass_products[column] *= -1.0
        for column in np.flatnonzero(ids < 0):
            ids[column], free = free, free + 1
        return ModeIds(ids, free)


def assigned(mac: np.ndarray) -> np.ndarray:
    """The column (k,) of each row of an array (k, m), each column once, that makes the sum largest; -1: none is alike.

    A value that is larger than the largest others in its row and in its column together is in every such sum: else to
    exchange two columns would make it larger.
    """
    found = np.full(len(mac), -1)
    if not mac.size:
        return found
    rows = np.arange(len(mac))
    best = mac.argmax(axis=1)
    in_row, in_column = mac.copy(), mac[:, best]
    in_row[rows, best] = in_column[rows, rows] = 0.0
    sure = mac[rows, best] > in_row.max(axis=1) + in_column.max(axis=0)
    found[sure] = best[sure]
    left, free = np.flatnonzero(~sure), np.setdiff1d(np.arange(mac.shape[1]), best[sure])
    others = mac[np.ix_(left, free)]
    if (others < SAME).all():
        return found
    few = max(others.shape) <= FEW and np.isfinite(others).all()
    rows, columns = _by_trial(others) if few else _by_search(others)
    found[left[rows]] = free[columns]
    return found


def _by_trial(mac: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows, and the column of each, that make the sum of a few values (k, m) largest; as many as there can be."""
    if len(mac) > mac.shape[1]:
        columns, rows = _by_trial(mac.T)
        return rows, columns
    rows = np.arange(len(mac))
    trials = np.array([*permutations(range(mac.shape[1]), len(mac))])
    return rows, trials[mac[rows, trials].sum(axis=1).argmax()]


def _by_search(mac: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The same of many values."""
    # Modes of few bodies turn so far in a frame, and SciPy's optimisers take 0.1 s to load.
    from scipy.optimize import linear_sum_assignment

    rows, columns = linear_sum_assignment(-mac)
    return rows, columns
