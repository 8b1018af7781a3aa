"""What a frame of a recording has for marks of extremes and limits: they are looked for as in a live session."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, cast

import numpy as np

from restshape.analysis.row_values import number
from restshape.findings import Finding, decode_findings
from restshape.live.extreme_marks import SAME, ExtremeMarks, LookedAt, values_of
from restshape.live.seen_frame import SeenFrame
from restshape.replay.columns import quantity_column

if TYPE_CHECKING:
    from restshape.analysis.row_values import RowValues
    from restshape.arrays import Indices, Reals
    from restshape.fem.space import PlaneSpace
    from restshape.interface.shown_frame import ShownFrame
    from restshape.replay.recording.recording import Recording
    from restshape.scene.model import Scene


class RecordedFields(Mapping[str, "Reals"]):
    """The fields of a frame of a recording, read as they are asked for.

    Args:
        recording: open; number: of the frame.
    """

    def __init__(self, recording: Recording, number: int) -> None:
        self._recording, self._number = recording, number
        self._names = [name for name, info in recording.fields.items() if info.first_frame <= number]

    def __getitem__(self, name: str) -> Reals:
        """The values of a field."""
        if name not in self._names:
            raise KeyError(name)
        return self._recording.field(self._number, name)

    def __iter__(self) -> Iterator[str]:
        """Their names."""
        return iter(self._names)

    def __len__(self) -> int:
        """How many there are."""
        return len(self._names)


@dataclass(frozen=True, eq=False)
class RecordedAnswer:
    """A frame: its row, and its fields."""

    row: RowValues
    fields: RecordedFields

    @cached_property
    def findings(self) -> tuple[Finding, ...]:
        """What there is to know of it."""
        return decode_findings(str(self.row.get("findings", "")))


@dataclass(eq=False)
class RecordedSpace:
    """The mesh (n, d) [m], (ne, k) of a frame, of which a recording does not tell which nodes an entity has."""

    X: Reals
    cells: Indices
    topology: int

    @property
    def facets(self) -> Indices:
        """What is the same object as long as entities keep their nodes: there are no others."""
        return self.cells

    def nodes_of(self, entity: str) -> Indices:
        """All nodes (n,): the value of a quantity tells which of them it is taken at."""
        return np.arange(len(self.X), dtype=np.int32)


class RecordedExtremes(ExtremeMarks):
    """Finds where extremes of recorded frames are: at the node whose value they have."""

    def _node(self, one: LookedAt, seen: SeenFrame) -> int | None:
        if not one.name or not one.field or one.nodes is None:
            return super()._node(one, seen) if one.field else None
        values, nodes = values_of(one, seen)
        value = number(seen.frame.row, quantity_column(one.name))
        away = np.abs((np.abs(values) if one.reduce in ("absmax", "peak") else values) - value)
        if not np.isfinite(value) or not np.isfinite(away).any():
            return None
        place = int(np.nanargmin(away))
        return int(place if nodes is None else nodes[place]) if away[place] <= SAME * abs(value) else None


def recorded_answer(recording: Recording, number: int, row: RowValues, space: RecordedSpace, scene: Scene) -> SeenFrame:
    """A frame of a recording, as marks of live sessions look at it."""
    fields = RecordedFields(recording, number)
    answer = cast("ShownFrame", RecordedAnswer(row, fields))
    return SeenFrame(answer, scene, cast("PlaneSpace", space), fields.get("displacement"))
