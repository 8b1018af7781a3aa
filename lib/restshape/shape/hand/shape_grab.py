"""What the hand holds of a shape: a part of it, along a gesture."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass

from restshape.errors import UserError
from restshape.scene.bodies import pins_of
from restshape.scene.model import Scene
from restshape.shape.hand.gesture import Gesture
from restshape.shape.hand.space_grab import Draggable
from restshape.shape.outline import Outline
from restshape.shape.script_session import STILL, GrabbedStep, Step
from restshape.shape.validity import MotionCheck, too_far


@dataclass(slots=True)
class Grab(ABC):
    """What the hand holds, where it took hold, and the state before.

    Args:
        gesture: that it goes along.
        origin, cursor: where the hand took hold, and where it is [m].
        before: shape and scene before the press.
        c: way of the hand that has been gone [m].
        name: of what it holds.
    """

    gesture: Gesture
    origin: tuple[float, float]
    cursor: tuple[float, float]
    before: tuple[Outline, Scene]
    c: tuple[float, float] = STILL
    name: str = ""

    @abstractmethod
    def taken(self, session: Draggable, c: tuple[float, float]) -> Outline | str:
        """The shape when the hand has gone a way c [m], or why it cannot be."""

    def through(self, path: Sequence[tuple[float, ...]]) -> Sequence[tuple[float, ...]]:
        """Points [m] that the cursor goes through, in the plane.

        Raises:
            UserError: one of them has a height.
        """
        for point in path:
            if len(point) > 2:
                pins = pins_of(self.before[1])
                pin = f"press on supports.{self.name}, which moves in space, or " * (self.name in pins)
                raise UserError(f"{self.name} is a part of the shape, which has no z", do=f"{pin}leave z out")
        return path

    def still(self) -> GrabbedStep:
        """Gesture and coefficients of a frame in which nothing moves."""
        return {"gesture": self.gesture, "c": self.c}

    def whole_way(self, path: Sequence[tuple[float, ...]]) -> Sequence[tuple[float, ...]]:
        """Two or more points [m] that a way of several frames along a path goes through: from where the hand is."""
        return [self.cursor, *path]

    def let_go(self, session: Draggable) -> Step:
        """The frame in which the hand lets go."""
        return Step("none")

    def dragged(self, session: Draggable, point: tuple[float, ...]) -> Step:
        """The frame in which the cursor goes to a point [m]."""
        self.cursor = (point[0], point[1])
        c = (point[0] - self.origin[0], point[1] - self.origin[1])
        if c == self.c:
            return Step("none", **self.still())
        found = self.taken(session, c)
        if isinstance(found, str):
            return Step("none", found, **self.still())
        self.c = c
        session.outline = found
        return Step("move", **self.still())


@dataclass(slots=True, kw_only=True)
class ShapeGrab(Grab):
    """What the hand holds, as of `Grab`, along a linear gesture.

    Args:
        check: what may come of it.
        reach: how far it may surely go [m].
    """

    check: MotionCheck
    reach: float

    def taken(self, session: Draggable, c: tuple[float, float]) -> Outline | str:
        """The shape when the hand has gone a way c [m], or why it cannot be."""
        far = too_far(session.outline, c) if max(map(abs, c)) > self.reach else None
        return far or self.check.problem(c) or session.outline.moved(self.gesture.points(c))
