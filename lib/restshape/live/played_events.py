"""The events of a script that a live session plays, as tables in metres, each with the time that it has."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING

from restshape.errors import UserError
from restshape.scene.edit_script import ScriptReader
from restshape.scene.units import length_unit

if TYPE_CHECKING:
    from restshape.scene.edit_script import Script
    from restshape.scene.plain_values import Table

DIRECTIONS = ("along", "as")
"""Keys whose numbers are made unit vectors: they are taken as they were written."""


@dataclass(frozen=True)
class PlayedEvent:
    """An event of a script.

    Args:
        table: its keys, in metres.
        room: edit time [s] that it has to the next one.
        frames: that it has; t: when it begins [s].
    """

    table: Table
    room: float
    frames: int
    t: float


def played_events(script: Script) -> list[PlayedEvent]:
    """The events of a script, as one in metres has them.

    Raises:
        UserError: the script holds no text.
    """
    events = script.events
    written = _tables(script)[: len(events)]
    if len(written) < len(events):
        raise UserError("this script holds no text", str(script.path or "script"), "load it again")
    if length_unit(script.header.units, "units") != 1.0:
        # Their models have metres.
        for place, event in enumerate(events):
            known = event.model_dump(mode="json", by_alias=True, exclude_unset=True)
            kept = {key: value for key, value in written[place].items() if key in DIRECTIONS}
            written[place] = {**known, **kept}
    after = [event.t for event in events[1:]]
    rooms = [then - event.t for event, then in zip(events, after)] + [inf]
    return [PlayedEvent(table, room, event.frame_count, event.t) for event, table, room in zip(events, written, rooms)]


def _tables(script: Script) -> list[Table]:
    """The tables of the lines after the header."""
    lines = [(number, line) for number, line in enumerate(script.text.split("\n"), start=1) if line.strip()]
    reader = ScriptReader(script.path or Path("script"), True, 0, {}, None)
    found = []
    for number, line in lines[1:]:
        try:
            found.append(reader.table(number, line))
        except UserError:
            # It is torn, or one that cannot be used: events end before it.
            break
    return found
