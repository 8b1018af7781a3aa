"""Ends of planks that nothing holds, and what they missed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture import _kernels
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


def free_ends(piece: Piece, planks: Iterable[int] | None = None) -> tuple[FreeEnd, ...]:
    """The free ends along the longer sides of planks that come short of a face, pass it, or pass beside it.

    Args:
        piece: whose joints and feet are known.
        planks: that are looked at; None: all.
    """
    parts = zip(*((plank.centre, plank.axes, plank.size) for plank in piece.planks))
    centre, axes, size = (np.array(one) for one in parts)
    return free_ends_at(piece, centre, axes, size, planks)


def free_ends_at(
    piece: Piece, centre: np.ndarray, axes: np.ndarray, size: np.ndarray, planks: Iterable[int] | None = None
) -> tuple[FreeEnd, ...]:
    """The same of a piece whose planks lie elsewhere.

    Args:
        piece: whose joints and feet are known.
        centre, axes, size: (n, 3), (n, 3, 3), (n, 3) of the planks.
        planks: that are looked at; None: all.
    """
    looked = range(len(piece.planks)) if planks is None else planks
    joints = [number for joint in piece.joints for number in (joint.i, joint.side, joint.j)]
    feet = [number for foot in piece.feet for number in (foot.plank, foot.side)]
    floor, near = piece.planes[0], (piece.reach, FAR, ASIDE, BEYOND, FLUSH, EDGE, LEAST_SLANT)
    found = _kernels.free_ends(
        centre,
        axes,
        size,
        np.array(joints, np.int32),
        np.array(feet, np.int32),
        (*floor.point, *floor.normal),
        near,
        list(looked),
    )
    return tuple(FreeEnd(*one) for one in found)


def _taken(piece: Piece) -> set[tuple[int, int]]:
    """Planks and sides that are joined to a face, or stand on the floor."""
    return {(joint.i, joint.side) for joint in piece.joints} | {(foot.plank, foot.side) for foot in piece.feet}


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
