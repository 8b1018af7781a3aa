"""Ends of planks that nothing holds, and what they missed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture.shape.directions import room_words
from restshape_apps.furniture.shape.plank_edits import connected
from restshape_apps.furniture.shape.planks import EDGE, FLUSH, LEAST_SLANT, SIDES, Piece, Plank

FAR = 0.25
"""How far before an end what it may have missed is looked for [m]; half of its plank's length where that is less."""
ASIDE = 0.03
"""How far beside a face an end may pass that may have missed it [m]."""
BEYOND = 0.06
"""How far in or behind a face an end may be that was drawn into it or past it [m]; through its plank or the floor,
`FAR`."""


@dataclass(frozen=True)
class FreeEnd:
    """An end `side` (0 to 3) of a plank that nothing holds, before plank `other` (-1: the floor).

    Args:
        gap: how far along the plank's line the face is [m]; negative behind it.
        aside: how far the centre line of the end passes beside the face [m].
        tilted: the end's edge does not lie along the face.
        way: (3,) how the plank goes sideways for all of the end to lie on the face [m]; nought where it is not beside.
        edge: it meets an edge of the other plank, as thick as that is, which takes no joint.
    """

    plank: int
    side: int
    other: int
    gap: float
    aside: float
    tilted: bool
    way: tuple[float, float, float] = (0.0, 0.0, 0.0)
    edge: bool = False

    @property
    def passes(self) -> bool:
        """Whether it passes beside what it missed, if only by nothing."""
        return any(self.way)

    @property
    def beside(self) -> str:
        """On which side of what it missed it passes, in axes of the room."""
        return room_words(-np.array(self.way) / np.linalg.norm(self.way))

    def missed(self, piece: Piece) -> str:
        """Which end, what it missed, by how much and on which side."""
        other = "the floor" if self.other < 0 else piece.planks[self.other].name
        parts = []
        if self.edge:
            place = f"{self.near_words} the edge of {other}"
            return f"{piece.planks[self.plank].name} {SIDES[self.side]} is free: {place}, which takes no joint"
        if self.passes:
            parts.append(f"its centre line passes {1e3 * self.aside:.4g} mm beside {other}, on its {self.beside} side")
        if self.gap > piece.reach:
            parts.append(f"{1e3 * self.gap:.4g} mm from {other} (joints reach {1e3 * piece.reach:.4g} mm)")
        elif self.gap < -piece.reach:
            behind = "below" if self.other < 0 else "beyond the face of"
            parts.append(f"{-1e3 * self.gap:.4g} mm {behind} {other}")
        if self.tilted:
            parts.append(f"its edge does not lie along {other}")
        if not parts:
            parts = [
                f"{self.near_words} {other}, not joined" if self.joins(piece) else f"near {other}, which cannot hold it"
            ]
        return f"{piece.planks[self.plank].name} {SIDES[self.side]} is free: {', '.join(parts)}"

    @property
    def near_words(self) -> str:
        """How near an end is that joints reach."""
        return "touches" if abs(self.gap) <= FLUSH else f"{1e3 * abs(self.gap):.4g} mm from"

    def joins(self, piece: Piece) -> bool:
        """Whether it is joined where it is once its plank is connected."""
        made = connected(piece, self.plank, piece.reach)
        return (self.plank, self.side) in _taken(made)

    def sunk(self, piece: Piece) -> bool:
        """Whether it is below the floor, so that its plank overlaps it."""
        return self.other < 0 and self.gap < -piece.reach

    def words(self, piece: Piece) -> str:
        """What `missed` says, and what to do."""
        name, do = piece.planks[self.plank].name, []
        if self.edge:
            return f"{self.missed(piece)}; {to_a_face(name, piece.planks[self.other].name)}"
        if self.passes:
            size = float(np.linalg.norm(self.way))
            do.append(f"move {name} {1e3 * size:.4g} mm along {room_words(np.array(self.way) / size)}")
        if abs(self.gap) > piece.reach:
            longer = "longer" if self.gap > 0.0 else "shorter"
            do.append(f"make {name} {1e3 * abs(self.gap):.4g} mm {longer} at {SIDES[self.side]}")
        if self.tilted:
            do.append(f"turn {name}")
        if not do and self.joins(piece):
            do.append(f"connect {name}")
        return self.missed(piece) + (f"; {' and '.join(do)}" if do else "")


