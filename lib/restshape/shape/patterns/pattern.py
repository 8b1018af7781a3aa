"""Sewing patterns: pieces of cloth, where they begin in space, and which of their edges are sewn together.

What readers of pattern files give and their writers take, whatever the format.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from pydantic import ValidationError

from restshape.errors import UserError
from restshape.scene.model import ShapeSpec
from restshape.scene.plain_values import Table, table_in
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class PatternPiece:
    """A piece of a pattern.

    Args:
        name: unique among the pieces.
        shape: the plain tables of a ``[shape]``, in metres.
        move: displacement in space [m], after it is turned.
        turn: angles [rad] about x, then y, then z of space, through its own origin.
        grain: angle [rad] of the grain from its own x axis; None: not given.
        kept: what its file has besides, by the file's own keys; kept_edges: the same of its edges, by their names.
        file_name: that it has in its file, where that cannot be its own; "": its name.
    """

    name: str
    shape: Table
    move: Triple = (0.0, 0.0, 0.0)
    turn: Triple = (0.0, 0.0, 0.0)
    grain: float | None = None
    kept: Table = field(default_factory=dict)
    kept_edges: dict[str, Table] = field(default_factory=dict)
    file_name: str = ""

    def outline(self) -> Outline:
        """Its outline, in one piece and valid.

        Raises:
            UserError: its edges cross, touch or are no loop.
        """
        try:
            return outline_from_spec(ShapeSpec.model_validate(self.shape))
        except UserError as error:
            raise UserError(error.what, f"piece {self.name}", error.do) from None
        except ValidationError as error:
            first = error.errors()[0]
            raise UserError(str(first["msg"]), f"piece {self.name}", "mend it in the file") from None


@dataclass(frozen=True)
class Stitch:
    """Two lines of edges that are sewn together, each in its order.

    Args:
        first, second: names of edges, ``PIECE.EDGE``.
        kept: what its file says besides of its two sides.
        keys: those of a seam of a scene besides its sides, with values in SI units.
        name: of the seam; "": it has none.
    """

    first: tuple[str, ...]
    second: tuple[str, ...]
    kept: tuple[Table, Table] = ({}, {})
    keys: Table = field(default_factory=dict)
    name: str = ""


@dataclass(frozen=True)
class Pattern:
    """A whole pattern.

    Args:
        pieces: with names of their own.
        stitches: between edges of them.
        up: the axis of space that goes up, "y" or "z".
        kept: what its file has besides, by the file's own keys.
        notes: what of the file was not understood, counted and named.
        doubt: what the file does not say of its unit, and what is taken; "": it says its unit.
    """

    pieces: tuple[PatternPiece, ...]
    stitches: tuple[Stitch, ...] = ()
    up: str = "z"
    kept: Table = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    doubt: str = ""

    def piece(self, name: str) -> PatternPiece:
        """The piece of a name that is there."""
        return next(piece for piece in self.pieces if piece.name == name)


def refuse_bad_stitches(pattern: Pattern, where: str) -> None:
    """Refuses stitches of an edge that is not there, of one with itself, and two of one edge.

    Raises:
        UserError: the first of them.
    """
    there = edge_names(pattern.pieces)
    seen: dict[str, int] = {}
    for number, stitch in enumerate(pattern.stitches):
        for edge in (*stitch.first, *stitch.second):
            if edge not in there:
                raise UserError(f"stitch {number} is of the edge {edge}, which is not there", where, "mend the stitch")
            if seen.get(edge) == number:
                raise UserError(f"stitch {number} sews the edge {edge} to itself", where, "name two edges")
            if edge in seen:
                what = f"stitches {seen[edge]} and {number} are both of the edge {edge}"
                raise UserError(what, where, "cut the edge in two, or take out one of them")
            seen[edge] = number


def edge_names(pieces: Iterable[PatternPiece]) -> set[str]:
    """Names of all edges of pieces, ``PIECE.EDGE``."""
    return {f"{piece.name}.{edge}" for piece in pieces for edge in table_in(piece.shape, "edges")}
