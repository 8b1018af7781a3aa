"""Tables where there is no terminal have the columns that Rich gives them, and do not wait for it."""

import io

import pytest
from rich.console import Console
from rich.table import Table
from rich.text import Text

from restshape.cli.plain_table import plain_table

TABLES = {
    "numbers": (("name", "value"), [("u", "1.5"), ("longer", "-2e-05")]),
    "signs": (("α [°]", "m²"), [("±1", "x"), ("−0.25 · 3", "…")]),
    "wide": (("名前", "b"), [("表", "c"), ("a", "日本語")]),
    "empty cells": (("a", "b", "c"), [("", "x", ""), ("y", "", "")]),
    "no rows": (("first", "second"), []),
    "short rows": (("a", "b"), [("only",), ("x", "y")]),
}


def lines_of_rich(heads, rows, right):
    """The same table by Rich, a row a line."""
    text = io.StringIO()
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    for head in heads:
        table.add_column(Text(head), justify="right" if head in right else "left")
    for row in rows:
        table.add_row(*map(Text, row))
    Console(file=text, width=1_000_000).print(table)
    return [line.rstrip() for line in text.getvalue().splitlines()]


@pytest.mark.parametrize("heads, rows", TABLES.values(), ids=TABLES)
@pytest.mark.parametrize("of", [(), (0,), (-1,)])
def test_columns_are_those_of_rich(heads, rows, of):
    right = [heads[k] for k in of]
    assert list(plain_table(heads, rows, right)) == lines_of_rich(heads, rows, right)
