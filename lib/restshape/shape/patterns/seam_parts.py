"""Which edges of a pattern are sewn together, edge by edge, as drawings keep it."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

from restshape.errors import printable, quoted
from restshape.scene.plain_values import Table
from restshape.shape.patterns.pattern import Pattern, Stitch

SIDES = ("from", "to")
COLOURS = (
    "#1f77b4", "#d62728", "#2ca02c", "#9467bd", "#ff7f0e", "#17becf", "#e377c2", "#8c564b", "#bcbd22", "#003f5c",
)  # fmt: skip
"""Of seams in their order, from the first again after the last."""


class SeamPart(NamedTuple):
    """What an edge is in a seam: the seam's name, a side of `SIDES`, and the edge's place in that side's order."""

    seam: str
    side: str
    place: int


def seam_names(pattern: Pattern) -> tuple[str, ...]:
    """A name for each stitch of a pattern: its own, else ``seam1``, ``seam2``, ... by its place."""
    taken = {stitch.name for stitch in pattern.stitches}
    found = []
    for number, stitch in enumerate(pattern.stitches, 1):
        name = stitch.name or f"seam{number}"
        while not stitch.name and name in taken:
            name += "_"
        taken.add(name)
        found.append(name)
    return tuple(found)


def seam_colours(names: Sequence[str]) -> dict[str, str]:
    """The colour of each seam, by its name."""
    return {name: COLOURS[k % len(COLOURS)] for k, name in enumerate(names)}


def seam_parts(pattern: Pattern) -> dict[str, list[SeamPart]]:
    """What each edge that is sewn, ``PIECE.EDGE``, is in its seams."""
    found: dict[str, list[SeamPart]] = {}
    for name, stitch in zip(seam_names(pattern), pattern.stitches):
        for side, edges in zip(SIDES, (stitch.first, stitch.second)):
            for place, edge in enumerate(edges):
                found.setdefault(edge, []).append(SeamPart(name, side, place))
    return found


def stitches_of(
    parts: Sequence[tuple[str, SeamPart]], keys: Mapping[str, Table], there: Collection[str]
) -> tuple[tuple[Stitch, ...], list[str]]:
    """The stitches that a drawing keeps, and what of them was not read, for notes.

    Args:
        parts: edges ``PIECE.EDGE`` with what each is; keys: of seams by name; there: all edges of the pattern.
    """
    sides: dict[str, dict[str, dict[int, str]]] = {}
    for edge, part in parts:
        sides.setdefault(part.seam, {}).setdefault(part.side, {})[part.place] = edge
    found, left = [], []
    for name, own in sides.items():
        first, second = (tuple(edge for _, edge in sorted(own.get(side, {}).items())) for side in SIDES)
        gone = [edge for edge in (*first, *second) if edge not in there]
        short = next((side for side, edges in zip(SIDES, (first, second)) if not edges), None)
        if gone or short:
            why = f"whose edge {gone[0]} is not there" if gone else f"which has no edges on its side {short!r}"
            left.append(f"the seam {quoted(printable(name))}, {why}")
        else:
            found.append(Stitch(first, second, keys=keys.get(name, {}), name=name))
    return tuple(found), left
