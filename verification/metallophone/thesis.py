"""The thesis's bars beside ours: frames a second of table 4.4, one mode, at its counts of tetrahedra."""

from typing import Any

from restshape_studies.bench.reuse import Plan, compare
from restshape_studies.bench.turns import Case

from restshape.application import application
from restshape.replay.first_frame import first_frame

FOLDER = application("metallophone").folder
PLAN = Plan(("auto", "thesis"), overrides=("effects.modal.modes=1",))
BARS = {100: (2196, 10.7), 150: (3192, 4.2), 200: (4524, 3.3)}
"""Length [mm] -> tetrahedra, and frames a second of the thesis."""


def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`; `timing` marks those that a clock decides, which need not be `timed`,
    `rounding` those that turn on the last digits of meshes."""
    return [row for length in BARS for row in bar_rows(length, timed)]


def bar_rows(length: int, timed: bool) -> list[dict[str, Any]]:
    """The rows of the bar of that length [mm]."""
    case = Case(f"bar_{length}", FOLDER / "scenes" / f"bar_{length}.toml", FOLDER / "edits" / f"bar_{length}.jsonl")
    count, speed = BARS[length]
    common = {"table": "4.4", "row": f"bar of {length} x 30 mm, one mode"}
    elements = first_frame(case.scene, PLAN.overrides).row["elements"]
    counted = {**common, "quantity": "tetrahedra", "thesis": count, "ours": elements, "unit": "tetrahedra"}
    speeds = [
        {
            **common,
            "quantity": f"frames a second, policy {name}",
            "thesis": speed,
            "ours": entry["fps"],
            "unit": "1/s",
            "timing": True,
        }
        # Policies take turns on a warm machine, so that a slow spell of it favours none.
        for name, entry in (compare(case, PLAN, lambda words: None) if timed else {}).items()
    ]
    return [{**counted, "timing": False, "rounding": True}, *speeds]
