"""What a replay of furniture reports: findings, the parameter under the hand and its valid ranges, suggestions."""

import json
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import groupby
from typing import Any

from restshape_apps.furniture.guidance.valid_ranges import Grabbed, decode_ranges
from restshape_apps.furniture.physics.plank_findings import (
    APART,
    DEPENDS,
    DOUBTFUL,
    FREE,
    GAPS,
    LOST,
    NEAREST,
    OVERBENT,
    OVERLAPPING,
    WEAK,
)
from restshape_apps.furniture.physics.plank_phrases import amount, phrases

from restshape.findings import Finding, decode_findings
from restshape.replay.constraints import FAILS, HOLDS, MIN, UNCERTAIN

Row = Mapping[str, Any]

CAUSES = {
    DOUBTFUL: "moments that do not count overload a joint",
    OVERBENT: "a plank bends beyond its strength",
    FREE: "an end is free near a face that it may have missed",
    DEPENDS: "compliances of joints that nobody knows decide it",
}
"""What makes a piece that holds doubtful, by kinds of findings."""


def has_findings(rows: Sequence[Row]) -> bool:
    """Whether rows have findings and valid ranges as data; those of recordings of version 0.1 have not."""
    return all("findings" in row for row in rows)


def findings_of(row: Row) -> tuple[Finding, ...]:
    """What is wrong in a frame; nothing where its recording has no findings."""
    return decode_findings(row.get("findings") or "")


def redundant(row: Row) -> list[tuple[str, float, float]]:
    """Redundant joints of a frame, the largest utilisation first: name, least and largest over the ratios."""
    return json.loads(row.get("redundant") or "[]")


def grabbed(row: Row) -> Grabbed | None:
    """What is under the hand in a frame, with its valid ranges; None where nothing is, or its recording has none."""
    return decode_ranges(row.get("valid_ranges") or "")


def only_limits(row: Row) -> bool:
    """Whether a frame fails by limits of quantities alone: the piece holds."""
    return row["constraint_status"] == FAILS and row.get("flaws", 1) <= 0


def doubtful(row: Row) -> bool:
    """Whether the piece of a frame holds, but something is doubtful: see `CAUSES`."""
    return row["constraint_status"] == UNCERTAIN


def doubt_causes(rows: Iterable[Row]) -> str:
    """Why pieces that hold in doubt do so, in these frames; empty where none does."""
    holding = [row for row in rows if doubtful(row) or only_limits(row)]
    kinds = {one.kind for row in holding for one in findings_of(row)}
    return " or ".join(words for kind, words in CAUSES.items() if kind in kinds)


def said(row: Row, words: str = "") -> str:
    """What is said of a piece in a frame: that it holds, what is doubtful or beyond its limit where it does, or what is
    wrong; empty where it is not judged.

    Args:
        row: of a recording.
        words: what is wrong or doubtful, in place of the row's own.
    """
    if row["constraint_status"] == HOLDS:
        return HOLDS
    words = words or row["violated_constraints"]
    return f"holds, but {words}" if words and (only_limits(row) or doubtful(row)) else words


def summary(rows: Sequence[Row]) -> dict[str, Any]:
    """What the summary of a replay has besides."""
    return {"guidance": guidance(rows)}


def guidance(rows: Sequence[Row]) -> dict[str, Any]:
    """What is known of each frame, and of each search for suggestions, for programs; None is what is not known.

    Args:
        rows: of all frames of a replay of furniture.
    """
    searched = [same for same in searches(rows) if same[0].get("suggestions")]
    return {"frames": [_frame(row) for row in rows], "suggestions": [_search(same) for same in searched]}


def searches(rows: Iterable[Row]) -> list[list[Row]]:
    """Frames in which suggestions were looked for, those together that have the same of the same flaws."""
    found: dict[tuple[str, ...], list[Row]] = {}
    for row in rows:
        key = tuple(row.get(name) or "" for name in ("suggestions", "no_suggestions", "violated_constraints"))
        if key[0] or key[1]:
            found.setdefault(key, []).append(row)
    return list(found.values())


