"""The thesis's vibrating building beside ours: row 1 of table 4.3."""

from typing import Any

from restshape_studies.bench.reuse import Plan, compare
from restshape_studies.bench.turns import Case

from restshape.application import application
from restshape.interface.first_frame import first_frame

FOLDER = application("vibration").folder
CASE = Case("building", FOLDER / "scenes/building.toml", FOLDER / "edits/building.jsonl")
MESH = ("mesh.order=1", "mesh.size=0.425")
"""The elements of the thesis, of first order, instead of those of the scene."""
PLAN = Plan(("auto", "thesis", "rebuild"), frames=220, overrides=("effects.dynamics.steps=1", *MESH))
"""As in the thesis a frame is one step of time; of the script 20 frames at rest and 200 of the first drag."""
TRIANGLES = 1962
SPEEDS = {"auto": 105.0, "thesis": 105.0, "rebuild": 41.8}
"""Frames a second of the thesis, with and without reuse."""
WHOLE, ESTIMATED = "", ", errors and jumps estimated"
"""Ends of the names of quantities: all that a frame costs without estimates, and with them."""


def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`; `timing` marks those that a clock decides, which need not be `timed`."""
    common = {"table": "4.3", "row": "vibration"}
    elements = first_frame(CASE.scene, MESH).row["elements"]
    counted = {**common, "quantity": "triangles", "thesis": TRIANGLES, "ours": elements, "unit": "triangles"}
    # Policies take turns on a warm machine, so that a slow spell of it favours none.
    found = compare(CASE, PLAN, lambda words: None) if timed else {}
    speeds = [
        {
            **common,
            "quantity": f"frames a second, one step a frame, policy {name}{words}",
            "thesis": SPEEDS[name],
            "ours": speed,
            "unit": "1/s",
            "timing": True,
        }
        for name, entry in found.items()
        for words, speed in ((WHOLE, entry["whole"]["fps"]), (ESTIMATED, entry["estimated"]["fps"]))
    ]
    return [{**counted, "timing": False}, *speeds]
