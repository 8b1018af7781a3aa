"""The columns of a frame's row by name, and what each of them holds."""

import math
from collections.abc import Mapping

from restshape.findings import Finding

RowValue = str | float | tuple[Finding, ...]
RowValues = dict[str, RowValue]
"""Numbers and texts of a frame by column; findings until they are encoded as text."""


def number(row: Mapping[str, RowValue], column: str, absent: float = math.nan) -> float:
    """The number in a column; `absent` where there is no such column.

    Raises:
        TypeError: it holds no number.
    """
    value = row.get(column, absent)
    if isinstance(value, str | tuple):
        raise TypeError(f"the column {column!r} holds no number: {value!r}")
    return value


def whole(row: Mapping[str, RowValue], column: str) -> int:
    """The whole number in a column.

    Raises:
        KeyError: there is no such column.
        TypeError: it holds no number.
    """
    value = row[column]
    if isinstance(value, str | tuple):
        raise TypeError(f"the column {column!r} holds no number: {value!r}")
    return int(value)


def text(row: Mapping[str, RowValue], column: str) -> str:
    """The text in a column; empty where there is no such column.

    Raises:
        TypeError: it holds no text.
    """
    value = row.get(column, "")
    if not isinstance(value, str):
        raise TypeError(f"the column {column!r} holds no text: {value!r}")
    return value


def findings_in(row: Mapping[str, RowValue]) -> tuple[Finding, ...]:
    """The findings of a row, before they are encoded; none where there is no such column."""
    value = row.get("findings", ())
    if not isinstance(value, tuple):
        raise TypeError(f"the column 'findings' is encoded already: {value!r}")
    return value