def found(row: Row) -> list[dict[str, Any]]:
    """The suggestions of a frame."""
    return json.loads(row["suggestions"]) if row.get("suggestions") else []


def runs(rows: Iterable[Row]) -> list[tuple[Row, Row, str]]:
    """Frames in a row with the same findings but for their amounts: the first, the last, and what is wrong with the
    piece, with the worst of each amount; frames without a constraint status are left out."""
    judged = [row for row in rows if row["constraint_status"]]
    spans = [list(span) for _, span in groupby(judged, key=_without_amounts)]
    return [(span[0], span[-1], _at_worst(span)) for span in spans]


def _without_amounts(row: Row) -> Any:
    """What is wrong in a frame; its text where its recording has no findings."""
    findings = findings_of(row)
    if not findings:
        return HOLDS if row["constraint_status"] == HOLDS else row["violated_constraints"]
    # How far parts are from each other is known in some frames only.
    return Counter(_same(one) for one in findings if not _is_gap(one))


def _same(one: Finding) -> Finding:
    """What a finding is in frames that differ in amounts alone."""
    # Where two planks overlap changes from frame to frame.
    one = replace(one, subjects=one.subjects[:2]) if one.kind == OVERLAPPING else one
    return Finding(APART, NEAREST) if _is_gap(one) else one.identity


def _is_gap(one: Finding) -> bool:
    """Whether a finding is what keeps two parts from being joined."""
    return one.kind == APART and one.detail in GAPS


def _at_worst(span: Sequence[Row]) -> str:
    """What is wrong in frames that differ in amounts alone, with the worst of each amount."""
    return said(span[0], _worst_words(span))


def _worst_words(span: Sequence[Row]) -> str:
    first = span[0]
    if first["constraint_status"] == HOLDS:
        return HOLDS
    # The text has what there was no room for in the findings.
    if len({row["violated_constraints"] for row in span}) == 1:
        return first["violated_constraints"]
    equal: dict[tuple[Finding, int], list[Finding]] = defaultdict(list)
    for row in span:
        seen = Counter[Finding]()
        for one in findings_of(row):
            equal[_same(one), seen[_same(one)]].append(one)
            seen[_same(one)] += 1
    worst = [_worst(same) for same in equal.values()]
    varying = {one for one, same in zip(worst, equal.values()) if len(set(map(amount, same))) > 1}
    kinds = list(dict.fromkeys(one.kind for one in worst))
    worst.sort(
        key=lambda one: (kinds.index(one.kind), -(one.value or 0.0) if one.kind in (WEAK, DOUBTFUL, OVERBENT) else 0.0)
    )
    return "; ".join(phrases(worst, varying))


def _worst(same: Sequence[Finding]) -> Finding:
    """Of findings that differ in amounts alone the worst; of what is lost without a distance that not all have."""
    if same[0].kind == LOST and any(not amount(one) or one.value <= one.bound for one in same):
        return replace(same[0], value=None)
    least = same[0].detail == MIN
    return (min if least else max)(same, key=lambda one: one.value or 0.0)


def _frame(row: Row) -> dict[str, Any]:
    """What is known of one frame."""
    hand, on_parameter = grabbed(row), bool(row.get("parameter"))
    ranges = hand.ranges if hand else None
    return {
        "index": int(row["index"]),
        "line": int(row["line"]),
        "constraint_status": row["constraint_status"],
        "violated_constraints": row["violated_constraints"],
        "findings": [one.as_dict() for one in findings_of(row)] if "findings" in row else None,
        "utilisation": _number(row, "utilisation"),
        "redundant": redundant(row),
        "redundant_count": int(row.get("redundant_count", len(redundant(row)))),
        "stability_margin": _number(row, "stability_margin"),
        "parameter": row.get("parameter", ""),
        "unit": hand.unit if hand else None,
        "at": _number(row, "at") if on_parameter else None,
        "ranges": None if ranges is None else [[one.low, one.high] for one in ranges],
        "doubtful": [list(one) for one in hand.doubtful] if ranges else None if ranges is None else [],
        "beyond": None if ranges is None else [[one.below, one.above] for one in ranges],
        "inside": bool(row["inside"]) if on_parameter and row["inside"] >= 0 else None,
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
