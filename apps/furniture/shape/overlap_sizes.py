"""How far planks that overlap are in each other, where, and how one leaves the other."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture.shape.planks import CORNERS, LEAST_SLANT, Piece

EDGES = np.array([(a, b) for a in range(8) for b in range(a + 1, 8) if np.sum(CORNERS[a] != CORNERS[b]) == 1])
"""Corners (12, 2) of the edges of a plank."""


@dataclass(frozen=True)
class Overlap:
    """Plank `other` in plank `plank`, or plank `plank` in the fixed plane `-1 - other`.

    Args:
        depth: how far the second one goes for both to touch [m]; of a fixed plane the first one.
        way: (3,) the unit vector along which it goes.
        place: (3,) the middle of what they share [m].
    """

    plank: int
    other: int
    depth: float
    way: np.ndarray
    place: np.ndarray


def overlap_sizes(piece: Piece, pairs: Sequence[tuple[int, int]]) -> list[Overlap]:
    """The sizes of overlaps of a piece with closed joints; ends are cut along the planes that hold them.

    Args:
        piece: whose planks are where they overlap.
        pairs: of planks; a plank and -1 - k where it goes through plane k.
    """
    bodies = {k: _Body(piece, k) for pair in pairs for k in pair if k >= 0}
    return [
        _between(i, j, bodies[i], bodies[j]) if j >= 0 else _below(piece, i, j, bodies[i].corners) for i, j in pairs
    ]


class _Body:
    """Corners (8, 3) of a plank with cut ends, and the planes of its sides: normals (6, 3), and places along them."""

    def __init__(self, piece: Piece, k: int) -> None:
        plank = piece.planks[k]
        self.axes, self.corners = plank.axes, plank.corners()
        self.normals = np.array([plank.axes[:, side // 2] * (1.0 if side % 2 else -1.0) for side in range(6)])
        places = np.array([plank.end(side) for side in range(6)])
        for side, (point, normal) in _cut_planes(piece, k).items():
            axis, slope = plank.axes[:, side // 2], float(self.normals[side] @ normal)
            if -slope < LEAST_SLANT:
                continue
            at = (CORNERS[:, side // 2] > 0.0) == bool(side % 2)
            self.corners[at] += np.outer((point - self.corners[at]) @ normal / float(axis @ normal), axis)
            self.normals[side], places[side] = -normal, point
        self.offsets = np.sum(self.normals * places, axis=1)


def _cut_planes(piece: Piece, k: int) -> dict[int, tuple[np.ndarray, np.ndarray]]:
    """Ends of a plank that meet a plane: a point of the plane of each, and its normal (3,)."""
    planes = {
        foot.side: (np.array(piece.planes[foot.plane].point), np.array(piece.planes[foot.plane].normal))
        for foot in piece.feet
        if foot.plank == k and foot.side < 4
    }
    for joint in piece.joints:
        if joint.i == k and joint.side not in planes:
            other = piece.planks[joint.j]
            planes[joint.side] = other.end(joint.face), other.axes[:, 2] * (1.0 if joint.face == 5 else -1.0)
    return planes


def _below(piece: Piece, i: int, j: int, corners: np.ndarray) -> Overlap:
    """How far a plank is in a fixed plane."""
    normal = np.array(piece.planes[-1 - j].normal)
    heights = (corners - np.array(piece.planes[-1 - j].point)) @ normal
    return Overlap(i, j, -float(heights.min()), normal, corners[int(np.argmin(heights))])


def _between(i: int, j: int, one: _Body, other: _Body) -> Overlap:
    """How far two planks are in each other, along the separating axis that needs least."""
    across = np.cross(one.axes.T[:, None], other.axes.T[None]).reshape(-1, 3)
    sizes = np.linalg.norm(across, axis=1)
    axes = np.concatenate([one.normals, other.normals, across[sizes > 1e-6] / sizes[sizes > 1e-6, None]])
    first, second = one.corners @ axes.T, other.corners @ axes.T
    ahead, back = first.max(axis=0) - second.min(axis=0), second.max(axis=0) - first.min(axis=0)
    depth = np.minimum(ahead, back)
    # Rounding decides nothing.
    k = int(np.argmin(np.round(depth, 9)))
    way = axes[k] if round(ahead[k], 9) <= round(back[k], 9) else -axes[k]
    shared = np.concatenate([_cut(one, other), _cut(other, one)])
    low, high = (shared.min(axis=0), shared.max(axis=0)) if len(shared) else (one.corners[0], one.corners[0])
    return Overlap(i, j, float(depth[k]), way, 0.5 * (low + high))


def _cut(one: _Body, other: _Body) -> np.ndarray:
    """Both ends (n, 3) of the parts of the edges of one body that lie in another one."""
    start, end = one.corners[EDGES[:, 0]], one.corners[EDGES[:, 1]]
    first, change = start @ other.normals.T - other.offsets, (end - start) @ other.normals.T
    safe = np.where(np.abs(change) > 1e-12, change, 1.0)
    at = -first / safe
    along = np.abs(change) <= 1e-12
    low = np.where(along, np.where(first > 1e-9, np.inf, 0.0), np.where(change < 0.0, at, 0.0)).max(axis=1).clip(0.0)
    high = np.where(along | (change < 0.0), 1.0, at).min(axis=1).clip(max=1.0)
    inside = low <= high
    parts = np.concatenate([low[inside], high[inside]])
    return np.tile(start[inside], (2, 1)) + parts[:, None] * np.tile((end - start)[inside], (2, 1))
