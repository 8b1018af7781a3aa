"""Darts in outlines: where their corners are, and how they are cut out or kept as regions.

A dart on an edge has its tip T at the given length from the edge, and legs of one length r on both sides of its line,
at an angle a from it. Its width is 2 r sin a. Where the edge is straight and at a right angle to the dart, or a circle
about T, the legs end on the edge. Elsewhere r is the mean of the distances at which both legs meet it, or, at a corner,
that of the edge that the dart names: what is left of the edge is moved to the ends of the legs. With ``mouth =
"straight"`` r is that at which both parts of the edge become one straight line as the dart is sewn.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.dart_keys import IMAGE, PlacedDart
from restshape.shape.chain_crossings import crossings
from restshape.shape.outline import CHORD_ERROR, Outline
from restshape.shape.panels.dart_cut import cut_dart
from restshape.shape.panels.dart_mouth import Mouth, mouth_of
from restshape.shape.place_words import place_words


@dataclass(frozen=True, eq=False)
class DartCorners:
    """Where a dart's corners are [m].

    Args:
        placed: the dart.
        tip, left, right: (2,) each.
        foot: (2,) the other tip of one inside; None: it opens at an edge.
        mouth: of one on an edge.
    """

    placed: PlacedDart
    tip: Reals
    left: Reals
    right: Reals
    foot: Reals | None = None
    mouth: Mouth | None = None

    @property
    def legs(self) -> list[tuple[Reals, Reals]]:
        """The ends of its straight sides."""
        ends = [self.left, self.tip, self.right, *([] if self.foot is None else [self.foot, self.left])]
        return list(pairwise(ends))


def with_darts(outline: Outline, darts: Sequence[PlacedDart]) -> Outline:
    """The outline with darts, placed on it as it is before any of them.

    Raises:
        UserError: a dart is wider or longer than there is cloth, or two meet.
    """
    corners = [corners_of(outline, dart) for dart in darts]
    for one in corners:
        _refuse_beyond(outline, one)
    _refuse_meeting(corners)
    for one in corners:
        outline = cut_dart(outline, one.placed, one.tip, one.left, one.right, one.foot, one.mouth)
    return outline


def corners_of(outline: Outline, placed: PlacedDart) -> DartCorners:
    """Where the corners of a dart are.

    Raises:
        UserError: it is wider than the edge on one side of it.
    """
    if placed.edge is not None:
        mouth = mouth_of(outline, placed)
        return DartCorners(placed, mouth.tip, mouth.left, mouth.right, mouth=mouth)
    assert placed.line is not None, "a dart inside has a line"
    foot, tip = (np.array(point) for point in placed.line)
    along = tip - foot
    across = 0.5 * placed.dart.width * np.array([-along[1], along[0]]) / np.hypot(*along)
    widest = foot + placed.dart.widest * along
    return DartCorners(placed, tip, widest + across, widest - across, foot)


def _refuse_beyond(outline: Outline, one: DartCorners) -> None:
    """Refuses a dart that reaches over an edge of its panel; panels that overlap are told as such later."""
    own = set() if one.mouth is None else set(one.mouth.edges)
    own |= {e for e, k in enumerate(outline.layout.edge_piece.tolist()) if not _of_piece(one, outline.piece_names[k])}
    fold = outline.entity(one.placed.fold).edges if one.placed.fold else ()
    bounding = {e for loop in outline.loops if loop.kind != "region" for e, _ in loop.edges}
    halves = {e for loop in outline.loops if loop.name.endswith(f".{IMAGE}") for e, _ in loop.edges} - bounding
    for e, edge in enumerate(outline.edges):
        if e in own or e in fold:
            continue
        chain = outline.polyline(e, CHORD_ERROR * outline.size)
        for a, b in one.legs:
            place = next(crossings(a, b, chain), None)
            if place is None:
                continue
            x, y = place
            reaches = f"the dart reaches over the edge {edge.name!r} near {place_words(outline, x, y, e)}"
            raise UserError(reaches, one.placed.where, _inward(one, e in halves))


def _of_piece(one: DartCorners, piece: str) -> bool:
    """Whether a dart may lie in a piece, as far as its name says."""
    return "." not in one.placed.name or one.placed.name.startswith(f"{piece}.")


def _inward(one: DartCorners, at_fold: bool) -> str:
    """What to do about a dart that leaves its panel."""
    if one.mouth is not None:
        return "make it shorter or narrower, or turn it"
    if at_fold:
        return "put its line on the fold, or move it away from that"
    return "make it shorter or narrower, or give it the `edge` that it is to open at"


def _refuse_meeting(corners: Sequence[DartCorners]) -> None:
    """Refuses two darts that cross, touch, or lie in each other."""
    for i, one in enumerate(corners):
        for other in corners[:i]:
            place = _meeting(one, other)
            if place is not None:
                names = f"{other.placed.name!r} and {one.placed.name!r}"
                what = f"the darts {names} meet near ({place[0]:.4g}, {place[1]:.4g}) m"
                raise UserError(what, one.placed.where, "move one of them, or make it narrower or shorter")


def _meeting(one: DartCorners, other: DartCorners) -> tuple[float, float] | None:
    """A place where two darts meet."""
    for a, b in one.legs:
        for c, d in other.legs:
            if (place := next(crossings(a, b, np.array([c, d])), None)) is not None:
                return place
    for inner, around in ((one, other), (other, one)):
        ring = [around.left, around.tip, around.right, *([] if around.foot is None else [around.foot])]
        sides = [np.cross(q - p, inner.tip - p) for p, q in zip(ring, [*ring[1:], ring[0]])]
        if min(sides) > 0.0 or max(sides) < 0.0:
            return float(inner.tip[0]), float(inner.tip[1])
    return None


def dart_named(darts: Sequence[PlacedDart], outline: Outline, sentence: str) -> PlacedDart | None:
    """The dart one of whose parts a sentence names, or, but for panels that meet, a piece of an edge at its mouth."""
    words = set(sentence.replace(",", " ").split())
    beside = {
        name
        for edge in outline.edges
        if edge.name in words and not sentence.startswith("panel")
        for name in (outline.vertex_names[edge.start], outline.vertex_names[edge.end])
    }

    def names(dart: PlacedDart) -> bool:
        loop = any(sentence.startswith(f"{kind} {dart.name} ") for kind in ("hole", "loop"))
        return loop or any(word.startswith(f"{dart.name}.") for word in words | beside)

    return next((dart for dart in darts if names(dart)), None)
