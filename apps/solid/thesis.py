"""The thesis's numbers on reuse beside ours: table 4.2 and figure 4.2."""

from pathlib import Path
from typing import Any

from restshape.replay.run import replay_files

FOLDER = Path(__file__).parent
THESIS = {"1": 117, "2": 39, "3": 3}
NAMES = {"1": "level 1 (relocation)", "2": "level 2 (reconnection)", "3": "level 3 (reconstruction)"}


def rows() -> list[dict[str, Any]]:
    """Rows of `restshape tables`; `timing` marks those that a clock decides."""
    runs = {
        name: replay_files(FOLDER / "scenes/plate.toml", FOLDER / "edits/plate.jsonl", name)
        for name in ("auto", "thesis")
    }
    counts = [
        {
            "table": "4.2",
            "row": NAMES[level],
            "quantity": f"frames, policy {name}",
            "thesis": THESIS[level],
            "ours": run["levels"][level],
            "unit": "frames",
            "timing": False,
        }
        for name, run in runs.items()
        for level in ("1", "2", "3")
    ]
    costs = [
        {
            "table": "4.2, figure 4.2",
            "row": "level 3 over level 1",
            "quantity": f"time of a frame (p50), policy {name}",
            "thesis": "> 2",
            "ours": run["ms"]["3"]["p50"] / run["ms"]["1"]["p50"],
            "unit": "ratio",
            "timing": True,
        }
        for name, run in runs.items()
    ]
    return [*counts, *costs]
