"""Mirror planes of a piece: which plank is the image of which, and how freedoms of the two belong together."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture.shape.planks import Piece, Plank

SAME = 1e-6
"""How far corners may be from those of a mirrored plank, in parts of the piece's size."""

Member = tuple[int, int, float]
"""Plank and number of a design parameter, and its part of a group."""


@dataclass(frozen=True)
class Mirror:
    """An upright mirror plane through the middle of a piece, across axis x or y of the room.

    Args:
        axis: 0 or 1, which the plane is normal to.
        at: its coordinate on that axis [m].
        images: the number of the plank that each plank (n,) is mapped to.
    """

    axis: int
    at: float
    images: tuple[int, ...]

    def image(self, plank: Plank) -> Plank:
        """The mirror image of a plank, whose ends along x, and along y, are those of that plank."""
        sign, shift = np.ones(3), np.zeros(3)
        sign[self.axis], shift[self.axis] = -1.0, 2.0 * self.at
        start, end = (sign * plank.end(side) + shift for side in (0, 1))
        width = sign * plank.axes[:, 1] * plank.size[1]
        return Plank.between(plank.name, start, end, width, float(plank.size[2]), wood=plank.wood)

    def mate(self, piece: Piece, plank: int, number: int) -> Member | None:
        """The image of a design parameter; None where axes of the two planks do not agree."""
        image, axis = self.images[plank], number % 3
        sign = np.ones(3)
        sign[self.axis] = -1.0
        way = piece.planks[image].axes.T @ (sign * piece.planks[plank].axes[:, axis])
        k = int(np.argmax(np.abs(way)))
        if abs(way[k]) < 1.0 - SAME:
            return None
        if number >= 6:
            return (image, 6 + k, 1.0) if k < 2 else None
        # Turns go the other way round in a mirror.
        return (image, k, float(np.sign(way[k]))) if number < 3 else (image, 3 + k, -float(np.sign(way[k])))


def mirrors(piece: Piece) -> tuple[Mirror, ...]:
    """The upright mirror planes, across x and y of the room, that map a piece's planks onto each other."""
    corners = np.array([plank.corners() for plank in piece.planks])
    middle, room = 0.5 * (corners.min(axis=(0, 1)) + corners.max(axis=(0, 1))), SAME * piece.size
    found = []
    for axis in (0, 1):
        sign, shift = np.ones(3), np.zeros(3)
        sign[axis], shift[axis] = -1.0, 2.0 * middle[axis]
        images = _images(piece, corners * sign + shift, corners, room)
        if images is not None:
            found.append(Mirror(axis, float(middle[axis]), images))
    return tuple(found)


def groups(piece: Piece, freedoms: Iterable[tuple[int, int]], planes: tuple[Mirror, ...]) -> list[tuple[Member, ...]]:
    """Freedoms that keep the symmetry of a piece, each with its images; those that break it on their own are left out.

    Args:
        piece: with these mirror planes.
        freedoms: plank and number of each.
        planes: whose symmetry is kept.
    """
    found, seen, free = [], set(), set(freedoms)
    for one in sorted(free):
        if one in seen:
            continue
        group = _orbit(piece, (*one, 1.0), planes)
        if group is None:
            continue
        members = {(plank, number) for plank, number, _ in group}
        seen |= members
        if members <= free:
            found.append(group)
    return found


def keeps(before: Piece, after: Piece) -> bool:
    """Whether a change keeps all mirror planes that a piece has."""
    return {one.axis for one in mirrors(before)} <= {one.axis for one in mirrors(after)}


def _orbit(piece: Piece, start: Member, planes: tuple[Mirror, ...]) -> tuple[Member, ...] | None:
    """All images of a design parameter; None where one of them is its opposite."""
    parts, left = {start[:2]: start[2]}, [start]
    while left:
        plank, number, part = left.pop()
        for plane in planes:
            mate = plane.mate(piece, plank, number)
            if mate is None:
                return None
            key, sign = mate[:2], part * mate[2]
            if key not in parts:
                parts[key] = sign
                left.append((*key, sign))
            elif parts[key] != sign:
                return None
    first = start[:2]
    return tuple((*key, parts[key]) for key in sorted(parts, key=lambda one: (one != first, one)))


def _images(piece: Piece, mirrored: np.ndarray, corners: np.ndarray, room: float) -> tuple[int, ...] | None:
    """The number of the plank that has each plank's mirrored corners (n, 8, 3), and its wood; None where one has none.

    Planks in one another's place have one centre, which is looked at first.
    """
    found = []
    apart = np.linalg.norm(mirrored.mean(axis=1)[:, None] - corners.mean(axis=1)[None], axis=2)
    for plank, wanted, far in zip(piece.planks, mirrored, apart):
        near = (int(k) for k in np.flatnonzero(far <= room) if piece.planks[k].wood == plank.wood)
        image = next((k for k in near if same_place(wanted, corners[k], room)), None)
        if image is None:
            return None
        found.append(image)
    return tuple(found)


def same_place(corners: np.ndarray, others: np.ndarray, room: float) -> bool:
    """Whether two planks lie in each other's place, by their corners (8, 3) in any order, to `room` [m]."""
    apart = np.linalg.norm(corners[:, None] - others[None], axis=2)
    return bool(apart.min(axis=1).max() <= room and apart.min(axis=0).max() <= room)
