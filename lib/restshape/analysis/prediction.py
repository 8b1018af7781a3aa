"""Guesses of the next step of a motion from the steps before."""

import numpy as np

KEPT = 4
RIDGE = 1e-10


class Prediction:
    """The next increment of a motion as the combination of the last two that would have predicted the last two best.

    One harmonic, damped or growing, obeys such a recurrence exactly (Prony 1795).

    Args:
        size: unknowns.
    """

    def __init__(self, size: int) -> None:
        self.steps = np.zeros((KEPT, size))
        self.products = np.zeros((KEPT, KEPT))
        self.count = 0

    def keep(self, step: np.ndarray) -> None:
        """Remember the increment (size,) that has just been made."""
        place = self.count % KEPT
        self.steps[place] = step
        self.products[place] = self.products[:, place] = self.steps @ step
        self.count += 1

    def __call__(self) -> np.ndarray:
        """The guess (size,) of the next increment: 0 at first, then the last one, then their combination."""
        last, before, third, fourth = ((self.count - k) % KEPT for k in range(1, KEPT + 1))
        if self.count < KEPT:
            return self.steps[last]
        g = self.products.tolist()
        # Least squares of last = p before + q third and before = p third + q fourth.
        a, b = g[before][before] + g[third][third], g[third][before] + g[fourth][third]
        c, f, h = g[third][third] + g[fourth][fourth], g[before][last] + g[third][before], g[third][last]
        h += g[fourth][before]
        shift = RIDGE * (a + c)
        a, c = a + shift, c + shift
        determinant = a * c - b * b
        if determinant <= 0.0:
            return self.steps[last]
        p, q = (c * f - b * h) / determinant, (a * h - b * f) / determinant
        guess = self.steps[last] * p
        guess += q * self.steps[before]
        return guess
