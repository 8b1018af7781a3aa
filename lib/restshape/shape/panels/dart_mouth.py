"""Where a dart opens at an edge: its tip, and the ends of its legs, which are of one length."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.dart_keys import END, PlacedDart
from restshape.shape.outline import Entity, Outline
from restshape.shape.topology_edits import nearest

SAMPLES = 257
"""Places of a curve between which lengths along it, and where a leg meets it, are sought."""
TURNS = 60
"""Halvings of a bracket, after which it is a rounding error wide, and steps to the angle of the legs at most."""


@dataclass(frozen=True, eq=False)
class Mouth:
    """The corners of a dart on an edge [m].

    Args:
        tip, left, right: (2,) each, left and right seen from the mouth.
        meets: (2, 2) where the left and the right leg meet the edges before those are moved.
        edges: those on its left and on its right, the same one unless it is at a corner; names: which the scene gives
            them.
    """

    tip: Reals
    left: Reals
    right: Reals
    meets: Reals
    edges: tuple[int, int]
    names: tuple[str, str]


@dataclass(frozen=True, eq=False)
class _Side:
    """What is beside a dart: the part of an edge from a parameter to one of its ends."""

    outline: Outline
    edge: int
    start: float
    end: float

    @cached_property
    def params(self) -> Reals:
        """Places (m,) on it, from the dart outwards."""
        inner = np.linspace(self.start, self.end, SAMPLES)
        knots = [
            k for k in self.outline.edges[self.edge].knots if min(self.start, self.end) < k < max(self.start, self.end)
        ]
        both = np.union1d(inner, knots)
        return both if self.end > self.start else both[::-1]

    @cached_property
    def points(self) -> Reals:
        """Their places (m, 2) [m]."""
        return self.outline.point(self.edge, self.params)

    @cached_property
    def lengths(self) -> Reals:
        """Lengths (m,) along it to them [m]: by chords, of which lines and arcs have equal ones."""
        return np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(self.points, axis=0).T))])

    @property
    def room(self) -> float:
        """Its length [m]."""
        return float(self.lengths[-1])

    @property
    def last(self) -> Reals:
        """Its far end (2,) [m]."""
        return self.points[-1]

    @property
    def way(self) -> Reals:
        """The direction (2,) of it at the dart, outwards."""
        return self.outline.tangent(self.edge, self.start)[0] * np.sign(self.end - self.start)

    def meets(self, tip: Reals, way: Reals) -> Reals | None:
        """The first place (2,), from the dart outwards, where a ray from the tip meets it; None where none does."""

        def off(points: Reals) -> Reals:
            return np.asarray(way[0] * (points[..., 1] - tip[1]) - way[1] * (points[..., 0] - tip[0]))

        sides = off(self.points)
        change = np.flatnonzero(np.sign(sides[1:]) != np.sign(sides[0]))
        if not len(change):
            return None
        k = int(change[0])
        if self.outline.edges[self.edge].kind == "line":
            a, b = self.points[0], self.points[-1]
            share = sides[0] / (sides[0] - sides[-1])
            return np.asarray(a + share * (b - a)) if 0.0 <= share <= 1.0 else None
        low, high = self.params[k], self.params[k + 1]
        for _ in range(TURNS):
            middle = 0.5 * (low + high)
            same = np.sign(off(self.outline.point(self.edge, middle)[0])) == np.sign(sides[0])
            low, high = (middle, high) if same else (low, middle)
        return self.outline.point(self.edge, 0.5 * (low + high))[0]


def mouth_of(outline: Outline, placed: PlacedDart) -> Mouth:
    """The corners of a dart on an edge.

    Raises:
        UserError: the edge has no such place, or is too short for it.
    """
    assert placed.edge is not None, "a dart inside has no mouth"
    entity = outline.entity(placed.edge)
    edge, s = _place(outline, entity, placed)
    centre, inward, forward = normal_at(outline, edge, s)
    if placed.line is not None:
        away = np.array(placed.line[1]) - centre
        if np.hypot(*away) <= END * outline.size:
            what = f"the dart's tip is its place on the edge {placed.edge!r}"
            raise UserError(what, f"{placed.where}.line", "its second point is the tip, inside the panel")
        length = placed.dart.length or float(np.hypot(*away))
        way = away / np.hypot(*away)
    else:
        assert placed.dart.length is not None, "without a line there is a length"
        c, sin = np.cos(placed.angle), np.sin(placed.angle)
        way, length = np.array([[c, -sin], [sin, c]]) @ inward, placed.dart.length
    sides, own = _sides(outline, edge, s, forward)
    if placed.fold:
        ends = ends_of(outline, placed.fold)
        far = ends[int(np.hypot(*(ends - centre).T).argmax())]
        way = (far - centre) / np.hypot(*(far - centre))
    _refuse_outwards(placed, way, sides)
    return _opened(placed, centre, way, length, sides, own)


def _refuse_outwards(placed: PlacedDart, way: Reals, sides: tuple[_Side, _Side]) -> None:
    """Refuses a dart that does not go into the cloth, which lies between both sides of its place."""
    left, right = (side.way for side in sides)

    def turn(to: Reals) -> float:
        """The angle from the right side, counter-clockwise [rad]."""
        angle = float(np.arctan2(right[0] * to[1] - right[1] * to[0], right @ to))
        return angle if angle > 0.0 else angle + 2.0 * np.pi

    if END < turn(way) < turn(left) - END:
        return
    if placed.line is not None:
        what = f"the dart's tip lies outside the cloth at the edge {placed.edge!r}"
        raise UserError(what, f"{placed.where}.line", "its second point is the tip, inside the panel")
    what = f"the dart's angle turns it out of the cloth at the edge {placed.edge!r}"
    raise UserError(what, f"{placed.where}.angle", "turn it back: its angle is from the edge's normal into the cloth")


def ends_of(outline: Outline, name: str) -> Reals:
    """The ends (k, 2) of all pieces of an edge [m]."""
    return np.asarray(outline.points[outline.layout.ends[list(outline.entity(name).edges)].ravel()])


def _opened(
    placed: PlacedDart, centre: Reals, way: Reals, length: float, sides: tuple[_Side, _Side], own: int | None
) -> Mouth:
    """The mouth about a place on an edge, for a dart that goes that way; `own` is the side that its edge is on."""
    tip, normal, width = centre + length * way, np.array([-way[1], way[0]]), placed.dart.width

    def reach(angle: float) -> tuple[float, Reals, Reals]:
        """The length of the legs, their directions (2, 2), and where they meet the edges (2, 2)."""
        c, s = np.cos(angle), np.sin(angle)
        ways = np.array([-c * way + s * normal, -c * way - s * normal])
        meets = [side.meets(tip, ray) for side, ray in zip(sides, ways)]
        if meets[0] is None or meets[1] is None:
            raise UserError(_too_wide(placed, sides), f"{placed.where}.width", "make it narrower, move it or turn it")
        places = np.array(meets)
        if placed.dart.mouth == "straight":
            return _straight(placed, tip, way, angle, sides), ways, places
        lengths = np.hypot(*(places - tip).T)
        return float(lengths.mean() if own is None else lengths[own]), ways, places

    angle = float(np.arctan2(0.5 * width, length))
    for _ in range(TURNS):
        legs, ways, places = reach(angle)
        # The length of the legs hangs on the angle weakly: it is settled by their own sine.
        step = 0.5 * width / legs
        if step >= 1.0:
            raise UserError(_too_wide(placed, sides), f"{placed.where}.width", "make it narrower, or longer")
        before, angle = angle, float(np.arctan2(step, np.sqrt(1.0 - step * step)))
        if abs(angle - before) <= 4.0 * np.finfo(float).eps * angle:
            break
    legs, ways, places = reach(angle)
    left, right = tip + legs * ways
    first, second = (side.edge for side in sides)
    parents = tuple(side.outline.edges[side.edge].parent for side in sides)
    return Mouth(tip, left, right, places, (first, second), (parents[0], parents[1]))


def _too_wide(placed: PlacedDart, sides: tuple[_Side, _Side]) -> str:
    room = [1e3 * side.room for side in sides]
    names = [side.outline.edges[side.edge].name for side in sides]
    there = f"{room[0]:.3g} mm of {names[0]!r} on its left and {room[1]:.3g} mm of {names[1]!r} on its right"
    return f"the dart is {1e3 * placed.dart.width:.3g} mm wide, and there are {there}"


def _straight(placed: PlacedDart, tip: Reals, way: Reals, angle: float, sides: tuple[_Side, _Side]) -> float:
    """The length of legs that are sewn with both parts of the edge in one straight line.

    Sewing turns what is on the left by the angle, and what is on the right back by it. The line between the far ends
    meets the dart's line where the legs end.
    """
    if bent := next((side for side in sides if side.outline.edges[side.edge].kind != "line"), None):
        what = f"the edge {bent.outline.edges[bent.edge].name!r} is no straight line, and is to be one at the dart"
        raise UserError(what, f"{placed.where}.mouth", 'leave `mouth` out, which is "kept" then')
    ends = []
    for side, turn in zip(sides, (angle, -angle)):
        c, s = np.cos(turn), np.sin(turn)
        ends.append(np.array([[c, -s], [s, c]]) @ (side.last - tip))
    a, along = ends[0], ends[1] - ends[0]
    # tip - r way lies on the line through both.
    across = float(along[0] * way[1] - along[1] * way[0])
    legs = float(a[0] * along[1] - a[1] * along[0]) / across if across else 0.0
    if legs <= 0.0:
        what = "the dart's mouth cannot be straight: the line between the edges' far ends lies beyond its tip"
        raise UserError(
            what, f"{placed.where}.mouth", 'leave `mouth` out, which is "kept" then, or make the dart longer'
        )
    return legs


def _place(outline: Outline, entity: Entity, placed: PlacedDart) -> tuple[int, float]:
    """The edge, and the parameter on it, where the middle of a mouth is."""
    if placed.line is not None:
        return nearest(outline, entity, np.array(placed.line[0]))
    assert placed.at is not None, "without a line there is a place"
    edge, s = place_along(outline, entity, placed.at * length_along(outline, entity))
    if edge is None:
        what = f"another dart is at that place of the edge {placed.edge!r}"
        raise UserError(what, f"{placed.where}.at", "move one of them along the edge")
    return edge, s


def length_along(outline: Outline, entity: Entity) -> float:
    """The length [m] of an edge, mouths of darts counted."""
    return _along(outline, entity)[2]


def place_along(outline: Outline, entity: Entity, wanted: float) -> tuple[int | None, float]:
    """The edge, or piece of one, and the parameter on it at a length [m] along it; None in the mouth of a dart."""
    pieces, begins, _ = _along(outline, entity)
    k = max(int(np.searchsorted(begins, wanted, side="right")) - 1, 0)
    piece, along = pieces[k], wanted - begins[k]
    if along > piece.room * (1.0 + END):
        return None, 0.0
    return piece.edge, float(np.interp(along, piece.lengths, piece.params))


def share_at(outline: Outline, entity: Entity, edge: int, s: float) -> float:
    """The share of the length of an edge, mouths of darts counted, at a parameter of it or of one of its pieces."""
    pieces, begins, total = _along(outline, entity)
    k = [piece.edge for piece in pieces].index(edge)
    return min((begins[k] + float(np.interp(s, pieces[k].params, pieces[k].lengths))) / total, 1.0)


def _along(outline: Outline, entity: Entity) -> tuple[list[_Side], list[float], float]:
    """The pieces of an edge, how far from its start each begins, and where the last one ends [m].

    Between two pieces lies the mouth of a dart.
    """
    pieces = [_Side(outline, e, 0.0, 1.0) for e in entity.edges]
    begins, total = [], 0.0
    for k, piece in enumerate(pieces):
        total += 0.0 if k == 0 else float(np.hypot(*(piece.points[0] - pieces[k - 1].points[-1])))
        begins.append(total)
        total += piece.room
    return pieces, begins, total


def normal_at(outline: Outline, edge: int, s: float) -> tuple[Reals, Reals, bool]:
    """A place (2,) of an edge, its normal (2,) into the cloth there, and whether the cloth is on the edge's left."""
    forward = next(f for loop in outline.loops if loop.kind != "region" for e, f in loop.edges if e == edge)
    tangent = outline.tangent(edge, s)[0] * (1.0 if forward else -1.0)
    return outline.point(edge, s)[0], np.array([-tangent[1], tangent[0]]) / np.hypot(*tangent), forward


