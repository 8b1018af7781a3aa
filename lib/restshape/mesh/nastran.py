"""Nastran decks: with or without the line BEGIN BULK, and the single-point constraint sets that meshio leaves out."""

from __future__ import annotations

import io
from collections.abc import Collection, Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from restshape.errors import UserError

if TYPE_CHECKING:
    import meshio


def has_grid(path: Path) -> bool:
    """Whether a deck has a node."""
    return any(card[0].startswith("GRID") for card in _cards(path))


def constraint_sets(path: Path) -> dict[str, np.ndarray]:
    """Nodes, as rows of the GRID cards, of each SPC set, named ``SPC_<set>``.

    Raises:
        UserError: a set names a node that is not there, or a card is torn.
    """
    row_of: dict[int, int] = {}
    found: dict[str, set[int]] = {}
    for card in _cards(path):
        name, words = card[0], card[1:]
        try:
            if name == "GRID":
                row_of[int(words[0])] = len(row_of)
            elif name == "SPC":
                # set, node, components, value, and once more node, components, value
                found.setdefault(f"SPC_{int(words[0])}", set()).update(int(word) for word in words[1:7:3] if word)
            elif name == "SPC1":
                found.setdefault(f"SPC_{int(words[0])}", set()).update(_listed(words[2:], row_of))
        except (ValueError, IndexError, OverflowError):
            raise UserError(f"cannot read the card {' '.join(card)!r}", str(path), "export it again") from None
    lost = [(name, node) for name, nodes in found.items() for node in sorted(nodes) if node not in row_of]
    if lost:
        raise UserError(f"{lost[0][0]} names node {lost[0][1]}, which is not there", str(path), "export it again")
    return {name: np.array(sorted(row_of[node] for node in nodes)) for name, nodes in found.items()}


def _listed(words: list[str], known: Collection[int]) -> list[int]:
    """The numbers of a list in which "a THRU b" stands for all from a to b, as far as they are known."""
    words = [word for word in words if word]
    if len(words) == 3 and words[1].upper() == "THRU":
        wanted = range(int(words[0]), int(words[2]) + 1)
        return list(wanted) if len(wanted) <= len(known) else [number for number in known if number in wanted]
    return [int(word) for word in words]


def read_deck(path: Path) -> meshio.Mesh:
    """What meshio reads from a deck; one without BEGIN BULK, as gmsh writes them, is bulk data from its first line.

    Raises:
        Exception: whatever meshio has to say about it.
    """
    import meshio
    from meshio.nastran._nastran import read_buffer

    if _has_begin(path):
        return meshio.read(path, file_format="nastran")
    return read_buffer(io.StringIO(f"BEGIN BULK\n{path.read_text(encoding='utf-8', errors='replace')}\nENDDATA\n"))


def _has_begin(path: Path) -> bool:
    with path.open(encoding="utf-8", errors="replace") as lines:
        return any(line.strip().upper().startswith("BEGIN BULK") for line in lines)


def _cards(path: Path) -> Iterator[list[str]]:
    """Cards of the bulk data as lists of words, continuations joined, in free, small and large fields."""
    card: list[str] = []
    begun = not _has_begin(path)
    with path.open(encoding="utf-8", errors="replace") as lines:
        for raw in lines:
            line = raw.split("$")[0].rstrip().expandtabs(8)
            if not begun:
                begun = line.strip().upper().startswith("BEGIN BULK")
                continue
            if not line or line.upper().startswith("ENDDATA"):
                continue
            words = _fields(line)
            if words[0] == "" or words[0][0] in "+*":
                card += words[1:]
                continue
            if card:
                yield card
            card = [words[0].rstrip("*").upper(), *words[1:]]
    if card:
        yield card


def _fields(line: str) -> list[str]:
    """Words of a line, the name first; the mark of a continuation at its end is left out."""
    if "," in line:
        return [word.strip() for word in line.split(",")[:9]]
    width = 16 if "*" in line[:8] else 8
    return [line[:8].strip(), *(line[i : i + width].strip() for i in range(8, min(len(line), 72), width))]
