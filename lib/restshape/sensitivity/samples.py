"""What the answers and derivatives at several places of a drag predict for the others: moving least squares."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from restshape import _kernels

if TYPE_CHECKING:
    from restshape.arrays import Reals
    from restshape.shape.hand.gesture import Gesture

Hand = tuple[float, float]
"""Coefficients of a gesture."""
NEAREST = 0.01
"""Distance between two samples at least, in sizes of the shape."""
SAME = 1e-3
"""Distance, in sizes of the shape, below which a place is the same."""
STEP = 0.1
"""Of the epsilon, in which the slope of what samples predict is taken by differences."""
NONE = np.empty(0)


@dataclass(frozen=True)
class SamplePlace:
    """Where a sample is, and what it is of.

    Args:
        c: coefficients of the hand.
        frame: index of the frame that it was taken in.
        mesh: version of the mesh that it was solved on.
        projected: it was interpolated from another mesh.
    """

    c: Hand
    frame: int
    mesh: object
    projected: bool = False


class DragSamples:
    """Values around the hand by generalised moving least squares, from at most so many samples of a drag.

    x(d) = p(d)^T G^-1 [sum_{m>=0} w_m p(d^m) x^m + sum_{m>=1} w_m sum_j dp/dd_j s_j^m] with p = (1, d_1, d_2), w_m =
    1/(|d - d^m|^2 + epsilon^2), and G the same sums of p p^T and dp dp^T. The samples m >= 1 have values and both
    derivatives; m = 0 is the last state that a solver has taken steps to, and has values alone.

    Args:
        gesture: what the hand holds, whose coefficients c are.
        size: of the shape; d = c / size.
        epsilon: keeps weights finite, in sizes or, where that is less, in distances of the samples; see `smoothing`.
        most: samples that are kept.

    Attributes:
        places: of the samples, in the order in which they were taken.
        mesh: version of the mesh whose answers they agree with.

    Source: docs/theory/design-derivative.md; 5.1.5 of the thesis; Martin et al., Unified simulation of elastic rods,
    shells, and solids, ACM Trans. Graph. 29 (2010) 39.
    """

    def __init__(self, gesture: Gesture, size: float, epsilon: float, most: int) -> None:
        self.gesture, self.size, self.epsilon, self.most = gesture, size, epsilon, most
        self.places: list[SamplePlace] = []
        self.last: Hand | None = None
        self.mesh: object = None
        self._shape: tuple[int, ...] = ()
        self._rows: Reals = np.empty((0, 0))

    def __len__(self) -> int:
        return len(self.places)

    @property
    def c(self) -> Hand:
        """Where the newest sample is."""
        return self.places[-1].c

    @property
    def shape(self) -> tuple[int, ...]:
        """Of the values of a sample."""
        return self._shape

    @property
    def smoothing(self) -> float:
        """The epsilon of the weights, in sizes: samples nearer than that weigh alike.

        That is the given share of the size, or of the root mean square distance of all places from their mean where
        these are closer: a hand that stays within epsilon would weigh all of them alike.
        """
        places = np.array([at.c for at in self.places] + ([] if self.last is None else [self.last]))
        spread = float(np.sqrt(((places - places.mean(axis=0)) ** 2).sum(axis=1).mean())) if len(places) else 0.0
        return self.epsilon * min(1.0, max(SAME, spread / self.size))

    def distance(self, c: Hand) -> float:
        """From a place of the hand to the nearest sample, in the gesture's coefficients."""
        return min((float(np.hypot(c[0] - at.c[0], c[1] - at.c[1])) for at in self.places), default=np.inf)

    def knows(self, c: Hand, mesh: object, rests: bool = False) -> bool:
        """Whether there is a sample of this mesh so near that another one there would take its place.

        Where the hand rests, it is worth to take that place, unless it is the very same.
        """
        least = SAME if rests else NEAREST
        return any(at.mesh == mesh and not at.projected for at in self._near(c, least))

    def add(self, place: SamplePlace, values: Reals, derivatives: Reals) -> None:
        """Take a sample; those too near it go, and of more than `most` the one farthest from it.

        Args:
            place: of it.
            values: of the shape that all have; derivatives: (2, ...) by the hand's coefficients.
        """
        if not self.places:
            self._shape, self._rows = values.shape, np.zeros((1 + 3 * self.most, values.size))
        near = self._near(place.c)
        self._keep([at not in near for at in self.places])
        if len(self.places) == self.most:
            ways = [np.hypot(place.c[0] - at.c[0], place.c[1] - at.c[1]) for at in self.places]
            self._keep([k != int(np.argmax(ways)) for k in range(self.most)])
        row = 1 + 3 * len(self.places)
        self._rows[row] = values.ravel()
        self._rows[row + 1 : row + 3] = derivatives.reshape(2, -1)
        self.places.append(place)

    def clear(self) -> None:
        """Forget all."""
        self.places, self.last = [], None

    def set_last(self, c: Hand, values: Reals) -> None:
        """Take note of the last state on which solver steps were taken."""
        if len(self.places):
            self._rows[0], self.last = values.ravel(), c

    def change(self, changed: Callable[[Reals], Reals]) -> None:
        """Apply a linear function of values to all values and derivatives, such as a turn of modes."""
        for row in self._rows[: 1 + 3 * len(self.places)]:
            row[:] = changed(row.reshape(self._shape)).ravel()

    def rebase(self, c: Hand, values: Reals, derivatives: Reals) -> None:
        """Add to all samples the linear function of the hand that takes their prediction at c to what is known there.

        So samples of another mesh, whose own errors differ, tell of this one what is not linear.

        Args:
            c: where values and derivatives (2, ...) are known.
        """
        if not len(self.places):
            return
        step, jump = STEP * self.smoothing * self.size, (values - self(c)).ravel()
        around = [[self((c[0] + way * (j == 0), c[1] + way * (j == 1))) for way in (step, -step)] for j in range(2)]
        slopes = [(derivatives[j] - (one - other) / (2.0 * step)).ravel() for j, (one, other) in enumerate(around)]
        for m, at in enumerate(self.places):
            rows = self._rows[1 + 3 * m : 4 + 3 * m]
            rows[0] += jump + (at.c[0] - c[0]) * slopes[0] + (at.c[1] - c[1]) * slopes[1]
            rows[1:] += slopes
        if self.last is not None:
            self._rows[0] += jump + (self.last[0] - c[0]) * slopes[0] + (self.last[1] - c[1]) * slopes[1]

    def projected(self, there: Callable[[Reals], Reals]) -> DragSamples:
        """The same samples on another mesh, marked as projected.

        Args:
            there: values and derivatives (count, ...) on that mesh, from those (count, ...) on this one.
        """
        found = DragSamples(self.gesture, self.size, self.epsilon, self.most)
        known = 1 + 3 * len(self.places)
        rows = there(self._rows[:known].reshape(known, *self._shape))
        found._shape, found._rows = rows.shape[1:], np.zeros((1 + 3 * self.most, rows[0].size))
        found._rows[:known] = rows.reshape(known, -1)
        found.places = [replace(at, projected=True) for at in self.places]
        found.last, found.mesh = self.last, self.mesh
        return found

    def __call__(self, c: Hand) -> Reals:
        """The values with the hand at c."""
        out = np.empty(self._rows.shape[1])
        last = NONE if self.last is None else np.array(self.last)
        places = np.array([at.c for at in self.places])
        _kernels.gmls(np.array(c), last, places, self.size, self.smoothing**2, self._rows, out)
        return out.reshape(self._shape)

    def _near(self, c: Hand, least: float = NEAREST) -> list[SamplePlace]:
        """The samples nearer than so many sizes."""
        return [at for at in self.places if np.hypot(c[0] - at.c[0], c[1] - at.c[1]) < least * self.size]

    def _keep(self, kept: list[bool]) -> None:
        """Let go of samples; those that stay move up."""
        if all(kept):
            return
        stay = [k for k, one in enumerate(kept) if one]
        for new, old in enumerate(stay):
            if new != old:
                self._rows[1 + 3 * new : 4 + 3 * new] = self._rows[1 + 3 * old : 4 + 3 * old]
        self.places = [self.places[k] for k in stay]