def _sides(outline: Outline, edge: int, s: float, forward: bool) -> tuple[tuple[_Side, _Side], int | None]:
    """What is left and right of a place, seen into the cloth, and the side that the edge itself is on at a corner."""
    low, high = s <= END, s >= 1.0 - END
    if not (low or high):
        first, second = _Side(outline, edge, s, 0.0), _Side(outline, edge, s, 1.0)
        return ((first, second) if forward else (second, first)), None
    before = low == forward
    """The edge begins at the corner, in the loop's direction: its neighbour is the one before it."""
    beside, its_way = _neighbour(outline, edge, before)
    own = _Side(outline, edge, 0.0, 1.0) if low else _Side(outline, edge, 1.0, 0.0)
    other = _Side(outline, beside, 1.0, 0.0) if its_way == before else _Side(outline, beside, 0.0, 1.0)
    return ((other, own), 1) if before else ((own, other), 0)


def _neighbour(outline: Outline, edge: int, before: bool) -> tuple[int, bool]:
    """The edge before or after another one around its loop, and whether it is traversed forwards."""
    chain = next(loop.edges for loop in outline.loops if loop.kind != "region" and edge in [e for e, _ in loop.edges])
    k = [e for e, _ in chain].index(edge)
    return chain[(k + (-1 if before else 1)) % len(chain)]
