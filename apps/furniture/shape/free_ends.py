"""Ends of planks that nothing holds, and what they missed."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture.shape.planks import LEAST_SLANT, SIDES, Piece

FAR = 0.25
"""How far before an end what it may have missed is looked for [m]; half of its plank's length where that is less."""
ASIDE = 0.03
"""How far beside a face an end may pass that may have missed it [m]."""
BEYOND = 0.06
"""How far in or behind a face an end may be that was drawn through it [m]."""


@dataclass(frozen=True)
class FreeEnd:
    """An end `side` (0 to 3) of a plank that nothing holds, before plank `other` (-1: the floor).

    Args:
        gap: how far along the plank's line the face is [m]; negative behind it.
        aside: how far the line passes beside the face [m].
        tilted: the end's edge does not lie along the face.
    """

    plank: int
    side: int
    other: int
    gap: float
    aside: float
    tilted: bool

    def words(self, piece: Piece) -> str:
        """Which end, what it missed, and by how much."""
        name = f"{piece.planks[self.plank].name} {SIDES[self.side]}"
        other = "the floor" if self.other < 0 else piece.planks[self.other].name
        parts = []
        if abs(self.gap) > piece.reach:
            parts.append(f"{1e3 * abs(self.gap):.4g} mm {'from' if self.gap > 0.0 else 'beyond the face of'} {other}")
        if self.aside > 0.0:
            parts.append(f"{1e3 * self.aside:.4g} mm beside {other}")
        if self.tilted:
            parts.append(f"its edge does not lie along {other}")
        parts = parts or [f"near {other}, which cannot hold it"]
        return f"{name} is free: {', '.join(parts)} (joints reach {1e3 * piece.reach:.4g} mm)"


def free_ends(piece: Piece, planks: Iterable[int] | None = None) -> tuple[FreeEnd, ...]:
    """The free ends along the longer sides of planks that come short of a face, pass it, or pass beside it.

    Args:
        piece: whose joints and feet are known.
        planks: that are looked at; None: all.
    """
    taken = {(joint.i, joint.side) for joint in piece.joints} | {(foot.plank, foot.side) for foot in piece.feet}
    found, centres = [], np.array([plank.centre for plank in piece.planks])
    normals = np.array([plank.axes[:, 2] for plank in piece.planks])
    for i in range(len(piece.planks)) if planks is None else planks:
        along = int(np.argmax(piece.planks[i].size[:2]))
        for side in (2 * along, 2 * along + 1):
            if (i, side) in taken:
                continue
            missed = [one for one in _missed(piece, i, side, _ahead(piece, i, side, centres, normals)) if one]
            if missed:
                found.append(min(missed, key=lambda one: abs(one.gap) + one.aside))
    return tuple(found)


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


def _before(piece: Piece, i: int, side: int, j: int) -> FreeEnd | None:
    """The end before, in or beside a face of plank j; None where it is far from it."""
    one, other = piece.planks[i], piece.planks[j]
    axis = one.axes[:, side // 2] * (1.0 if side % 2 else -1.0)
    slope = float(axis @ other.axes[:, 2])
    if abs(slope) <= LEAST_SLANT:
        return None
    place, way = other.axes.T @ (one.end(side) - other.centre), other.axes.T @ axis
    gap = float((-np.sign(slope) * 0.5 * other.size[2] - place[2]) / slope)
    if not -min(BEYOND, other.size[2] + piece.reach) <= gap <= min(FAR, 0.5 * float(one.size[side // 2])):
        return None
    half = 0.5 * one.size[1 - side // 2] * (other.axes.T @ one.axes[:, 1 - side // 2])
    # The line of the end, not its middle alone, may meet the face.
    beside = np.abs(place + gap * way)[:2] - 0.5 * other.size[:2] - np.abs(half[:2])
    aside = float(np.linalg.norm(np.maximum(beside, 0.0)))
    joined = any({joint.i, joint.j} == {i, j} for joint in piece.joints)
    if aside > ASIDE or joined:
        return None
    return FreeEnd(i, side, j, gap, aside, bool(abs(half[2]) > piece.reach))


def _above(piece: Piece, i: int, side: int) -> FreeEnd | None:
    """The end above the floor, as the foot of a leg that is too short; None where it is far from it."""
    plank, floor = piece.planks[i], piece.planes[0]
    normal = np.array(floor.normal)
    slope = -float(plank.axes[:, side // 2] @ normal) * (1.0 if side % 2 else -1.0)
    if slope <= LEAST_SLANT:
        return None
    gap = float((plank.end(side) - np.array(floor.point)) @ normal) / slope
    if not -BEYOND <= gap <= min(FAR, 0.5 * float(plank.size[side // 2])):
        return None
    tilt = 0.5 * float(plank.size[1 - side // 2]) * abs(float(plank.axes[:, 1 - side // 2] @ normal))
    return FreeEnd(i, side, -1, gap, 0.0, tilt > piece.reach)
