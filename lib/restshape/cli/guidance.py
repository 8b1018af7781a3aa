"""What `restshape replay` prints of the guidance that furniture was given."""

from collections.abc import Mapping, Sequence
from typing import Any

from restshape.cli.options import print_table
from restshape.guidance.amounts import UNITS
from restshape.replay.guided import beyond, found, intervals, is_guided, runs, unit_of

MOST = 12
"""Rows of a table at most."""
Ranges = Mapping[tuple[int, str, str], list[int]]


def print_guidance(rows: Sequence[Mapping[str, Any]]) -> None:
    """Prints verdicts, the valid ranges of each parameter that was under the hand, and all suggestions.

    Of what is no furniture nothing is printed.
    """
    if not (rows and is_guided(rows[0])):
        return
    _print_verdicts(rows)
    ranges: dict[tuple[int, str, str], list[int]] = {}
    for row in rows:
        if row.get("ranges"):
            ranges.setdefault((row["line"], row["parameter"], row["ranges"]), []).append(row["inside"])
    if ranges:
        heads = ("line", "parameter under the hand", "valid from where it was taken", "frames", "of them valid")
        cells = [
            (line, name, _valid(name, text), len(inside), sum(inside))
            for (line, name, text), inside in _few(ranges).items()
        ]
        print_table("valid ranges", heads, cells, right=(heads[0], *heads[3:]))
    for row in rows:
        if row.get("suggestions"):
            _print_suggestions(row)
        elif row.get("no_suggestions"):
            print(f"no suggestions in frame {row['index']}, line {row['line']}: {row['no_suggestions']}")


def _print_verdicts(rows: Sequence[Mapping[str, Any]]) -> None:
    """Prints from which frame to which the piece holds, and what is wrong with it elsewhere."""
    spans = runs(rows)
    cells = [
        (first["line"], f"{first['index']} to {last['index']}" if last is not first else f"{first['index']}", words)
        for first, last, words in spans[:MOST]
    ]
    if len(spans) > MOST:
        cells.append(("", "...", f"and {len(spans) - MOST} more: see the recording, --csv or --json"))
    print_table("verdicts", ("line", "frames", "the piece"), cells, right=("line",))


def _valid(parameter: str, text: str) -> str:
    """Ranges as people read them."""
    factor, unit = UNITS[unit_of(parameter)]
    spans = [
        " to ".join(f"{factor * end:+.6g}{' or beyond' if mark else ''}" for end, mark in zip(ends, open_)) + f" {unit}"
        for ends, open_ in zip(intervals(text), beyond(text))
    ]
    return "; ".join(spans) or "nothing"


def _print_suggestions(row: Mapping[str, Any]) -> None:
    """Prints the suggestions of a frame."""
    heads = ("number", "what it does", "valid range of what it names first", "holds")
    cells = [(one["number"], one["words"], _span(one), "yes" if one["valid"] else "in part") for one in found(row)]
    place = f"suggestions in frame {row['index']}, line {row['line']}: {row['broken']}"
    print_table(f"{place}; {row['tried']} combinations tried", heads, cells, right=heads[:1])


def _span(one: Mapping[str, Any]) -> str:
    """The range of a suggestion as people read it; a plank that is added has none."""
    if not one["unit"]:
        return ""
    factor, unit = UNITS[one["unit"]]
    low, high = (factor * end for end in one["range"])
    return f"{low:.4g} to {high:.4g} {unit}{' or beyond' if one['beyond'] else ''}"


def _few(ranges: Ranges) -> Ranges:
    """The ranges, of each line the last one alone where there are too many."""
    if len(ranges) <= MOST:
        return ranges
    last: dict[int, tuple[tuple[int, str, str], list[int]]] = {}
    for key, inside in ranges.items():
        last[key[0]] = key, [*last.get(key[0], (key, []))[1], *inside]
    return dict(list(last.values())[:MOST])
