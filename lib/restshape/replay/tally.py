"""Sums up a replay row by row, in memory that does not grow but for the values of its quantities."""

from __future__ import annotations

from array import array
from collections import Counter, defaultdict
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from restshape.analysis.row_values import number, text, whole
from restshape.replay.columns import (
    SIMULATED,
    STAGES,
    UNTRUSTED,
    distance_column,
    error_column,
    jump_column,
    quantity_column,
    quantity_names,
)
from restshape.replay.constraints import FAILS, HOLDS, UNCERTAIN
from restshape.replay.reservoir import Reservoir
from restshape.replay.rounding import ROUNDING, largest, scales
from restshape.replay.same_texts import severity, without_numbers

if TYPE_CHECKING:
    from restshape.analysis.analysis import RowValues

PERCENTS = (50.0, 95.0, 99.0)
REASONS = ("refused", UNTRUSTED, "note")
"""Columns of texts, of which those that differ by numbers alone are kept as one."""
MOST_REASONS = 1000
SINGULAR = "singular"
Summary = dict[str, object]
"""What `replay --json` writes, by key."""


@dataclass
class Reason:
    """What some frames say, but for numbers.

    Args:
        text: of the worst of them, by `severity`; of refused frames of the first.
        line: of the edit of the first one.
        frame, last, worst: index of the first, the last, and the one that the text is of.
        count: how many they are.
    """

    text: str
    line: int
    frame: int
    last: int
    worst: int
    count: int = 1

    def add(self, text: str, frame: int) -> None:
        """Take a further frame, with what it says."""
        self.last, self.count = frame, self.count + 1
        if severity(text) > severity(self.text):
            self.text, self.worst = text, frame


class Jump(TypedDict):
    """The largest jump of a quantity, its share of the quantity's largest size (None of 0, and of rounding alone), and
    its frame."""

    largest: float
    share: float | None
    frame: int


