"""How far ends of planks are from planks that they could be joined to."""

from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture.shape.planks import LEAST_SLANT, Piece, parts_of


@dataclass(frozen=True)
class Gap:
    """The end `side` (0 to 3) of plank `i` and plank `j`, `size` [m] apart."""

    i: int
    side: int
    j: int
    size: float


def gap_of(piece: Piece, i: int, side: int, j: int) -> Gap:
    """The gap between one end of a plank and another plank, whichever way the end points."""
    return Gap(i, side, j, float(_sizes(*_boxes(piece), np.array([[i, side, j]]))[0]))


def gap_between_parts(piece: Piece) -> Gap | None:
    """The smallest gap between an end in one part of a piece and a face in another; None where no end looks at one."""
    part = np.zeros(len(piece.planks), dtype=int)
    for number, planks in enumerate(parts_of(piece)):
        part[list(planks)] = number
    return _smallest(piece, (part[:, None] != part)[:, None, :])


def gap_at(piece: Piece, plank: int, side: int | None = None) -> Gap | None:
    """The smallest gap at one end of a plank, or (None) at all of its ends and faces; None where there is none."""
    wanted = np.zeros((len(piece.planks), 4, len(piece.planks)), dtype=bool)
    wanted[plank, slice(None) if side is None else side] = True
    if side is None:
        wanted[:, :, plank] = True
    wanted[plank, :, plank] = False
    return _smallest(piece, wanted)


def _smallest(piece: Piece, wanted: np.ndarray) -> Gap | None:
    """The smallest gap of the ends and planks wanted (n, 4, n), of those free ends that look at a face in front."""
    centre, axes, size = _boxes(piece)
    across = [1, 1, 0, 0]
    ends = axes.transpose(0, 2, 1)[:, [0, 0, 1, 1]] * np.array([-1.0, 1.0, -1.0, 1.0])[:, None]
    lines = axes.transpose(0, 2, 1)[:, across] * (0.5 * size[:, across])[:, :, None]
    middles = centre[:, None] + ends * (0.5 * size[:, [0, 0, 1, 1]])[:, :, None]
    normals = axes[:, :, 2]
    slope, tilt = ends @ normals.T, np.abs(lines @ normals.T)
    # Beyond the face that the end comes to it looks away from the plank.
    short = -np.sign(slope) * (middles @ normals.T - np.sum(centre * normals, axis=1)) - 0.5 * size[:, 2]
    looks = wanted & (np.abs(slope) > LEAST_SLANT) & (tilt <= piece.reach) & (short >= -piece.reach)
    joined = [(joint.i, joint.side) for joint in piece.joints]
    for plank, side in joined + [(foot.plank, foot.side) for foot in piece.feet if foot.side < 4]:
        looks[plank, side] = False
    pairs = np.argwhere(looks)
    if not len(pairs):
        return None
    sizes = _sizes(centre, axes, size, pairs)
    k = int(np.argmin(sizes))
    return Gap(*pairs[k].tolist(), float(sizes[k]))


def _boxes(piece: Piece) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Centres (n, 3), axes (n, 3, 3) and sizes (n, 3) of the planks."""
    return tuple(np.array([getattr(plank, key) for plank in piece.planks]) for key in ("centre", "axes", "size"))


def _sizes(centre: np.ndarray, axes: np.ndarray, size: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Distances (m,) of the middle lines of ends, and other planks; `pairs` (m, 3) are plank, side and other plank."""
    i, side, j = pairs.T
    along, m = side // 2, np.arange(len(pairs))
    sign = np.where(side % 2, 0.5, -0.5)
    place = centre[i] - centre[j] + axes[i, :, along] * (sign * size[i, along])[:, None]
    half = axes[i, :, 1 - along] * (0.5 * size[i, 1 - along])[:, None]
    p, d = (np.einsum("mab,ma->mb", axes[j], v) for v in (place, half))
    box = 0.5 * size[j]
    # Along p + s d the square of the distance is convex, and its slope is straight between the planes of the box.
    safe = np.where(np.abs(d) > 1e-12, d, 1e-12)
    marks = np.concatenate([(box - p) / safe, (-box - p) / safe, np.full((len(m), 1), -1.0), np.ones((len(m), 1))], 1)
    marks = np.sort(np.clip(marks, -1.0, 1.0), axis=1)
    slopes = np.sum(d[:, None] * _outside(p[:, None] + marks[:, :, None] * d[:, None], box[:, None]), axis=2)
    last = np.clip(np.sum(slopes < 0.0, axis=1), 1, marks.shape[1] - 1)
    low, high, left, right = marks[m, last - 1], marks[m, last], slopes[m, last - 1], slopes[m, last]
    rise = right - left
    s = low + (high - low) * np.clip(np.where(rise > 0.0, -left / np.where(rise > 0.0, rise, 1.0), 0.0), 0.0, 1.0)
    return np.linalg.norm(_outside(p + s[:, None] * d, box), axis=1)


def _outside(place: np.ndarray, box: np.ndarray) -> np.ndarray:
    """From the nearest point of a box to a place."""
    return place - np.clip(place, -box, box)
