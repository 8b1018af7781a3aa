"""Initial guesses of a solve from the solutions of the frames before."""

from collections.abc import Callable

import numpy as np

from restshape import _kernels

SPACING = 0.4
"""Steps of a drag whose lengths differ by more than this factor are no ground for a parabola."""


class Guess:
    """A guess along the line through the last two solutions of the same drag.

    Args:
        extrapolate: false gives the last solution as it is.
        warm: false gives zeros.
    """

    def __init__(self, extrapolate: bool, warm: bool = True) -> None:
        self.extrapolate, self.warm = extrapolate, warm
        self.restart()

    def restart(self) -> None:
        """Forget the solutions: the nodes are others now."""
        self.last: np.ndarray | None = None
        self.before: np.ndarray | None = None
        self.step = (0.0, 0.0)
        self.hand: tuple[object, tuple[float, float]] = (None, (0.0, 0.0))

    def __call__(self, x: np.ndarray, hand: tuple[object, tuple[float, float]]) -> np.ndarray:
        """The guess (n, f) for the hand at (gesture, (c0, c1)); x (n, f) is the last solution."""
        terms = self.terms(x, hand)
        if len(terms) == 1 and terms[0][0] == 1.0:
            return x
        found = np.empty_like(x)
        _kernels.weighted_sum([weight for weight, _ in terms], [field for _, field in terms], found)
        return found

    def terms(self, x: np.ndarray, hand: tuple[object, tuple[float, float]]) -> list[tuple[float, np.ndarray]]:
        """The weights and the fields (n, f) of which the guess is the sum; arguments as of a call."""
        if not self.warm:
            return []
        ratio = self._ratio(hand)
        if ratio == 0.0 or self.last is None or self.before is None:
            return [(1.0, x)]
        if self.last is x:
            return [(1.0 + ratio, x), (-ratio, self.before)]
        return [(1.0, x), (ratio, self.last), (-ratio, self.before)]

    def keep(self, x: np.ndarray, hand: tuple[object, tuple[float, float]]) -> None:
        """Remember the solution x (n, f) at this place of the hand."""
        same = hand[0] is self.hand[0]
        self.before = self.last if same else None
        self.step = (hand[1][0] - self.hand[1][0], hand[1][1] - self.hand[1][1]) if same else (0.0, 0.0)
        self.last, self.hand = x, hand

    def interpolate(self, interpolate: Callable[[np.ndarray], np.ndarray]) -> None:
        """Take the solutions where their nodes are now, by a function of fields (n, f)."""
        self.last, self.before = (None if x is None else interpolate(x) for x in (self.last, self.before))

    def _ratio(self, hand: tuple[object, tuple[float, float]]) -> float:
        """How much of the last step this step repeats, at most twice."""
        if not self.extrapolate or self.before is None or hand[0] is not self.hand[0]:
            return 0.0
        (a, b), (c, d) = self.step, (hand[1][0] - self.hand[1][0], hand[1][1] - self.hand[1][1])
        square = a * a + b * b
        return max(-2.0, min(2.0, (a * c + b * d) / square)) if square > 0 else 0.0


class CurvedGuess(Guess):
    """A guess along the parabola through the last three solutions of the same drag, where they lie well for one.

    Arguments as of `Guess`.
    """

    def restart(self) -> None:
        """Forget the solutions: the nodes are others now."""
        super().restart()
        self.oldest: np.ndarray | None = None
        self.older_step = (0.0, 0.0)

    def keep(self, x: np.ndarray, hand: tuple[object, tuple[float, float]]) -> None:
        """Remember the solution x (n, f) at this place of the hand."""
        same = hand[0] is self.hand[0]
        oldest, older_step = (self.before, self.step) if same else (None, (0.0, 0.0))
        super().keep(x, hand)
        self.oldest, self.older_step = oldest, older_step

    def interpolate(self, interpolate: Callable[[np.ndarray], np.ndarray]) -> None:
        """Take the solutions where their nodes are now, by a function of fields (n, f)."""
        super().interpolate(interpolate)
        self.oldest = None if self.oldest is None else interpolate(self.oldest)

    def terms(self, x: np.ndarray, hand: tuple[object, tuple[float, float]]) -> list[tuple[float, np.ndarray]]:
        """The weights and the fields (n, f) of which the guess is the sum; arguments as of a call."""
        weights = self._weights(hand)
        if weights is None or self.before is None or self.oldest is None:
            return super().terms(x, hand)
        return list(zip(weights, (x, self.before, self.oldest)))

    def _weights(self, hand: tuple[object, tuple[float, float]]) -> tuple[float, float, float] | None:
        """Lagrange's weights of the last three solutions over their way along this step; None where it bends."""
        if not self.extrapolate or self.oldest is None or hand[0] is not self.hand[0]:
            return None
        ahead = (hand[1][0] - self.hand[1][0], hand[1][1] - self.hand[1][1])
        t = ahead[0] * ahead[0] + ahead[1] * ahead[1]
        # Ways times the length of this step, backwards from the last solution.
        p = self.step[0] * ahead[0] + self.step[1] * ahead[1]
        q = self.older_step[0] * ahead[0] + self.older_step[1] * ahead[1]
        if t == 0.0 or p < SPACING * t or q < SPACING * p or p < SPACING * q:
            return None
        return (t + p) * (t + p + q) / (p * (p + q)), -t * (t + p + q) / (p * q), t * (t + p) / ((p + q) * q)
