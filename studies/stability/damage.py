"""Hypothesis strategies of damage to scenes and scripts."""

import json
from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.shape_strategies import Table

splices = st.tuples(st.floats(0, 1), st.integers(0, 12), st.text(alphabet="{}[]\"=.,:-\n abxt019eN#'\\\0", max_size=6))
values = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**30), 10**30) | st.floats() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=5,
)
plain_values = values.filter(lambda value: "null" not in json.dumps(value))
"""Those that TOML can hold."""


def spliced(text: str, changes: list[tuple[float, int, str]]) -> str:
    """The text with pieces cut out and others put in."""
    for place, length, piece in changes:
        at = int(place * len(text))
        text = text[:at] + piece + text[at + length :]
    return text


def keys_of(table: Table, before: tuple[str, ...] = ()) -> list[tuple[str, ...]]:
    """Every key of nested tables."""
    inner = [k for key, value in table.items() if isinstance(value, dict) for k in keys_of(value, (*before, key))]
    return [(*before, key) for key in table] + inner


def replaced(table: Table, key: tuple[str, ...], value: Any) -> Table:
    """A copy of the tables with another value at one key."""
    inner = value if len(key) == 1 else replaced(table[key[0]], key[1:], value)
    return {**table, key[0]: inner}


def without(table: Table, key: tuple[str, ...]) -> Table:
    """A copy of the tables without one key."""
    if len(key) == 1:
        return {name: value for name, value in table.items() if name != key[0]}
    return {**table, key[0]: without(table[key[0]], key[1:])}
