"""Numbers of gestures in the script of a live session, by which undo takes back all edits of one."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from restshape.live.live_simulation import Event, LiveSimulation
    from restshape.live.messages import EventMessage


class Gestures:
    """Gives the events of a page's gestures small numbers, which no earlier event of the script has.

    Args:
        live: whose script it is.
    """

    def __init__(self, live: LiveSimulation) -> None:
        self._live = live
        self._last = 0, 0

    def numbered(self, message: EventMessage) -> Event:
        """The event of a message, with the number of its gesture where it is part of one."""
        if not message.gesture:
            return message.event
        given, number = self._last
        if given != message.gesture:
            number = self._live.sim.written.largest_gesture + 1
            self._last = message.gesture, number
        return message.event | {"gesture": number}
