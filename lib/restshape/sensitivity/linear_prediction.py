"""What the design derivative at one frame of a drag predicts for the others."""

import numpy as np

from restshape import _kernels
from restshape.shape.hand.gesture import Gesture


class Prediction:
    """x0 + (c - c0)_1 s_1 + (c - c0)_2 s_2: the displacement with the hand at c, to first order.

    Args:
        gesture: what the hand holds, whose coefficients c are.
        c: the coefficients c0 at which x was solved for.
        x: (n, 2) displacement x0 [m] there.
        s: (2, n, 2) its derivatives with respect to c.

    Source: docs/theory/design-derivative.md; (5.16) of the thesis.
    """

    def __init__(self, gesture: Gesture, c: tuple[float, float], x: np.ndarray, s: np.ndarray) -> None:
        self.gesture, self.c, self._shape = gesture, c, x.shape
        self._terms = np.concatenate([x.reshape(1, -1), s.reshape(2, -1)])

    def __call__(self, c: tuple[float, float]) -> np.ndarray:
        """The displacement (n, 2) [m] with the hand at c."""
        weights = np.array([1.0, c[0] - self.c[0], c[1] - self.c[1]])
        used, found = np.flatnonzero(weights), np.empty(self._shape)
        _kernels.weighted_sum(weights[used].tolist(), [self._terms[k] for k in used], found)
        return found
