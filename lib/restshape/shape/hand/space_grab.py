"""What the hand holds in space: a body, or a pin."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import TYPE_CHECKING, ClassVar, Protocol

import numpy as np

from restshape.scene.model import Scene
from restshape.shape.script_session import GrabbedStep, Step

if TYPE_CHECKING:
    from restshape.shape.given_shape import Way
    from restshape.shape.hand.gesture import Gesture
    from restshape.shape.outline import Outline

Place = tuple[float, float, float]
STILL: Place = (0.0, 0.0, 0.0)


class Draggable(Protocol):
    """What the hand changes: a session of shapes."""

    outline: Outline
    scene: Scene

    def revised(
        self, wanted: Callable[[], Scene], follow: Callable[[Outline, Scene], Way | None] | None = None
    ) -> Step:
        """One frame of an edit that changes the scene, and the shape where something follows."""


@dataclass(slots=True)
class SpaceGrab(ABC):
    """What the hand holds, where it took hold, and the state before.

    Args:
        name: of what it holds.
        origin, cursor: where the hand took hold, and where it is [m].
        before: shape and scene before the press.
        c: way of the hand that has been gone [m].
    """

    gesture: ClassVar[Gesture | None] = None

    name: str
    origin: Place
    cursor: Place
    before: tuple[Outline, Scene]
    c: Place = STILL

    @abstractmethod
    def moved(self, scene: Scene, c: Place) -> Scene:
        """The scene with what is held where it was at the press, plus a way c [m].

        Raises:
            UserError: it is there no more, or cannot go that way.
        """

    def through(self, path: Sequence[tuple[float, ...]]) -> Sequence[tuple[float, ...]]:
        """Points (2 or 3) [m] that the cursor goes through, in space: without a height it keeps that of before."""
        places = accumulate(path, lambda before, point: in_space(point, before), initial=self.cursor)
        return [tuple(place) for place in places][1:]

    def still(self) -> GrabbedStep:
        """Nothing: what is held in space has no gesture of the shape."""
        return {}

    def dragged(self, session: Draggable, point: tuple[float, ...]) -> Step:
        """The frame in which the cursor goes to a point [m]."""
        c = self.way_to(point)
        if c == self.c:
            return Step("none")
        step = session.revised(lambda: self.moved(session.scene, c))
        self.c = self.c if step.refused else c
        return step

    def whole_way(self, path: Sequence[tuple[float, ...]]) -> Sequence[tuple[float, ...]]:
        """Two or more points [m] that a way of several frames along a path goes through: from where the hand is."""
        return [self.cursor, *path]

    def let_go(self, session: Draggable) -> Step:
        """The frame in which the hand lets go."""
        return Step("none")

    def way_to(self, point: tuple[float, ...]) -> Place:
        """Take the cursor to a point [m]; the way from the origin."""
        self.cursor = in_space(point, self.cursor)
        x, y, z = (np.array(self.cursor) - self.origin).tolist()
        return x, y, z


def in_space(point: tuple[float, ...] | None, own: Place) -> Place:
    """A point (2 or 3) [m] in space, of which what is left out is that of another one."""
    given = point or ()
    x, y, z = (*given, *own[len(given) :])
    return x, y, z
