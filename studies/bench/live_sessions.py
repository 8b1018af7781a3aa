"""The sessions that `restshape bench live` measures: scenes, and what the mouse does in each."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from restshape_studies.bench.live_drag import Drag, dragged

from restshape.application import applications


@dataclass(frozen=True)
class PlannedSession:
    """A session.

    Args:
        title: for people.
        app, file: of the scene; overrides: ``key=value`` as after --set.
        drag: what the mouse does.
    """

    title: str
    app: str
    file: str
    drag: Drag
    overrides: tuple[str, ...] = ()

    @property
    def scene(self) -> Path:
        """The installed scene."""
        return applications()[self.app].folder / "scenes" / self.file

    def measured(self, places: int, overrides: Sequence[str] = ()) -> dict[str, Any]:
        """How soon and how often answers are seen while the mouse goes through some places."""
        return dragged(self.scene, replace(self.drag, places=places), (*self.overrides, *overrides))

    def script(self, places: int) -> Iterator[dict[str, object]]:
        """The same drag of the plate's hole as a script, in metres."""
        yield {"format": "restshape-edits", "version": 1, "scene": self.file, "units": "m"}
        yield {"t": 0.0, "do": "press", "on": "window", "at": [0.4, 0.5]}
        for number in range(places):
            to = [0.4 + 0.22 * math.sin(number / 60), 0.5 + 0.05 * math.sin(number / 25)]
            yield {"t": (1 + number) / 60, "do": "drag", "to": to}


PLATE = PlannedSession("plate of 2,000 triangles", "solid", "plate.toml", Drag("hole window"))
SESSIONS = {
    "plate": PLATE,
    "plate-20000": replace(PLATE, title="plate of 20,000 triangles", overrides=("mesh.size='15.7 mm'",)),
    "fish": PlannedSession(
        "fish, five modes as a plate",
        "metallophone",
        "fish.toml",
        Drag("vertex fork", 30.0, 10.0),
        ("effects.modal.model='plate'", "mesh.order=1"),
    ),
    "cantilever": PlannedSession("cantilever", "cantilever", "cantilever.toml", Drag("edge tip", 30.0, 10.0)),
    "table": PlannedSession("table with its valid ranges", "furniture", "table.toml", Drag("plank leg-4", 30.0, 10.0)),
    "ball": PlannedSession(
        "cloth of 1,800 nodes on a ball",
        "couture",
        "sphere.toml",
        Drag("body ball", 40.0, 15.0, rests=6.0),
        ("mesh.size='19.2 mm'",),
    ),
}
