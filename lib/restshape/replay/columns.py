"""The columns of a recording's table: one row a frame."""

from typing import Any

import numpy as np

STAGES = ("edit", "relocate", "map", "flip", "mesh", "pattern", "values", "factor", "krylov", "observe", "record")
ESTIMATES = ("estimate", "estimate_time", "prediction_error")
"""What is estimated, or measured, of a frame's error."""


def columns(quantities: list[str], own: dict[str, Any] | None = None) -> dict[str, Any]:
    """Name to numpy type, or `str`, of each column.

    Args:
        quantities: of the scene.
        own: columns that only the scene's application has.
    """
    counts = ("level", "flips", "age", "refreshed", "iterations", "newton", "unknowns", "elements")
    integers = ("index", "line", *counts, "predicted")
    reals = ("t", "min_quality", "residual", *ESTIMATES, "ms", *(f"ms_{name}" for name in STAGES), "ms_python")
    return {
        **dict.fromkeys(integers, np.int64),
        **dict.fromkeys(reals, np.float64),
        **{f"q_{name}": np.float64 for name in quantities},
        "do": str,
        "preconditioner": "S24",
        "note": "S160",
        "verdict": "S8",
        "broken": "S160",
        "refused": str,
        **(own or {}),
    }
