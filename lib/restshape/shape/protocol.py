"""What a replay needs of an edit session, whatever it edits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from restshape.scene.event_line import EventLine
from restshape.scene.model import Scene
from restshape.shape.outline import Outline
from restshape.shape.script_frame import ScriptFrame


class Session(Protocol):
    """Turns the events of a script into frames.

    Attributes:
        scene: as the events so far have left it.
        grabbed: what the hand holds; None where it holds nothing.
    """

    scene: Scene

    @property
    def grabbed(self) -> object: ...

    @property
    def cursor(self) -> tuple[float, ...] | None:
        """Where the hand is [m]; None where it holds nothing at a place."""

    @property
    def outline(self) -> Outline | None:
        """The shape as the events so far have left it; None where what is edited has no outline."""

    def frames(self) -> Iterator[ScriptFrame]:
        """The frames of all events, the first before any."""

    def first(self) -> ScriptFrame:
        """The frame before any event."""

    def frames_of(self, event: EventLine, room: float = ...) -> Iterator[ScriptFrame]:
        """The frames of one event, which has so much edit time [s] to the next one."""

    def rollback(self) -> None:
        """Undoes the last frame, whose solve has failed."""
