"""The thesis's flow beside ours: row 3 of table 4.3."""

from typing import Any

from restshape_studies.bench.moving_speeds import Known, moving_rows
from restshape_studies.bench.turns import Case

from restshape.application import application

FOLDER = application("flow").folder
CASE = Case("flow", FOLDER / "scenes/flow.toml", FOLDER / "edits/flow.jsonl")
THESIS = Known("flow", 1971, reuse=30.0, rebuild=18.2)
FRAMES = 152
"""Of the script: eddies form behind the body that rests, and its tail is drawn out."""


def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`, see `moving_rows`."""
    return moving_rows(CASE, THESIS, FRAMES, timed)