class Tally:
    """What a summary reports; times leave out the first frame, made from nothing.

    Counts, sums and extremes are exact; quantiles are those of a `Reservoir`. Of a quantity, and of the simulated time,
    all values are kept, 8 bytes each, for `replay --json` lists them.

    Args:
        units: SI unit by quantity, as far as they are known.
        loads: the largest size of loads by unit (`rounding.load_scales`).

    Attributes:
        reasons: column -> text without numbers -> frames that have it; the first 1000 texts.
        largest_residual: of frames that were analysed and not refused; 0 without any.
    """

    def __init__(self, units: Mapping[str, str] | None = None, loads: Mapping[str, float] | None = None) -> None:
        self.units, self.loads = units or {}, loads or {}
        self.reasons: dict[str, dict[str, Reason]] = {column: {} for column in REASONS}
        self.largest_residual = 0.0
        self._counts: Counter[str] = Counter()
        self._stages = dict.fromkeys(STAGES, 0.0)
        self._preconditioners: Counter[str] = Counter()
        self._samples: defaultdict[str, Reservoir] = defaultdict(Reservoir)
        self._series: dict[str, array[float]] = {}
        self._errors: dict[str, array[float]] = {}
        self._jumps: dict[str, Jump] = {}
        self._stale = bytearray()
        self._status: tuple[str, str] = ("", "")
        self._rest_residual = -np.inf
        self._size = (0, 0)

    @property
    def frames(self) -> int:
        """How many there were."""
        return self._counts["frames"]

    def add(self, row: RowValues) -> None:
        """Takes the row of the next frame."""
        counts = self._counts
        if not counts["frames"]:
            self._samples["ms first"].add(number(row, "ms"))
            names = quantity_names(row)
            times = [SIMULATED] if SIMULATED in row else []
            self._series = {key: array("d") for key in (*map(quantity_column, names), *times)}
            errors = {name: error_column(name) for name in names}
            self._errors = {name: array("d") for name, column in errors.items() if column in row}
        else:
            self._add_times(row)
        counts["frames"] += 1
        self._stale.append(bool(row["refused"]))
        counts["refused"] += bool(row["refused"])
        for name in ("iterations", "newton", "pc_rebuilt"):
            counts[name] += whole(row, name)
        for name in STAGES:
            self._stages[name] += number(row, f"ms_{name}")
        if row["level"]:
            self._preconditioners[text(row, "preconditioner")] += 1
        self._size = (whole(row, "unknowns"), whole(row, "elements"))
        for key, values in self._series.items():
            values.append(number(row, key))
        for name, values in self._errors.items():
            values.append(number(row, error_column(name)))
        self._add_jumps(row)
        self._add_distances(row)
        self._add_errors(row)
        self._add_texts(row)

    def _add_times(self, row: RowValues) -> None:
        level, ms, counts = whole(row, "level"), number(row, "ms"), self._counts
        if level or not row["refused"]:
            counts[f"level {level}"] += 1
        counts["predicted"] += bool(row["predicted"])
        for name in ("iterations", "pc_rebuilt"):
            counts[f"{name} {level or 'still'}"] += whole(row, name)
        if level > 0:
            for name in ("all", str(level)):
                self._samples[f"ms {name}"].add(ms)
                self._samples[f"python {name}"].add(number(row, "ms_python"))
                self._samples[f"beside {name}"].add(beside(row))
            if row["predicted"]:
                self._samples["ms predicted"].add(ms)
        elif whole(row, "iterations") > 0:
            self._samples["ms still"].add(ms)

    def _add_jumps(self, row: RowValues) -> None:
        """Keeps the largest jump of each quantity, and its frame; its share is known at the end."""
        for key in self._series:
            size, known = abs(number(row, jump_column(key[2:]))), self._jumps.get(key[2:])
            if size > (known["largest"] if known else -1.0):
                self._jumps[key[2:]] = {"largest": float(size), "share": None, "frame": whole(row, "index")}

    def _add_distances(self, row: RowValues) -> None:
        """Keeps the estimated distances of predicted values of each quantity."""
        for key in self._series:
            size = number(row, distance_column(key[2:]))
            if np.isfinite(size):
                self._samples[f"distance {key[2:]}"].add(size)

    def _shared_jumps(self, sizes: Mapping[str, float]) -> dict[str, Jump]:
        """The largest jumps with their shares; `sizes` as `rounding.scales` gives them."""
        found: dict[str, Jump] = {}
        for name, jump in self._jumps.items():
            own = largest(self._series[f"q_{name}"])
            found[name] = jump | {"share": jump["largest"] / own if own > ROUNDING * sizes[name] else None}
        return found

    def _add_errors(self, row: RowValues) -> None:
        predicted = bool(row["predicted"])
        for column in ("estimate", "estimate_time", "prediction_error"):
            value = number(row, column)
            if np.isfinite(value):
                self._samples[f"{column} {predicted}"].add(value)
        residual, converged = number(row, "residual", -1.0), number(row, "converged", -1)
        if residual >= 0.0 and not row["refused"]:
            self.largest_residual = max(self.largest_residual, residual)
        if converged >= 0 and not row["refused"]:
            self._counts["judged"] += 1
            self._rest_residual = max(self._rest_residual, residual)
            if converged:
                self._counts["converged"] += 1
                self._counts["stable"] += row["tangent_positive_definite"] == 1
                self._counts[UNTRUSTED] += bool(text(row, UNTRUSTED))

    def _add_texts(self, row: RowValues) -> None:
        for column, known in self.reasons.items():
            said = text(row, column)
            if not said:
                continue
            plain, frame = without_numbers(said), whole(row, "index")
            if plain in known:
                # Of what was refused the first message says what to mend.
                known[plain].add(known[plain].text if column == "refused" else said, frame)
            elif len(known) < MOST_REASONS:
                known[plain] = Reason(said, whole(row, "line"), frame, frame, frame)
        if status := text(row, "constraint_status"):
            self._counts[status] += 1
            self._status = (status, text(row, "violated_constraints"))

    def _percentiles(self, name: str) -> dict[str, float]:
        values = self._samples[name].quantiles(PERCENTS)
        return dict(zip(("p50", "p95", "p99"), values))

    def _distribution(self, column: str, predicted: bool) -> dict[str, float | None]:
        sample = self._samples[f"{column} {predicted}"]
        return (
            {"p50": sample.quantiles((50.0,))[0], "max": sample.largest} if sample.count else dict(p50=None, max=None)
        )

    def _rest(self) -> Summary:
        counts = self._counts
        if not counts["judged"]:
            return {}
        found = {
            "converged": counts["converged"],
            "tangent_positive_definite": counts["stable"],
            "untrusted": counts[UNTRUSTED],
            "not_converged": counts["judged"] - counts["converged"],
            "residual": _known(self._rest_residual),
        }
        return {"rest": found}

    def summary(self, policy: str, ranks: int, estimated_quantity: str = "") -> Summary:
        """The summary of all frames so far.

        Args:
            policy: its name.
            ranks: how many.
            estimated_quantity: what the error estimates are of.
        """
        counts, (status, violated) = self._counts, self._status
        series = {key: [_known(value) for value in values] for key, values in self._series.items()}
        known = {key[2:]: np.array(values) for key, values in self._series.items() if key != SIMULATED}
        sizes = scales(known, self.units, self.loads)
        return {
            "frames": counts["frames"],
            "refused": counts["refused"],
            "ranks": ranks,
            "policy": policy,
            **self._work(),
            "unknowns": self._size[0],
            "elements": self._size[1],
            "constraint_status": {
                "holds": counts[HOLDS],
                "uncertain": counts[UNCERTAIN],
                "fails": counts[FAILS],
                "last": status,
                "violated_constraints": violated,
            }
            if status
            else {},
            "estimate": {**self._distribution("estimate", False), "of": estimated_quantity},
            "estimate_time": self._distribution("estimate_time", False),
            "predicted_estimate": self._distribution("estimate", True),
            "prediction_error": self._distribution("prediction_error", False),
            "stale": list(self._stale),
            "quantities": {key[2:]: values for key, values in series.items() if key != SIMULATED},
            "quantity_errors": {name: list(map(_error, values)) for name, values in self._errors.items()},
            "predicted_distances": {
                key[2:]: sample.largest for key in series if (sample := self._samples[f"distance {key[2:]}"]).count
            },
            "jumps": self._shared_jumps(sizes),
            "scales": sizes,
            **{key: values for key, values in series.items() if key == SIMULATED},
            **self._rest(),
        }

    def _work(self) -> Summary:
        """Levels, times and counted work of the frames."""
        counts = self._counts
        return {
            "levels": {str(k): counts[f"level {k}"] for k in (1, 2, 3)},
            "still": self._samples["ms still"].count,
            "idle": counts["level 0"],
            "predicted": counts["predicted"],
            "first_ms": self._percentiles("ms first")["p50"],
            "predicted_ms": self._percentiles("ms predicted"),
            "ms": {name: self._percentiles(f"ms {name}") for name in ("all", "1", "2", "3", "still")},
            "python_ms": {
                "p50": self._percentiles("python all")["p50"],
                "1": self._percentiles("python 1")["p50"],
            },
            "beside_ms": {
                "p50": self._percentiles("beside all")["p50"],
                "1": self._percentiles("beside 1")["p50"],
            },
            "stages": dict(self._stages),
            "iterations": counts["iterations"],
            "newton": counts["newton"],
            "refreshes": counts["pc_rebuilt"],
            "iterations_by_level": {name: counts[f"iterations {name}"] for name in ("1", "2", "3", "still")},
            "refreshes_by_level": {name: counts[f"pc_rebuilt {name}"] for name in ("1", "2", "3", "still")},
            "preconditioners": dict(self._preconditioners),
        }


def beside(row: RowValues) -> float:
    """Milliseconds of a frame that its answer does without: residual, errors, hand-over to the recorder."""
    return number(row, "ms_estimate", 0.0) + number(row, "ms_record", 0.0)


def _error(value: float) -> float | str | None:
    """An error for JSON, which knows no infinity: that of a quantity at a singular place."""
    return SINGULAR if value == np.inf else _known(value)


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
