"""What a replay of furniture told its user: verdicts, the parameter under the hand and its ranges, suggestions."""

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from typing import Any

from restshape_apps.furniture.physics.plank_words import DISTANCES, GAPS, without_uses

from restshape.replay.constraints import HOLDS
from restshape.scene.units import quantity

NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
USE = re.compile(r" at (\S+) of its (?:shear )?strength")
VALUE = re.compile(rf" is ({NUMBER}(?: [^\s,;]+)?), at (most|least) ({NUMBER}(?: [^\s,;]+)?)")
OPEN = "( or beyond)?"
INTERVAL = re.compile(f"({NUMBER}){OPEN} to ({NUMBER}){OPEN}")
Row = Mapping[str, Any]


def intervals(text: str) -> list[tuple[float, float]]:
    """The valid ranges in a column's text, such as ``-0.2 to 0.03; 0.1 to 0.55``; none of "none" and of no text."""
    return [(float(low), float(high)) for low, _, high, _ in INTERVAL.findall(text)]


def beyond(text: str) -> list[tuple[bool, bool]]:
    """Of each valid range whether its ends are where nothing further was looked at."""
    return [(bool(below), bool(above)) for _, below, _, above in INTERVAL.findall(text)]


def unit_of(parameter: str) -> str:
    """The unit of a parameter under the hand, "m" or "rad": that of a suggestion is the one that it names first."""
    leading = parameter.split(" + ")[0]
    return "rad" if " turn " in f"{leading} " else "m"


def summary(rows: Sequence[Row]) -> dict[str, Any]:
    """What the summary of a replay has besides."""
    return {"guidance": guidance(rows)}


def guidance(rows: Sequence[Row]) -> dict[str, Any]:
    """What each frame told, and each search for suggestions, for programs; None stands for what is not known.

    Args:
        rows: of all frames of a replay of furniture.
    """
    searched = [same for same in searches(rows) if same[0].get("suggestions")]
    return {"frames": [_frame(row) for row in rows], "suggestions": [_search(same) for same in searched]}


def searches(rows: Iterable[Row]) -> list[list[Row]]:
    """Frames in which suggestions were looked for, those together that tell the same of the same flaws."""
    told: dict[tuple[str, ...], list[Row]] = {}
    for row in rows:
        key = tuple(row.get(name) or "" for name in ("suggestions", "no_suggestions", "violated_constraints"))
        if key[0] or key[1]:
            told.setdefault(key, []).append(row)
    return list(told.values())


def found(row: Row) -> list[dict[str, Any]]:
    """The suggestions of a frame."""
    return json.loads(row["suggestions"]) if row.get("suggestions") else []


def runs(rows: Iterable[Row]) -> list[tuple[Row, Row, str]]:
    """Frames in a row with one verdict: the first, the last, and what is wrong with the piece; frames without one are
    left out."""
    judged = [row for row in rows if row["constraint_status"]]
    spans = [list(span) for _, span in groupby(judged, key=lambda row: without_amounts(_words(row)))]
    return [(span[0], span[-1], at_worst(list(map(_words, span)))) for span in spans]


def without_amounts(words: str) -> str:
    """What is wrong, without uses of strength, distances and values of quantities, which change from frame to frame."""
    return VALUE.sub("", without_uses(words))


def at_worst(told: Sequence[str]) -> str:
    """What is wrong in frames that differ in amounts alone, with the worst of each amount.

    Args:
        told: what is wrong in each of them.
    """
    if len(set(told)) == 1:
        return told[0]
    told = _at_farthest(told)
    uses = iter([max(same, key=lambda use: float(use[1])) for same in zip(*map(USE.finditer, told))])
    values = iter([_farthest(same) for same in zip(*map(VALUE.finditer, told))])
    words = USE.sub(lambda _: " at up to " + next(uses)[0].removeprefix(" at "), told[0])
    return VALUE.sub(lambda _: next(values), words)


def _at_farthest(told: Sequence[str]) -> list[str]:
    """What is wrong in frames that differ in amounts alone; the first tells the largest distances of all."""
    gaps = [gap for words in told for gap in GAPS.finditer(words)]
    ways = [DISTANCES.findall(words) for words in told]
    words = GAPS.sub("", told[0])
    if gaps:
        # After the parts, of which it is told first; it may be in some of the frames only.
        most = max(gaps, key=lambda gap: float(gap[1]))[0]
        same = len({gap[0] for gap in gaps}) == 1
        parts, *others = words.split("; ")
        words = "; ".join([parts + (most if same else most.replace(" is ", " is up to ")), *others])
    # Without them where only some of the frames have them.
    ways = ways if all(len(far) == len(ways[0]) for far in ways) else []
    farthest = iter([max(far, key=float) for far in zip(*ways)])
    words = DISTANCES.sub(lambda _: f", up to {next(farthest)} mm from it" if ways else "", words)
    return [words, *told[1:]]


def _farthest(same: Sequence[re.Match[str]]) -> str:
    """Of values of a quantity beyond a limit the one that is farthest from it."""
    least = same[0][2] == "least"
    worst = (min if least else max)(same, key=lambda value: quantity(value[1], None))
    return f" is {'down' if least else 'up'} to {worst[1]}, at {worst[2]} {worst[3]}"


def _words(row: Row) -> str:
    return HOLDS if row["constraint_status"] == HOLDS else row["violated_constraints"]


def _frame(row: Row) -> dict[str, Any]:
    """What one frame told."""
    held = bool(row.get("parameter"))
    return {
        "index": int(row["index"]),
        "line": int(row["line"]),
        "constraint_status": row["constraint_status"],
        "violated_constraints": row["violated_constraints"],
        "utilisation": _number(row, "utilisation"),
        "stability_margin": _number(row, "stability_margin"),
        "parameter": row.get("parameter", ""),
        "unit": unit_of(row["parameter"]) if held else None,
        "at": _number(row, "at") if held else None,
        "ranges": [list(one) for one in intervals(row["ranges"])] if held and row["ranges"] else None,
        "beyond": [list(one) for one in beyond(row["ranges"])] if held and row["ranges"] else None,
        "inside": bool(row["inside"]) if held and row["inside"] >= 0 else None,
    }


def _search(same: Sequence[Row]) -> dict[str, Any]:
    """What one search for suggestions found, which holds for all these frames."""
    row = same[0]
    return {
        "frame": int(row["index"]),
        "frames": [int(one["index"]) for one in same],
        "line": int(row["line"]),
        "violated_constraints": row["violated_constraints"],
        "tried": int(row["tried"]),
        "tested": int(row["tested"]),
        "ms": _number(row, "ms_suggestions"),
        "found": found(row),
    }


def _number(row: Row, column: str) -> float | None:
    """A number; None where there is none, which JSON does not know."""
    value = float(row.get(column, float("nan")))
    return value if abs(value) < float("inf") else None