def to_a_face(name: str, other: str) -> str:
    """What to do about a plank whose end is at the edge of another one."""
    return f"let {name} meet a broad face, or turn {other}"


Boxes = tuple[np.ndarray, np.ndarray, np.ndarray]
"""Middles (n, 3), axes (n, 3, 3) and sizes (n, 3) of planks."""


def free_ends(piece: Piece, planks: Iterable[int] | None = None) -> tuple[FreeEnd, ...]:
    """The free ends along the longer sides of planks that come short of a face, pass it, or pass beside it.

    Args:
        piece: whose joints and feet are known.
        planks: that are looked at; None: all.
    """
    taken = _taken(piece)
    found, centres = [], np.array([plank.centre for plank in piece.planks])
    axes, sizes = np.array([plank.axes for plank in piece.planks]), np.array([plank.size for plank in piece.planks])
    normals, boxes = axes[:, :, 2], (centres, axes, sizes)
    for i in range(len(piece.planks)) if planks is None else planks:
        along = int(np.argmax(piece.planks[i].size[:2]))
        for side in (2 * along, 2 * along + 1):
            if (i, side) in taken:
                continue
            missed = [one for one in _missed(piece, i, side, _ahead(piece, i, side, centres, normals)) if one]
            missed += _at_edges(piece, i, side, boxes)
            if missed:
                found.append(min(missed, key=lambda one: abs(one.gap) + one.aside))
    return tuple(found)


def _taken(piece: Piece) -> set[tuple[int, int]]:
    """Planks and sides that are joined to a face, or stand on the floor."""
    return {(joint.i, joint.side) for joint in piece.joints} | {(foot.plank, foot.side) for foot in piece.feet}


def _missed(piece: Piece, i: int, side: int, others: Iterable[int]) -> list[FreeEnd | None]:
    """What an end may have missed of those planks, and the floor."""
    return [_before(piece, i, side, j) for j in others if j != i] + [_above(piece, i, side)]


