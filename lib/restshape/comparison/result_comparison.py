"""Two results beside each other: all that differs, and whether they are the same."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from restshape.arrays import AnyArray
from restshape.comparison.field_differences import FieldDifferences, field_differences
from restshape.comparison.header_differences import HeaderDifference, header_differences
from restshape.comparison.result import Result
from restshape.comparison.same_bits import column_hashes, result_hash
from restshape.comparison.series_difference import SeriesDifference, series_difference

SAME_BITS, SAME_VALUES, WITHIN, DIFFERENT = "same bits", "same values", "within tolerance", "different"
"""Outcomes: all columns and fields but times; all numbers of a JSON file; all quantities and fields; none of them."""
ROUNDING = 1e-9
"""Of simulated times, which are sums of steps, over the last one."""
KEYS = ("p50", "p95", "p99")


@dataclass(frozen=True)
class Compared:
    """What two results have in common, and what not.

    Args:
        outcome: `SAME_BITS`, `SAME_VALUES`, `WITHIN` or `DIFFERENT`.
        header: keys that differ in how they were made.
        quantities: of those that both have; `alone` names the others.
        frames: of both results.
        refused, status: frames that were refused in one of them only, and that have other constraint statuses.
        times: p50, p95 and p99 of the frames after the first [ms], of both.
        columns: names of columns and fields with other bits; None where one of them is no recording.
        fields: None likewise.
        hashes: of both results; empty likewise.
        moments: how far the simulated times of frames of one number are apart [s]; None where a result has none.
    """

    outcome: str
    header: list[HeaderDifference]
    quantities: list[SeriesDifference]
    alone: list[str]
    frames: tuple[int, int]
    refused: list[int]
    status: list[int]
    times: dict[str, tuple[float, float]]
    columns: list[str] | None = None
    fields: FieldDifferences | None = None
    hashes: tuple[str, ...] = field(default=())
    moments: SeriesDifference | None = None

    @property
    def same(self) -> bool:
        """Whether nothing differs by more than the tolerance."""
        return self.outcome != DIFFERENT

    @property
    def apart(self) -> SeriesDifference | None:
        """The difference of the simulated times of frames of one number, where there is one but for rounding."""
        return self.moments if self.moments and self.moments.relative > ROUNDING else None

    def plain(self) -> dict[str, Any]:
        """What the JSON file holds."""
        found: dict[str, Any] = {
            "outcome": self.outcome,
            "frames": list(self.frames),
            "header": {one.key: [one.first, one.second] for one in self.header},
            "quantities": {one.name: one.plain() for one in self.quantities},
            "alone": self.alone,
            "refused": self.refused,
            "constraint_status": self.status,
            "ms": {key: list(pair) for key, pair in self.times.items()},
            "time": self.moments.plain() if self.moments else None,
        }
        if self.fields:
            found["fields"] = {one.name: one.plain() for one in self.fields.fields}
            found |= {"points": self.fields.points.plain(), "meshes": self.fields.ways, "columns": self.columns}
            found["hashes"] = list(self.hashes)
        return found


def compared(first: Result, second: Result, tolerance: float = 0.0) -> Compared:
    """Two results beside each other, frame by frame of one number.

    Args:
        first, second: as `read_result` gives them.
        tolerance: of quantities and fields, over the largest absolute value of each; 0: all bits must be the same.
    """
    found = _compared(first, second, tolerance)
    if first.simulated is None or second.simulated is None:
        return found
    return replace(found, moments=series_difference("time", first.simulated, second.simulated))


def _compared(first: Result, second: Result, tolerance: float) -> Compared:
    """Two results beside each other, whenever their frames are."""
    names = [name for name in first.quantities if name in second.quantities]
    alone = sorted(set(first.quantities) ^ set(second.quantities))
    quantities = [series_difference(name, first.quantities[name], second.quantities[name]) for name in names]
    header, frames = header_differences(first, second), (first.n, second.n)
    refused, status = _other(first.refused, second.refused), _other(first.status, second.status)
    times = _times(first, second)
    near = all(one.relative <= tolerance for one in quantities)
    near &= not (alone or refused or status) and first.n == second.n
    if first.recording is None or second.recording is None:
        within = WITHIN if any(one.largest for one in quantities) else SAME_VALUES
        outcome = within if near else DIFFERENT
        return Compared(outcome, header, quantities, alone, frames, refused, status, times)
    both = [column_hashes(one.recording) for one in (first, second) if one.recording]
    columns = sorted(name for name in {**both[0], **both[1]} if both[0].get(name) != both[1].get(name))
    fields = field_differences(first.recording, second.recording)
    near &= all(one.relative <= tolerance for one in (fields.points, *fields.fields)) and not fields.alone
    outcome = WITHIN if near and tolerance > 0.0 else DIFFERENT
    if not columns and first.n == second.n:
        outcome = SAME_BITS
    hashes = tuple(map(result_hash, both))
    return Compared(outcome, header, quantities, alone, frames, refused, status, times, columns, fields, hashes)


def _other(first: AnyArray | None, second: AnyArray | None) -> list[int]:
    """Frames in which two columns differ; none where one of the results does not have it."""
    if first is None or second is None:
        return []
    return [i for i, (a, b) in enumerate(zip(first, second)) if a != b]


def _times(first: Result, second: Result) -> dict[str, tuple[float, float]]:
    """Percentiles of the time a frame of both results [ms], as far as both say."""
    one, other = (_percentiles(result) for result in (first, second))
    return {key: (one[key], other[key]) for key in KEYS if key in one and key in other}


def _percentiles(result: Result) -> dict[str, float]:
    if result.ms is None:
        return result.percentiles
    later = result.ms[1:] if result.n > 1 else result.ms
    later = later[np.isfinite(later)]
    return {key: float(np.percentile(later, float(key[1:]))) for key in KEYS} if len(later) else {}
