"""Guesses of the next step of a motion from the steps before."""

import numpy as np

TERMS = 4
EQUATIONS = 3
RIDGE = 1e-10


class Prediction:
    """The next increment of a motion as the linear combination that would have predicted the last ones best.

    Sums of few harmonics, damped or growing, obey such a recurrence exactly (Prony 1795): two terms a frequency.

    Args:
        size: unknowns.
    """

    def __init__(self, size: int) -> None:
        self.kept = TERMS + EQUATIONS
        self.steps = np.zeros((self.kept, size))
        self.products = np.zeros((self.kept, self.kept))
        self.count = 0

    def keep(self, step: np.ndarray) -> None:
        """Remember the increment (size,) that has just been made."""
        place = self.count % self.kept
        self.steps[place] = step
        self.products[place] = self.products[:, place] = self.steps @ step
        self.count += 1

    def __call__(self) -> np.ndarray:
        """The guess (size,) of the next increment: 0 at first, then the last one, then their combination."""
        last = (self.count - 1) % self.kept
        if self.count < self.kept:
            return self.steps[last]
        order = (last - np.arange(self.kept)) % self.kept
        gram = self.products[np.ix_(order, order)]
        normal, right = np.zeros((TERMS, TERMS)), np.zeros(TERMS)
        for late in range(EQUATIONS):
            early = slice(late + 1, late + 1 + TERMS)
            normal += gram[early, early]
            right += gram[early, late]
        shift = RIDGE * np.trace(normal)
        if shift == 0.0:
            return self.steps[last]
        normal.flat[:: TERMS + 1] += shift
        weights = np.zeros(self.kept)
        weights[order[:TERMS]] = np.linalg.solve(normal, right)
        return weights @ self.steps
