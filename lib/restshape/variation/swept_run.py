"""What one run of a sweep gives: a row of its table."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.row_values import number, text, whole
from restshape.replay.columns import limit_column
from restshape.replay.constraints import FAILS, HOLDS, MAX, MIN, UNCERTAIN, limits_of, recorded_limits
from restshape.replay.rounding import load_scales, scales

if TYPE_CHECKING:
    from restshape.analysis.analysis import RowValues
    from restshape.analysis.row_values import RowValue
    from restshape.application import Application
    from restshape.scene.model import Scene

DONE, INVALID, UNSOLVED = "done", "invalid", "unsolved"
"""Status of a run: it has a result; its scene or script is not valid; its first shape has no solution."""
BY_ID = ("mode", "cents", "ratio")
"""Kinds of quantities that name modes by their ids."""
NEW, REUSED = "new", "reused"
"""Analysis of a run: made for it, or that of the run before."""


@dataclass
class Extent:
    """A quantity over the frames of a run, in SI units; not numbers where no frame has a value.

    Args:
        last: in the last frame; not a number where that was refused.
        least, most: of all frames.
        beyond: of all frames the value that is farthest beyond its limit; not a number where none is.
    """

    last: float = math.nan
    least: float = math.nan
    most: float = math.nan
    beyond: float = math.nan
    _farthest: float = 0.0

    def add(self, value: float, limits: Mapping[str, float]) -> None:
        """Take in a frame, with the limits `min` and `max` there that the quantity has."""
        self.last = value
        excess = max(limits.get(MIN, -math.inf) - value, value - limits.get(MAX, math.inf))
        if excess > self._farthest:
            self._farthest, self.beyond = excess, value
        if math.isfinite(value):
            self.least = value if math.isnan(self.least) else min(self.least, value)
            self.most = value if math.isnan(self.most) else max(self.most, value)


# More than 15 attributes: each is a column of the table, or decides a note below it.
@dataclass
class SweptRun:
    """One run of a sweep.

    Args:
        index: from 0.
        values: of each key as written, and `numbers` where they are some.
        status: `DONE`, `INVALID` or `UNSOLVED`, and `why` where it is not done.
        analysis: `NEW` or `REUSED`.
        level: of reuse of the mesh in the first frame: 3 reconstruction, 2 reconnection, 1 relocation, 0 as it was.
        frames, refused: how many there are, and how many of them were refused.
        statuses: how many frames have each constraint status.
        constraint_status: of the last frame.
        limits: of quantities in the last frame, by `min` and `max`, in SI units (`constraints.recorded_limits`).
        quantities: by column: ``q_`` and the name, or a column of the application where the scene names none.
        cpu_s: processor time [s].
        remembered: parts of its physics that make equilibria depend on the path to them.
        crossed: whether quantities name modes by their ids, and these are not their ranks in its first frame.
    """

    index: int
    values: Mapping[str, str]
    numbers: Mapping[str, float]
    status: str = DONE
    why: str = ""
    analysis: str = NEW
    level: int = -1
    frames: int = 0
    refused: int = 0
    statuses: Counter[str] = field(default_factory=Counter)
    constraint_status: str = ""
    limits: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    quantities: dict[str, Extent] = field(default_factory=dict)
    cpu_s: float = 0.0
    remembered: Sequence[str] = ()
    crossed: bool = False
    _by_id: bool = False

    def add(self, row: RowValues, columns: Iterable[str]) -> None:
        """Take in the row of a frame, of its quantities those in these columns."""
        if not self.frames:
            self.level = whole(row, "level")
            ids = text(row, "mode_ids").split() if self._by_id else []
            self.crossed = ids != sorted(ids, key=int)
        self.frames += 1
        self.refused += bool(row["refused"])
        self.constraint_status = text(row, "constraint_status")
        self.statuses[self.constraint_status] += 1
        for column in columns:
            name = column.removeprefix("q_")
            # Those that follow parameters have columns of their own.
            own = self.limits.get(name, {}).items()
            limits = {key: number(row, limit_column(name, key), limit) for key, limit in own}
            self.quantities.setdefault(column, Extent()).add(number(row, column), limits)

    @property
    def outcome(self) -> str:
        """Its status, for people, with that of its limits over all frames: how many fail, else how many may fail."""
        word = next((word for word in (FAILS, UNCERTAIN) if self.statuses[word]), self.constraint_status)
        if not word:
            return self.status
        many = self.statuses[word]
        part = "" if word == HOLDS or many == self.frames else f" in {many} of {self.frames} frames"
        return f"{self.status}, {word}{part}"

    def limit(self, scene: Scene) -> None:
        """Take the limits of a scene, which may follow its parameters, and how its quantities name modes."""
        self._by_id = any(quantity.kind in BY_ID for quantity in scene.quantities.values())
        self.limits = recorded_limits(scene.quantities)

    def table_row(self, several: bool) -> dict[str, RowValue]:
        """Its row of the CSV file; `several` frames have the extremes of quantities, too."""
        row: dict[str, RowValue] = {
            "run": self.index,
            "status": self.status,
            "frames": self.frames,
            "refused": self.refused,
            "constraint_status": self.constraint_status,
            "violating": self.statuses[FAILS],
            "uncertain": self.statuses[UNCERTAIN],
            "analysis": self.analysis,
            "level": self.level,
            "cpu_s": self.cpu_s,
            "why": self.why,
        }
        row |= {key: value.strip('"') for key, value in self.values.items()}
        for name, extent in self.quantities.items():
            row[name] = extent.last
            if several:
                row |= {f"{name}_min": extent.least, f"{name}_max": extent.most}
        return row

    def plain(self) -> dict[str, object]:
        """What the JSON file holds of it."""
        found: dict[str, object] = dict(self.table_row(False))
        for name in (*self.values, *self.quantities):
            found.pop(name)
        found["values"] = {key: self.numbers.get(key, value.strip('"')) for key, value in self.values.items()}
        found["quantities"] = {
            name.removeprefix("q_"): {"last": _finite(one.last), "min": _finite(one.least), "max": _finite(one.most)}
            for name, one in self.quantities.items()
        }
        return found


def errors_count(scene: Scene | None) -> bool:
    """Whether errors matter to a run, which shows none: they say whether a limit is nearer than a value is known."""
    return bool(scene and limits_of(scene.quantities))


def quantity_columns(scene: Scene, application: Application) -> list[str]:
    """The columns of rows that a sweep shows: quantities of the scene, else numbers that its application alone has."""
    own = application.own_columns(scene).items()
    numbers = [name for name, of in own if np.dtype(of).kind == "f" and not name.startswith("ms_")]
    return [f"q_{name}" for name in scene.quantities] or numbers


def run_scales(scene: Scene | None, runs: Sequence[SweptRun]) -> dict[str, float]:
    """What counts as the size of each quantity over all runs, by column (`rounding.scales`)."""
    names = dict.fromkeys(name for one in runs for name in one.quantities)
    extents = {name: [one.quantities[name] for one in runs if name in one.quantities] for name in names}
    series = {name: np.array([(e.last, e.least, e.most) for e in found]).ravel() for name, found in extents.items()}
    quantities = scene.quantities if scene else {}
    return scales(
        series, {f"q_{name}": one.unit for name, one in quantities.items()}, load_scales(scene) if scene else None
    )


def column_names(keys: Iterable[str], quantities: Sequence[str], several: bool) -> list[str]:
    """The columns of the CSV file; `quantities` as `quantity_columns` gives them."""
    parts = ("", "_min", "_max") if several else ("",)
    own = [f"{name}{part}" for name in quantities for part in parts]
    limits = ["constraint_status", "violating", "uncertain"]
    return ["run", "status", "frames", "refused", *limits, "analysis", "level", "cpu_s", *keys, *own, "why"]


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
