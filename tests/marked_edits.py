"""Edits with marks asked for after each frame, and the same ones without: their rows are to be the same."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isnan

import restshape
from restshape.application import application_of
from restshape.interface.shown_frame import ShownFrame
from restshape.interface.simulation import Simulation
from restshape.live.shown_marks import Mark

Event = Mapping[str, object]


def frames_of(simulation: Simulation, event: Event) -> Iterator[ShownFrame]:
    """The frames of an event as scripts have it."""
    keys = dict(event)
    return simulation.each(str(keys.pop("do")), **keys)


def last_marks(simulation: Simulation) -> dict[str, Mark]:
    """The marks of the last frame by their names, or their texts."""
    found = application_of(simulation.scene).marked(simulation)
    return {getattr(one, "name", "") or getattr(one, "text", ""): one for one in found}


def rows_with_and_without(scene: restshape.Scene, events: list[Event], predict: str = "none") -> tuple[list, list]:
    """The rows of events, but for times, with marks asked for after each frame, and without; none is refused."""
    both = []
    for marked in (True, False):
        rows = []
        with restshape.open(scene, strict=False, predict=predict) as simulation:
            if marked:
                last_marks(simulation)
            for event in events:
                for frame in frames_of(simulation, event):
                    if marked:
                        last_marks(simulation)
                    assert not frame.refused, frame.refused
                    rows.append({name: _same(value) for name, value in frame.row.items() if not name.startswith("ms")})
        both.append(rows)
    return both[0], both[1]


def _same(value: object) -> object:
    """A value that equals itself."""
    return "nan" if isinstance(value, float) and isnan(value) else value