def _ahead(piece: Piece, i: int, side: int, centres: np.ndarray, normals: np.ndarray) -> list[int]:
    """The planks that an end looks at from near, by their middles and normals (n, 3): it has not missed others."""
    axis = piece.planks[i].axes[:, side // 2] * (1.0 if side % 2 else -1.0)
    slopes = normals @ axis
    away = np.abs(((centres - piece.planks[i].end(side)) * normals).sum(axis=1))
    reach = np.array([FAR + BEYOND + float(plank.size[2]) for plank in piece.planks])
    return np.flatnonzero((np.abs(slopes) > LEAST_SLANT) & (away <= reach)).tolist()


def _at_edges(piece: Piece, i: int, side: int, boxes: Boxes) -> list[FreeEnd]:
    """The end before edges of planks, no farther than joints reach."""
    one, (centres, axes, sizes) = piece.planks[i], boxes
    axis = one.axes[:, side // 2] * (1.0 if side % 2 else -1.0)
    half = 0.5 * one.size[1 - side // 2] * one.axes[:, 1 - side // 2]
    # Along the axes of each plank (n, 3); k: the one that the end looks along.
    way, along = axis @ axes, half @ axes
    place = ((one.end(side) - centres)[:, None, :] @ axes)[:, 0]
    every, k = np.arange(len(centres)), np.argmax(np.abs(way), axis=1)
    gap = (-np.sign(way[every, k]) * 0.5 * sizes[every, k] - place[every, k]) / way[every, k]
    beside = np.abs(place + gap[:, None] * way) - np.abs(along) - 0.5 * sizes
    most = np.maximum(beside[every, 1 - k], beside[:, 2])
    at = np.flatnonzero((k < 2) & (gap >= -FLUSH) & (gap <= piece.reach) & (most < -FLUSH)).tolist()
    joined = {i} | {k for joint in piece.joints for k in (joint.i, joint.j) if i in (joint.i, joint.j)} if at else {i}
    return [FreeEnd(i, side, j, float(gap[j]), 0.0, False, edge=True) for j in at if j not in joined]


def _before(piece: Piece, i: int, side: int, j: int) -> FreeEnd | None:
    """The end before, in or beside a face of plank j; None where it is far from it."""
    one, other = piece.planks[i], piece.planks[j]
    axis = one.axes[:, side // 2] * (1.0 if side % 2 else -1.0)
    slope = float(axis @ other.axes[:, 2])
    if abs(slope) <= LEAST_SLANT:
        return None
    place, way = other.axes.T @ (one.end(side) - other.centre), other.axes.T @ axis
    gap = float((-np.sign(slope) * 0.5 * other.size[2] - place[2]) / slope)
    most = min(FAR, 0.5 * float(one.size[side // 2]))
    if not -most <= gap <= most:
        return None
    half = np.abs(0.5 * one.size[1 - side // 2] * (other.axes.T @ one.axes[:, 1 - side // 2]))
    place = (place + gap * way)[:2]
    # The line of the end, not its middle alone, may meet the face.
    beside = np.abs(place) - 0.5 * other.size[:2] - half[:2]
    aside = float(np.linalg.norm(np.where(beside > EDGE, beside, 0.0)))
    # What only touches it with a strip, or would take its end from planks that it carries, was not drawn to end there.
    through = beside.max() < -FLUSH and bool(np.all(np.abs(place) <= 0.5 * other.size[:2] + EDGE))
    if gap < -piece.reach and _carries(piece, i, side, gap):
        return None
    # A line that reaches the side of a face does not lie on it.
    passes = bool(aside or np.any((beside > -EDGE) & (half[:2] > EDGE)))
    joined = any({joint.i, joint.j} == {i, j} for joint in piece.joints)
    if aside > ASIDE or joined or not (through or gap >= -min(BEYOND, other.size[2] + piece.reach)):
        return None
    sideways = onto(place, half[:2] + half_thick(one, other), other.size[:2]) if passes else np.zeros(2)
    return FreeEnd(i, side, j, gap, aside, bool(half[2] > piece.reach), tuple((other.axes[:, :2] @ sideways).tolist()))


def _carries(piece: Piece, i: int, side: int, gap: float) -> bool:
    """Whether ends of planks are joined to the part of a plank that it loses with an end `gap` from where it is."""
    one = piece.planks[i]
    axis = one.axes[:, side // 2] * (1.0 if side % 2 else -1.0)
    ends = (piece.planks[joint.i].end(joint.side) for joint in piece.joints if joint.j == i)
    return any(float((end - one.end(side)) @ axis) > gap for end in ends)


def goes_through(one: Plank, other: Plank) -> bool:
    """Whether a plank goes in by one face of another one, with all of its section, and out by the other one."""
    for a in range(2):
        ends = np.array([one.end(2 * a), one.end(2 * a + 1)]) - other.centre
        first, last = (ends @ other.axes).tolist()
        if first[2] * last[2] >= 0.0 or min(abs(first[2]), abs(last[2])) <= 0.5 * other.size[2]:
            continue
        part = first[2] / (first[2] - last[2])
        place = np.abs(np.array(first[:2]) + part * (np.array(last[:2]) - np.array(first[:2])))
        half = 0.5 * one.size[1 - a] * np.abs(other.axes.T @ one.axes[:, 1 - a])[:2] + half_thick(one, other)
        if np.all(place + half <= 0.5 * other.size[:2] + FLUSH):
            return True
    return False


def half_thick(one: Plank, other: Plank) -> np.ndarray:
    """Half of the thickness of a plank along the two axes (2,) of a face of another one [m]."""
    return np.abs(other.axes.T @ one.axes[:, 2])[:2] * 0.5 * one.size[2]


def onto(place: np.ndarray, half: np.ndarray, size: np.ndarray) -> np.ndarray:
    """The shortest way (2,) of an end that is `half` (2,) wide from a place (2,) onto all of a face of a size (2,)."""
    room = np.maximum(0.5 * size - half, 0.0)
    return np.clip(place, -room, room) - place


def _above(piece: Piece, i: int, side: int) -> FreeEnd | None:
    """The end above the floor, as the foot of a leg that is too short; None where it is far from it."""
    plank, floor = piece.planks[i], piece.planes[0]
    normal = np.array(floor.normal)
    slope = -float(plank.axes[:, side // 2] @ normal) * (1.0 if side % 2 else -1.0)
    if slope <= LEAST_SLANT:
        return None
    gap = float((plank.end(side) - np.array(floor.point)) @ normal) / slope
    if abs(gap) > min(FAR, 0.5 * float(plank.size[side // 2])):
        return None
    tilt = 0.5 * float(plank.size[1 - side // 2]) * abs(float(plank.axes[:, 1 - side // 2] @ normal))
    return FreeEnd(i, side, -1, gap, 0.0, tilt > piece.reach)
