"""Tables where there is no terminal: aligned columns, a row a line, without a library that is made for terminals."""

from collections.abc import Container, Iterator, Sequence
from itertools import zip_longest

GAP = "  "
"""Between columns."""
COMBINING = "\u0300"
"""From here on a character may take two columns, or none."""


def plain_table(heads: Sequence[str], rows: Sequence[Sequence[str]], right: Container[str]) -> Iterator[str]:
    """The lines of a table, each column as wide as its widest cell.

    Args:
        heads: of the columns.
        rows: their cells; a row may end early.
        right: heads of the columns to align to the right.
    """
    columns = list(zip_longest(heads, *([*map(_one_line, row)] for row in rows), fillvalue=""))
    sizes = [[_width(cell) for cell in column] for column in columns]
    aligned = [
        [f"{' ' * blank}{cell}" if head in right else f"{cell}{' ' * blank}" for cell, blank in zip(column, blanks)]
        for head, column, blanks in zip(heads, columns, ([max(size) - one for one in size] for size in sizes))
    ]
    for line in zip(*aligned):
        yield GAP.join(line).rstrip()


def _one_line(cell: str) -> str:
    return " ".join(cell.splitlines()).expandtabs()


def _width(text: str) -> int:
    """How many columns a text takes."""
    if max(text, default="") < COMBINING:
        return len(text)
    from rich.cells import cell_len

    return cell_len(text)
