"""What `restshape replay` prints of the guidance that furniture was given."""

from collections.abc import Mapping, Sequence
from typing import Any

from restshape_apps.furniture.guidance.amounts import UNITS, ends
from restshape_apps.furniture.guidance.valid_ranges import ValidRange, decode_ranges
from restshape_apps.furniture.physics.joint_label import utilisation_words
from restshape_apps.furniture.report.guided import (
    findings_of,
    found,
    grabbed,
    has_findings,
    redundant,
    runs,
    said,
    searches,
)

from restshape.cli.options import print_table
from restshape.outputs.si_numbers import counted
from restshape.replay.constraints import LIMIT
from restshape.replay.rounding import cleared

MOST = 12
"""Rows of a table at most."""
NAMED = 8
"""Frames that are named at most."""
Ranges = Mapping[tuple[int, str, str], list[int]]


def print_guidance(rows: Sequence[Mapping[str, Any]]) -> None:
    """Prints statuses, the valid ranges of each parameter that was under the hand, and all suggestions."""
    _print_statuses(rows)
    _print_redundant(rows)
    ranges: dict[tuple[int, str, str], list[int]] = {}
    for row in rows:
        if (hand := grabbed(row)) and hand.ranges is not None:
            ranges.setdefault((row["line"], row["parameter"], row["valid_ranges"]), []).append(row["inside"])
    if ranges:
        heads = ("line", "parameter under the hand", "valid from where it was taken", "frames", "of them valid")
        cells = [
            (line, name, _valid(text), len(inside), sum(one != 0 for one in inside))
            for (line, name, text), inside in _few(ranges).items()
        ]
        print_table("valid ranges", heads, cells, right=(heads[0], *heads[3:]))
    for same in searches(rows):
        if same[0].get("suggestions"):
            _print_suggestions(same)
        else:
            print(f"no suggestions in {_frames(same)}: {same[0]['no_suggestions']}")
    if not has_findings(rows):
        print("valid ranges and worst amounts want a newer recording: record it again")
    if any(one.kind == LIMIT for row in rows for one in findings_of(row)):
        print("limits of quantities count in the constraint status and in suggestions, not in valid ranges")


def _print_statuses(rows: Sequence[Mapping[str, Any]]) -> None:
    """Prints from which frame to which the piece holds, and what is wrong with it elsewhere."""
    spans = runs(rows)
    cells = [
        (first["line"], f"{first['index']} to {last['index']}" if last is not first else f"{first['index']}", words)
        for first, last, words in spans[:MOST]
    ]
    if len(spans) > MOST:
        cells.append(("", "...", f"and {len(spans) - MOST} more: see the recording, --csv or --json"))
    print_table("constraint status", ("line", "frames", "the piece"), cells, right=("line",))


def _print_redundant(rows: Sequence[Mapping[str, Any]]) -> None:
    """Prints joints of the last frame that has any whose utilisation depends on the ratios of compliance."""
    last = next((row for row in reversed(rows) if redundant(row)), None)
    if last is None:
        return
    joints = redundant(last)[:MOST]
    # A utilisation is measured against 1.
    cells = [(name, *(utilisation_words(cleared(use, 1.0), ".3g") for use in uses)) for name, *uses in joints]
    more = last.get("redundant_count", len(redundant(last))) - len(joints)
    cells += [("...", "", f"and {more} more")] if more > 0 else []
    heads = ("joint", "min utilisation", "max utilisation")
    title = f"redundant joints in frame {last['index']}, over the ratios of compliance"
    print_table(title, heads, cells, right=heads[1:])


def _valid(text: str) -> str:
    """Ranges of a recording as people read them."""
    hand = decode_ranges(text)
    size = max((abs(end) for one in hand.ranges for end in (one.low, one.high)), default=0.0)
    parts = "; ".join(_interval(low, high, size, hand.unit) for low, high in hand.doubtful)
    doubts = f"; doubtful from {parts}" if parts else ""
    return ("; ".join(_range(one, size, hand.unit) for one in hand.ranges) or "nothing") + doubts


def _range(one: ValidRange, size: float, unit: str) -> str:
    """A range as people read it; `size` is the largest end of all."""
    marks = [" or beyond" if beyond else "" for beyond in (one.below, one.above)]
    return _interval(one.low, one.high, size, unit, marks)


def _interval(low: float, high: float, size: float, unit: str, marks: Sequence[str] = ("", "")) -> str:
    """An interval in its SI unit as people read it, with a mark behind each end."""
    factor, shown = UNITS[unit]
    texts = [f"{factor * cleared(end, size):+.6g}{mark}" for end, mark in zip((low, high), marks)]
    return f"{' to '.join(texts)} {shown}"


def _frames(same: Sequence[Mapping[str, Any]]) -> str:
    """Which frames, in words: the first with its line, then as many as there is room for."""
    first, *others = same
    place = f"frame {first['index']}, line {first['line']}"
    if not others:
        return place
    named = ", ".join(str(row["index"]) for row in others[:NAMED])
    more = len(others) - NAMED
    return f"{place} (and in {named}{f' and {more} more' if more > 0 else ''})"


def _print_suggestions(same: Sequence[Mapping[str, Any]]) -> None:
    """Prints the suggestions that hold for these frames."""
    row = same[0]
    heads = ("number", "what it does", "valid range of what it names first", "holds")
    cells = [(one["number"], one["words"], _span(one), _holds(one)) for one in found(row)]
    # For a piece in parts no combinations are searched.
    tried = f"; {counted(row['tried'], 'combination')} tried" if row["tried"] else ""
    print_table(f"suggestions in {_frames(same)}: {said(row)}{tried}", heads, cells, right=heads[:1])


def _holds(one: Mapping[str, Any]) -> str:
    """Whether a piece holds after a suggestion, or what is still wrong with it."""
    if one["valid"]:
        return f"yes, but {one['doubt']}" if one.get("doubt") else "yes"
    return f"in part; still {one['rest']}" if one.get("rest") else "in part"


def _span(one: Mapping[str, Any]) -> str:
    """The range of a suggestion as people read it; a plank that is added has none."""
    if not one["unit"]:
        return ""
    low, high = ends(*one["range"], one["unit"])
    return f"{low.partition(' ')[0]} to {high}{' or beyond' if one['beyond'] else ''}"


def _few(ranges: Ranges) -> Ranges:
    """The ranges, of each line the last one alone where there are too many."""
    if len(ranges) <= MOST:
        return ranges
    last: dict[int, tuple[tuple[int, str, str], list[int]]] = {}
    for key, inside in ranges.items():
        last[key[0]] = key, [*last.get(key[0], (key, []))[1], *inside]
    return dict(list(last.values())[:MOST])
