"""The thesis's heated teapot beside ours: row 4 of table 4.3."""

from typing import Any

from restshape_studies.bench.moving_speeds import Known, moving_rows
from restshape_studies.bench.turns import Case

from restshape.application import application

FOLDER = application("thermal").folder
CASE = Case("thermal", FOLDER / "scenes/thermal.toml", FOLDER / "edits/thermal.jsonl")
THESIS = Known("thermal", 1938, reuse=21.3, rebuild=14.3)
FRAMES = 132
"""Of the script: plumes rise, and the spout is drawn out."""


def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`, see `moving_rows`."""
    return moving_rows(CASE, THESIS, FRAMES, timed)
