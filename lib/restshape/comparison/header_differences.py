"""How two results were made: which keys of their scenes, scripts and options differ."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, NamedTuple

from restshape.bounds import NESTING
from restshape.comparison.result import Result

TEXT = "script_text"
REPEATED = ("units", "overrides", "load_scales", "limits")
"""Keys that repeat what the scene says."""
SHOWN = 60
"""Characters of a value that is shown."""


class HeaderDifference(NamedTuple):
    """A key that differs, with its values; None where a result does not have it."""

    key: str
    first: object
    second: object


def header_differences(first: Result, second: Result) -> list[HeaderDifference]:
    """What differs in how two results were made, of what both say.

    Keys of the scene are dotted as after --set. Of scripts with the same name and other text the first line that
    differs is given.
    """
    whole = all(one.recording for one in (first, second))
    # A JSON file does not have the values of its scene.
    repeated = REPEATED if whole else REPEATED[:1]
    said = [{k: v for k, v in one.header.items() if k not in repeated and v != {}} for one in (first, second)]
    both = [_flat(header) for header in said]
    keys = dict.fromkeys([*both[0], *both[1]] if whole else [key for key in both[0] if key in both[1]])
    found = []
    for key in keys:
        values = [one.get(key) for one in both]
        if values[0] != values[1]:
            found.append(_script(*values) if key == TEXT else HeaderDifference(key, *values))
    return found


def _flat(table: dict[str, Any]) -> dict[str, object]:
    """A header without tables in each other; keys of the scene stand without the name of their table."""
    return {".".join(key): value for key, value in _leaves(table, ())}


def _leaves(value: object, key: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], object]]:
    if len(key) > NESTING:
        yield key, value
    elif isinstance(value, dict) and value:
        for name, inner in value.items():
            yield from _leaves(inner, (*(part for part in key if part != "scene_values"), str(name)))
    elif isinstance(value, list) and any(isinstance(one, dict) for one in value):
        for place, inner in enumerate(value):
            yield from _leaves(inner, (*key, str(place)))
    else:
        yield key, value


def _script(first: object, second: object) -> HeaderDifference:
    """The first line in which two scripts differ."""
    lines = [str(text or "").splitlines() for text in (first, second)]
    count = max(map(len, lines))
    padded = [one + [""] * (count - len(one)) for one in lines]
    here = next((k for k in range(count) if padded[0][k] != padded[1][k]), 0)
    return HeaderDifference(f"script line {here + 1}", *(one[here] if here < len(one) else None for one in padded))


def shortened(value: object) -> str:
    """A value for a table, written as a scene has it."""
    written = json.dumps(value, ensure_ascii=False) if isinstance(value, bool | list | dict) else str(value)
    text = "-" if value is None else written
    return text if len(text) <= SHOWN else f"{text[: SHOWN - 1]}…"
