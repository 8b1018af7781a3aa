"""What `restshape replay` prints of the guidance that furniture was given."""

import json
from collections.abc import Mapping, Sequence
from typing import Any

from restshape.cli.options import print_table


def print_guidance(rows: Sequence[Mapping[str, Any]]) -> None:
    """Prints the valid ranges of each parameter that was under the hand, and the last suggestions; else nothing."""
    ranges: dict[tuple[int, str, str], list[int]] = {}
    for row in rows:
        if row.get("ranges"):
            ranges.setdefault((row["line"], row["parameter"], row["ranges"]), []).append(row["inside"])
    if ranges:
        heads = ("line", "parameter under the hand", "valid for", "frames", "of them valid")
        cells = [(*key, len(inside), sum(inside)) for key, inside in _few(ranges).items()]
        print_table("valid ranges [m or rad]", heads, cells, right=(heads[0], *heads[3:]))
    last = next((row for row in reversed(rows) if row.get("suggestions")), None)
    if last is None:
        return
    heads = ("number", "what it changes", "shown at", "from", "to", "holds")
    cells = [
        (one["number"], one["words"], one["t"], *one["range"], "yes" if one["valid"] else "in part")
        for one in json.loads(last["suggestions"])
    ]
    place = f"suggestions in frame {last['index']}, line {last['line']}, where {last['broken']}"
    print_table(f"{place}; {last['tried']} combinations tried", heads, cells, right=heads[2:5])


def _few(ranges: Mapping[tuple[int, str, str], list[int]], most: int = 12) -> dict[tuple[int, str, str], list[int]]:
    """The ranges, of each line the last one alone where there are too many."""
    if len(ranges) <= most:
        return dict(ranges)
    last: dict[int, tuple[tuple[int, str, str], list[int]]] = {}
    for key, inside in ranges.items():
        last[key[0]] = key, [*last.get(key[0], (key, []))[1], *inside]
    return dict(list(last.values())[:most])
