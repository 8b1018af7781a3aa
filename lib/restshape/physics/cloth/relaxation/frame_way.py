"""Bodies, and what friction remembers, on their way from the last rest to a frame."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from restshape.physics.cloth.body_path import BodyPath
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.contact import FrictionHistory
from restshape.physics.cloth.relaxation.follow_bodies import take_along
from restshape.physics.cloth.scene import kernel_body
from restshape.scene.bodies import Body


class FrameWay:
    """Bodies, and what friction remembers, at any share of the way from the last rest to a frame.

    Args:
        problem: its friction is that of the last rest, in the material of the frame.
        before: bodies at the last rest.
        after: in the frame.
        slid: (n, 3) [m] how far friction has followed the material of the frame where the cloth has not yet; None: both
            have.
    """

    def __init__(
        self,
        problem: ClothProblem,
        before: tuple[Body, ...],
        after: tuple[Body, ...],
        slid: np.ndarray | None = None,
    ) -> None:
        self._contact, self._own = problem.contact, problem.self_contact
        self._before, self._after = before, after
        self._history = self._contact.history if self._contact else None
        self._layers = self._own.history if self._own else None
        self._slid = None if slid is None else problem.corners(slid)
        self.path = BodyPath(before, after, self._contact) if self._contact else None

    @property
    def slides(self) -> bool:
        """Whether the cloth begins behind its material."""
        return self._slid is not None

    @property
    def moves(self) -> bool:
        """Whether bodies do, or the material beneath friction."""
        rubs = self._contact is not None or (self._own is not None and self._own.rough)
        return (self.path is not None and self.path.moves) or (self.slides and rubs)

    def place(self, share: float) -> None:
        """Let bodies and friction be at a share of their way."""
        if self._contact:
            bodies = self._bodies(share)
            history = self._followed(share)
            history = take_along(history, self._before, bodies) if share > 0.0 else history
            self._contact.bodies, self._contact.history = [kernel_body(body) for body in bodies], history
        if self._own and self._slid is not None:
            self._own.history = self._layers.moved((share - 1.0) * self._slid)

    def _bodies(self, share: float) -> tuple[Body, ...]:
        if 0.0 < share < 1.0:
            return self.path.at(share)
        return self._after if share else self._before

    def _followed(self, share: float) -> FrictionHistory:
        """What friction with bodies remembers where the material has gone a share of its way."""
        if self._slid is None:
            return self._history
        way = self._contact.place(self._slid)
        return replace(self._history, anchors=self._history.anchors + (share - 1.0) * way)
