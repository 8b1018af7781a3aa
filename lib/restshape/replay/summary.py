"""What a replay was, summed up for programs."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING, Any

import numpy as np

from restshape.replay.columns import SIMULATED, STAGES
from restshape.replay.constraints import status_counts

if TYPE_CHECKING:
    from restshape.analysis.analysis import RowValues


def percentiles(ms: np.ndarray) -> dict[str, float]:
    """Median, 95th and 99th percentile [ms] of frame times; zeros when there are none."""
    values = np.percentile(ms, (50, 95, 99)) if len(ms) else np.zeros(3)
    return dict(zip(("p50", "p95", "p99"), map(float, values)))


def known(value: float) -> float | None:
    """The value, or None where there is no number, which JSON does not know."""
    return value if np.isfinite(value) else None


def distribution(rows: list[RowValues], column: str, predicted: bool) -> dict[str, float | None]:
    """Median and largest number in a column of the frames that were predicted, or not; None where there is none."""
    values = [row.get(column, np.nan) for row in rows if bool(row["predicted"]) == predicted]
    values = [value for value in values if np.isfinite(value)]
    return {"p50": float(np.median(values)), "max": max(values)} if values else {"p50": None, "max": None}


def convergence(rows: list[RowValues]) -> dict[str, Any]:
    """How many frames have converged, how many of these where a stable equilibrium is proven, how many are not, and the
    largest residual; nothing of what is not relaxed to equilibrium. Frames that were not analysed, or refused, do not
    count.

    Args:
        rows: of all frames.
    """
    judged = [row for row in rows if row.get("converged", -1) >= 0 and not row["refused"]]
    if not judged:
        return {}
    rests = [row for row in judged if row["converged"]]
    return {
        "converged": len(rests),
        "tangent_positive_definite": sum(row["tangent_positive_definite"] == 1 for row in rests),
        "not_converged": len(judged) - len(rests),
        "residual": known(max(row["residual"] for row in judged)),
    }


def summarise(rows: list[RowValues], policy: str, ranks: int, estimated_quantity: str = "") -> dict[str, Any]:
    """Counts, times and quantities of a replay from its rows; times leave out the first frame, made from nothing.

    Args:
        rows: of all frames.
        policy: its name.
        ranks: how many.
        estimated_quantity: what the error estimates are of.
    """
    later = rows[1:]
    times = np.array([row["ms"] for row in later])
    level = np.array([row["level"] for row in later], dtype=int)
    moved = level > 0
    predicted = np.array([row["predicted"] for row in later], dtype=bool)
    still = ~moved & np.array([row["iterations"] > 0 for row in later], dtype=bool)
    return {
        "frames": len(rows),
        "refused": sum(bool(row["refused"]) for row in rows),
        "ranks": ranks,
        "policy": policy,
        "levels": {str(k): int((level == k).sum()) for k in (1, 2, 3)},
        "still": int(still.sum()),
        "idle": int((level == 0).sum()),
        "predicted": int(predicted.sum()),
        "predicted_ms": percentiles(times[predicted & moved]),
        "ms": {
            "all": percentiles(times[moved]),
            **{str(k): percentiles(times[level == k]) for k in (1, 2, 3)},
            "still": percentiles(times[still]),
        },
        "python_ms": {
            "p50": percentiles(np.array([row["ms_python"] for row in later])[moved])["p50"],
            "1": percentiles(np.array([row["ms_python"] for row in later])[level == 1])["p50"],
        },
        "stages": {name: float(sum(row[f"ms_{name}"] for row in rows)) for name in STAGES},
        "iterations": int(sum(row["iterations"] for row in rows)),
        "newton": int(sum(row["newton"] for row in rows)),
        "refreshes": int(sum(row["pc_rebuilt"] for row in rows)),
        "preconditioners": dict(Counter(row["preconditioner"] for row in rows if row["level"])),
        "unknowns": rows[-1]["unknowns"] if rows else 0,
        "elements": rows[-1]["elements"] if rows else 0,
        "constraint_status": status_counts(rows),
        "estimate": {**distribution(rows, "estimate", False), "of": estimated_quantity},
        "estimate_time": distribution(rows, "estimate_time", False),
        "predicted_estimate": distribution(rows, "estimate", True),
        "prediction_error": distribution(rows, "prediction_error", False),
        "quantities": {
            key[2:]: [known(row[key]) for row in rows] for key in (rows[0] if rows else {}) if key.startswith("q_")
        },
        **({SIMULATED: [known(row[SIMULATED]) for row in rows]} if rows and SIMULATED in rows[0] else {}),
        **({"rest": counts} if (counts := convergence(rows)) else {}),
        "rows": rows,
    }
