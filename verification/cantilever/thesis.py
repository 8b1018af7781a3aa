"""The thesis's cantilever beside ours: row 2 of table 4.3, and figure 5.6."""

from typing import Any

from restshape_studies.bench.reuse import Plan, compare
from restshape_studies.bench.starts import table_rows
from restshape_studies.bench.turns import Case

from restshape.application import application
from restshape.interface.first_frame import first_frame

FOLDER = application("cantilever").folder
CASE = Case("cantilever", FOLDER / "scenes/cantilever.toml", FOLDER / "edits/cantilever.jsonl")
GUESSES = ("auto:last", "refactor:last", "auto:zero", "refactor:zero")
"""With other initial guesses than their best: what guesses alone are worth."""
PLAN = Plan(("auto", "thesis", "refactor", "rebuild", *GUESSES))
REUSE, REBUILD = 37.6, 7.1
"""Frames a second of the thesis, with and without reuse."""


def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`; `timing` marks those that a clock decides, which need not be `timed`,
    `rounding` those that turn on the last digits of meshes."""
    common = {"table": "4.3", "row": "cantilever"}
    count = first_frame(CASE.scene).row["elements"]
    counted = {**common, "quantity": "triangles", "thesis": 990, "ours": count, "unit": "triangles", "timing": False}
    counted["rounding"] = True
    return [counted, *(speeds(common) if timed else ()), *table_rows(CASE.scene, CASE.edits)]


def speeds(common: dict[str, Any]) -> list[dict[str, Any]]:
    """Frames a second by policies, and their ratios; rows begin with what is `common` to them."""
    # Policies take turns on a warm machine, so that a slow spell of it favours none.
    found = compare(CASE, PLAN, lambda words: None)
    known = {"auto": REUSE, "thesis": REUSE, "rebuild": REBUILD}
    rates = [
        {
            **common,
            "quantity": f"frames a second, policy {_named(name)}{words}",
            "thesis": known.get(name, ""),
            "ours": found[name][key]["fps"],
            "unit": "1/s",
            "timing": True,
        }
        for name in found
        for words, key in (("", "whole"), (", errors estimated", "estimated"))
        if key in found[name]
    ]
    gains = [
        {
            **common,
            "quantity": f"policy auto over {base}"
            + (", initial guess extrapolated in both" if base == "refactor" else "")
            + ", until the answer",
            "thesis": round(REUSE / REBUILD, 1) if base == "rebuild" else "",
            "ours": found["auto"]["ratios"][base]["fps"],
            "unit": "ratio",
            "timing": True,
        }
        for base in ("rebuild", "refactor")
    ]
    gains += [
        {
            **common,
            "quantity": f"policy auto over refactor, initial guess {guess} in both",
            "thesis": "",
            "ours": found[f"auto:{guess}"]["fps"] / found[f"refactor:{guess}"]["fps"],
            "unit": "ratio",
            "timing": True,
        }
        for guess in ("last", "zero")
    ]
    return [*rates, *gains]


def _named(policy: str) -> str:
    """A policy for people, ``NAME:GUESS`` with its initial guess."""
    return policy.replace(":", ", initial guess ")
