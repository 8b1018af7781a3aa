"""The thesis's cantilever beside ours: row 2 of table 4.3, and figure 5.6."""

from pathlib import Path
from typing import Any

from restshape.bench.reuse import frames_a_second
from restshape.bench.starts import table_rows
from restshape.replay.run import replay_files

FOLDER = Path(__file__).parent
REUSE, REBUILD = 37.6, 7.1
"""Frames a second of the thesis, with and without reuse."""


def rows() -> list[dict[str, Any]]:
    """Rows of `restshape tables`; `timing` marks those that a clock decides."""
    runs = {
        name: replay_files(FOLDER / "scenes/cantilever.toml", FOLDER / "edits/cantilever.jsonl", name)
        for name in ("auto", "thesis", "refactor", "rebuild")
    }
    fps = {name: frames_a_second(run["rows"]) for name, run in runs.items()}
    common = {"table": "4.3", "row": "cantilever"}
    counted = {**common, "quantity": "triangles", "thesis": 990, "ours": runs["auto"]["rows"][0]["elements"]}
    known = {"auto": REUSE, "thesis": REUSE, "rebuild": REBUILD}
    speeds = [
        {
            **common,
            "quantity": f"frames a second, policy {name}",
            "thesis": known.get(name, ""),
            "ours": fps[name],
            "unit": "1/s",
            "timing": True,
        }
        for name in runs
    ]
    gains = [
        {
            **common,
            "quantity": f"policy auto over {base}",
            "thesis": round(REUSE / REBUILD, 1) if base == "rebuild" else "",
            "ours": fps["auto"] / fps[base],
            "unit": "ratio",
            "timing": True,
        }
        for base in ("rebuild", "refactor")
    ]
    starts = table_rows(FOLDER / "scenes/cantilever.toml", FOLDER / "edits/cantilever.jsonl")
    return [{**counted, "unit": "triangles", "timing": False}, *speeds, *gains, *starts]
