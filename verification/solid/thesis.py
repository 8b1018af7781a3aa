"""The thesis's numbers on reuse beside ours: table 4.2 and figure 4.2."""

from dataclasses import replace
from typing import Any

from restshape_studies.bench.reuse import Plan, compare
from restshape_studies.bench.turns import Case

from restshape.application import application

FOLDER = application("solid").folder
CASE = Case("plate", FOLDER / "scenes/plate.toml", FOLDER / "edits/plate.jsonl")
PLAN = Plan(("auto", "thesis"))
THESIS = {"1": 117, "2": 39, "3": 3}
NAMES = {"1": "level 1 (relocation)", "2": "level 2 (reconnection)", "3": "level 3 (reconstruction)"}


def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`; `timing` marks those that a clock decides, which need not be `timed`,
    `rounding` those that turn on the last digits of meshes."""
    found = compare(CASE, PLAN if timed else replace(PLAN, repeat=1), lambda words: None)  # a count needs one run
    counts = [
        {
            "table": "4.2",
            "row": NAMES[level],
            "quantity": f"frames, policy {name}",
            "thesis": THESIS[level],
            "ours": entry["levels"][level],
            "unit": "frames",
            "timing": False,
            "rounding": True,
        }
        for name, entry in found.items()
        for level in ("1", "2", "3")
    ]
    costs = [
        {
            "table": "4.2, figure 4.2",
            "row": "level 3 over level 1",
            "quantity": f"time of a frame until its answer (p50), policy {name}",
            "thesis": "> 2",
            "ours": entry["ms_by_level"]["3"]["p50"] / entry["ms_by_level"]["1"]["p50"],
            "unit": "ratio",
            "timing": True,
        }
        for name, entry in found.items()
    ]
    return [*counts, *costs] if timed else counts
