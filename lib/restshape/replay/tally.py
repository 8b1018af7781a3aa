"""Sums up a replay row by row, in memory that does not grow but for the values of its quantities."""

from __future__ import annotations

from array import array
from collections import Counter, defaultdict
from typing import TYPE_CHECKING, Any

import numpy as np

from restshape.replay.columns import SIMULATED, STAGES, error_column, jump_column
from restshape.replay.constraints import FAILS, HOLDS, UNCERTAIN
from restshape.replay.reservoir import Reservoir

if TYPE_CHECKING:
    from restshape.analysis.analysis import RowValues

PERCENTS = (50.0, 95.0, 99.0)
REASONS = ("refused", "note")
"""Columns of texts of which each is kept once, with its first frame."""
MOST_REASONS = 1000
SINGULAR = "singular"


class Tally:
    """What a summary reports; times leave out the first frame, made from nothing.

    Counts, sums and extremes are exact; quantiles are those of a `Reservoir`. Of a quantity, and of the simulated time,
    all values are kept, 8 bytes each, for `replay --json` lists them.

    Attributes:
        reasons: column -> text -> line and index of the first frame that has it; the first 1000 texts.
        largest_residual: of frames that were analysed and not refused; 0 without any.
    """

    def __init__(self) -> None:
        self.reasons: dict[str, dict[str, tuple[int, int]]] = {column: {} for column in REASONS}
        self.largest_residual = 0.0
        self._counts: Counter[str] = Counter()
        self._stages = dict.fromkeys(STAGES, 0.0)
        self._preconditioners: Counter[str] = Counter()
        self._samples: defaultdict[str, Reservoir] = defaultdict(Reservoir)
        self._series: dict[str, array[float]] = {}
        self._errors: dict[str, array[float]] = {}
        self._jumps: dict[str, dict[str, Any]] = {}
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
            self._series = {key: array("d") for key in row if key.startswith("q_") or key == SIMULATED}
            errors = {key[2:]: error_column(key[2:]) for key in self._series if key != SIMULATED}
            self._errors = {name: array("d") for name, column in errors.items() if column in row}
        else:
            self._add_times(row)
        counts["frames"] += 1
        self._stale.append(bool(row["refused"]))
        counts["refused"] += bool(row["refused"])
        for name in ("iterations", "newton", "pc_rebuilt"):
            counts[name] += int(row[name])
        for name in STAGES:
            self._stages[name] += float(row[f"ms_{name}"])
        if row["level"]:
            self._preconditioners[row["preconditioner"]] += 1
        self._size = (row["unknowns"], row["elements"])
        for key, values in self._series.items():
            values.append(row[key])
        for name, values in self._errors.items():
            values.append(row.get(error_column(name), np.nan))
        self._add_jumps(row)
        self._add_errors(row)
        self._add_texts(row)

    def _add_times(self, row: RowValues) -> None:
        level, ms = int(row["level"]), row["ms"]
        self._counts[f"level {level}"] += 1
        self._counts["predicted"] += bool(row["predicted"])
        if level > 0:
            for name in ("all", str(level)):
                self._samples[f"ms {name}"].add(ms)
                self._samples[f"python {name}"].add(row["ms_python"])
            if row["predicted"]:
                self._samples["ms predicted"].add(ms)
        elif row["iterations"] > 0:
            self._samples["ms still"].add(ms)

    def _add_jumps(self, row: RowValues) -> None:
        """Keeps the largest jump of each quantity, its share of the value, and its frame."""
        for key in self._series:
            size = abs(row.get(jump_column(key[2:]), np.nan))
            if size > self._jumps.get(key[2:], {}).get("largest", -1.0):
                share = size / abs(row[key]) if row[key] else None
                self._jumps[key[2:]] = {"largest": float(size), "share": share, "frame": row["index"]}

    def _add_errors(self, row: RowValues) -> None:
        predicted = bool(row["predicted"])
        for column in ("estimate", "estimate_time", "prediction_error"):
            value = row.get(column, np.nan)
            if np.isfinite(value):
                self._samples[f"{column} {predicted}"].add(value)
        if row.get("residual", -1.0) >= 0.0 and not row["refused"]:
            self.largest_residual = max(self.largest_residual, row["residual"])
        if row.get("converged", -1) >= 0 and not row["refused"]:
            self._counts["judged"] += 1
            self._rest_residual = max(self._rest_residual, row["residual"])
            if row["converged"]:
                self._counts["converged"] += 1
                self._counts["stable"] += row["tangent_positive_definite"] == 1

    def _add_texts(self, row: RowValues) -> None:
        for column, known in self.reasons.items():
            text = row.get(column, "")
            if text and text not in known and len(known) < MOST_REASONS:
                known[text] = (row["line"], row["index"])
        if row["constraint_status"]:
            self._counts[row["constraint_status"]] += 1
            self._status = (row["constraint_status"], row["violated_constraints"])

    def _percentiles(self, name: str) -> dict[str, float]:
        values = self._samples[name].quantiles(PERCENTS)
        return dict(zip(("p50", "p95", "p99"), values))

    def _distribution(self, column: str, predicted: bool) -> dict[str, float | None]:
        sample = self._samples[f"{column} {predicted}"]
        return (
            {"p50": sample.quantiles((50.0,))[0], "max": sample.largest} if sample.count else dict(p50=None, max=None)
        )

    def _rest(self) -> dict[str, Any]:
        counts = self._counts
        if not counts["judged"]:
            return {}
        found = {
            "converged": counts["converged"],
            "tangent_positive_definite": counts["stable"],
            "not_converged": counts["judged"] - counts["converged"],
            "residual": _known(self._rest_residual),
        }
        return {"rest": found}

    def summary(self, policy: str, ranks: int, estimated_quantity: str = "") -> dict[str, Any]:
        """The summary of all frames so far.

        Args:
            policy: its name.
            ranks: how many.
            estimated_quantity: what the error estimates are of.
        """
        counts, (status, violated) = self._counts, self._status
        series = {key: [_known(value) for value in values] for key, values in self._series.items()}
        return {
            "frames": counts["frames"],
            "refused": counts["refused"],
            "ranks": ranks,
            "policy": policy,
            "levels": {str(k): counts[f"level {k}"] for k in (1, 2, 3)},
            "still": self._samples["ms still"].count,
            "idle": counts["level 0"],
            "predicted": counts["predicted"],
            "predicted_ms": self._percentiles("ms predicted"),
            "ms": {name: self._percentiles(f"ms {name}") for name in ("all", "1", "2", "3", "still")},
            "python_ms": {
                "p50": self._percentiles("python all")["p50"],
                "1": self._percentiles("python 1")["p50"],
            },
            "stages": dict(self._stages),
            "iterations": counts["iterations"],
            "newton": counts["newton"],
            "refreshes": counts["pc_rebuilt"],
            "preconditioners": dict(self._preconditioners),
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
            "jumps": self._jumps,
            **{key: values for key, values in series.items() if key == SIMULATED},
            **self._rest(),
        }


def _error(value: float) -> float | str | None:
    """An error for JSON, which knows no infinity: that of a quantity at a singular place."""
    return SINGULAR if value == np.inf else _known(value)


def _known(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None
