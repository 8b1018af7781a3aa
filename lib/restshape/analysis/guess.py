"""Initial guesses of a solve from the solutions of the frames before."""

import numpy as np


class Guess:
    """A guess along the line through the last two solutions of the same drag.

    Args:
        extrapolate: false gives the last solution as it is.
    """

    def __init__(self, extrapolate: bool) -> None:
        self.extrapolate = extrapolate
        self.restart()

    def restart(self) -> None:
        """Forget the solutions: the nodes are others now."""
        self.last: np.ndarray | None = None
        self.before: np.ndarray | None = None
        self.step = (0.0, 0.0)
        self.hand: tuple[object, tuple[float, float]] = (None, (0.0, 0.0))

    def __call__(self, x: np.ndarray, hand: tuple[object, tuple[float, float]]) -> np.ndarray:
        """The guess (n, f) for the hand at (gesture, (c0, c1)); x (n, f) is the last solution."""
        ratio = self._ratio(hand)
        return x if ratio == 0.0 else x + ratio * (self.last - self.before)

    def keep(self, x: np.ndarray, hand: tuple[object, tuple[float, float]]) -> None:
        """Remember the solution x (n, f) at this place of the hand."""
        same = hand[0] is self.hand[0]
        self.before = self.last if same else None
        self.step = (hand[1][0] - self.hand[1][0], hand[1][1] - self.hand[1][1]) if same else (0.0, 0.0)
        self.last, self.hand = x, hand

    def _ratio(self, hand: tuple[object, tuple[float, float]]) -> float:
        """How much of the last step this step repeats, at most twice."""
        if not self.extrapolate or self.before is None or hand[0] is not self.hand[0]:
            return 0.0
        (a, b), (c, d) = self.step, (hand[1][0] - self.hand[1][0], hand[1][1] - self.hand[1][1])
        square = a * a + b * b
        return max(-2.0, min(2.0, (a * c + b * d) / square)) if square > 0 else 0.0
