"""The thesis's numbers beside ours, in Markdown."""

from collections.abc import Iterable, Mapping
from itertools import groupby
from typing import Any

from restshape.report.tables import markdown_table


def thesis_table(rows: Iterable[Mapping[str, Any]]) -> str:
    """Markdown: a section a table of the thesis, its numbers beside ours.

    Args:
        rows: dicts with table ("4.2"), row, quantity, thesis, ours, unit; rows of one table follow each other.
    """
    names = ("row", "quantity", "thesis", "ours", "unit")
    sections = []
    for table, members in groupby(rows, key=lambda row: str(row["table"])):
        cells = [[member.get(name) for name in names] for member in members]
        heading = table.capitalize() if table.startswith("figure") else f"Table {table}"
        sections.append(f"## {heading}\n\n{markdown_table(names, cells, right=('thesis', 'ours'))}")
    return "\n".join(sections)
