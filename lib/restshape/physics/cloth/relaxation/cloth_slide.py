"""How far cloth may slide as a whole while friction has the normal forces of its last update."""

from __future__ import annotations

import numpy as np

from restshape import _kernels
from restshape.physics.cloth.cloth_problem import ClothProblem

LONGER = 2.0
"""Factor of the room where cloth goes on to slide."""
SETTLED = 1e-3
"""Change of the normal forces' sum, over that sum, below which sliding is steady."""
REACHED = 0.9
"""Share of the room after which friction follows."""
STEADY = 4
"""Runs of steady sliding on half-spaces after which it is said to have no end."""
ALONG = 1e-2
"""Sine of the angle by which a way along a half-space may lead into it: contact gives."""
SLIDES = "friction does not hold the cloth: it slides without end"
"""Why cloth that slides on and on does not converge."""


def slides_on(problem: ClothProblem, before: np.ndarray, after: np.ndarray, least: float) -> bool:
    """Whether cloth has slid as a whole from corners before (n, 3) to after (n, 3) [m], and nothing will ever stop it.

    Half-spaces alone press it, no support holds it, and no body is on its way down.

    Args:
        problem: of the cloth.
        before, after: where it was, and is.
        least: way of what is pressed [m].
    """
    contact = problem.contact
    if contact is None or len(problem.boundary.constrained):
        return False
    way = (after - before).mean(axis=0)
    if np.linalg.norm(way) <= least or problem.g @ way <= 0.0:
        return False
    pressed = False
    for body in contact.bodies:
        distance, gradient, _ = body.hull.distance(after)
        near = distance < contact.thickness
        if np.isfinite(body.inner_radius) and near.any():
            return False
        # A half-space may be left behind, or lie along the way.
        if (gradient @ way).min() < -ALONG * np.linalg.norm(way):
            return False
        pressed = pressed or bool(near.any())
    return pressed and bool(np.linalg.norm(after - before, axis=1).min() > least)


class ClothSlide:
    """Bounds the way of cloth that slides on all that it touches.

    Between two updates friction is no more than the normal forces of the last one allow. Where these are too small, by
    whatever the cloth was off its equilibrium, the energy falls without end along a slope that would hold it. So where
    all that is pressed slides, it goes as far as contact is thick, and twice as far each time that it goes on.

    Args:
        problem: the cloth.

    Attributes:
        ended: the last run has ended for it.
    """

    def __init__(self, problem: ClothProblem) -> None:
        self.problem, self.ended, self.ends, self.steady = problem, False, 0, 0
        self.room = self.total = 0.0
        self.node, self.corners = np.empty(0, dtype=np.int64), np.empty((0, 3))
        self.normal = self.start = np.empty((0, 3))

    def begin(self, x: np.ndarray, first: bool) -> bool:
        """Begin a run from x (n, 3) [m], where friction has followed; returns whether the last one began to slide.

        Args:
            x: positions.
            first: no run has been before it.
        """
        contact = self.problem.contact
        if contact is None:
            return False
        before, self.total = self.total, float(contact.history.limits.sum())
        self.ends = 0 if first or not self.ended else self.ends + 1
        self.room = LONGER * self.room if self.ends > 1 else contact.thickness
        steady = not first and abs(self.total - before) <= SETTLED * self.total
        self.ended, self.steady = False, self.steady if steady else 0
        # One row for each pair of a body and what it presses.
        body, self.node = np.nonzero(contact.history.limits)
        self.normal = contact.history.normals[body, self.node]
        self.start, self.corners = self._places(x)[self.node], self.problem.corners(x)
        return self.ends == 1

    def share(self, x: np.ndarray, d: np.ndarray) -> float:
        """The largest share, in (0, 1], of a step d (n, 3) [m] from x (n, 3) [m] that stays in the room."""
        if not len(self.node):
            return 1.0
        after = self._least(x + d)
        if after <= self.room:
            return 1.0
        return float(np.clip((self.room - self._least(x)) / (after - self._least(x)), 0.1 * self.room / after, 1.0))

    def reached(self, x: np.ndarray) -> bool:
        """Whether cloth at x (n, 3) [m] has slid so far that friction has to follow."""
        self.ended = len(self.node) > 0 and self._least(x) >= REACHED * self.room
        return self.ended

    def endless(self, x: np.ndarray) -> bool:
        """Whether cloth at x (n, 3) [m], where a run has ended, slides steadily where nothing will ever stop it."""
        contact, corners = self.problem.contact, self.problem.corners(x)
        slides = contact is not None and slides_on(self.problem, self.corners, corners, contact.slip)
        self.steady = self.steady + 1 if slides else 0
        return self.steady >= STEADY

    def _places(self, x: np.ndarray) -> np.ndarray:
        """Places (corners + points, 3) [m] of what may be pressed."""
        return self.problem.contact.place(self.problem.corners(x))

    def _least(self, x: np.ndarray) -> float:
        """The least way [m] along the surfaces that what is pressed has gone since the run began."""
        return _kernels.least_slide(self._places(x), self.node, self.start, self.normal)
