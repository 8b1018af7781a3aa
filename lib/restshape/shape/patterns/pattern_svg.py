"""Sewing patterns from SVG drawings."""

from __future__ import annotations

from collections import Counter
from pathlib import Path

from restshape.errors import UserError
from restshape.outputs.kinds import EXPORT_MARK
from restshape.scene.plain_values import Table, table_in
from restshape.shape.drawings.svg import read_svg
from restshape.shape.drawings.svg_tree import metadata_of, not_drawn
from restshape.shape.patterns.pattern import Pattern, edge_names
from restshape.shape.patterns.pattern_drawing import unread_notes
from restshape.shape.patterns.pattern_notes import METADATA, in_own_axes, placed_by, table_of
from restshape.shape.patterns.pattern_pieces import loops_of, pieces_of
from restshape.shape.patterns.seam_parts import SIDES, SeamPart, stitches_of

HEAD = 1000
"""Bytes at the beginning of a drawing, where it says which program has written it."""


def read_pattern_svg(path: Path) -> Pattern:
    """The pattern of an SVG drawing: each outermost loop is a piece, with the name of its group.

    Loops inside it are holes, or regions by their class or name; edges have the ids of their paths.

    Raises:
        UserError: unreadable, or no piece.
    """
    read = read_svg(path, {})
    loops = loops_of(read.curves)
    if not loops.groups:
        raise UserError("no piece was found: no curves close a loop", path.name, "let the curves meet end to end")
    found, _ = pieces_of(loops, (), path.name, {}, ())
    unread = Counter(f"{curve.source} that closes no loop" for curve in loops.open)
    data = path.read_bytes()
    said = metadata_of(data, METADATA)
    if loops.open and not said and EXPORT_MARK.encode() in data[:HEAD]:
        what = f"{len(loops.open)} edges close no loop in this drawing, which `restshape export` made of a whole shape"
        raise UserError(what, path.name, "restshape pattern SCENE --out FILE.svg writes its panels as pieces")
    unread += Counter(f"<{tag}>" for tag in not_drawn(data))
    about, seams = (table_in(table_of(said), key) for key in ("pieces", "seams"))
    tables = [table_in(about, piece.name) for piece in found]
    pieces = [placed_by(in_own_axes(piece, table), table) for piece, table in zip(found, tables)]
    parts = [(edge, part) for name in seams for edge, part in _sewn(name, table_in(seams, name))]
    keys = {name: table_in(table_in(seams, name), "keys") for name in seams}
    stitches, left = stitches_of(parts, keys, edge_names(pieces))
    return Pattern(tuple(pieces), stitches, notes=unread_notes(unread + Counter(left)), doubt=read.doubt)


def _sewn(seam: str, table: Table) -> list[tuple[str, SeamPart]]:
    """The edges of a seam as the metadata of a drawing has them, with what each is in it."""
    found = []
    for side in SIDES:
        edges = table.get(side)
        names = [edge for edge in edges if isinstance(edge, str)] if isinstance(edges, list) else []
        found += [(edge, SeamPart(seam, side, place)) for place, edge in enumerate(names)]
    return found
