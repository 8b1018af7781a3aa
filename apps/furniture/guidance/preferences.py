"""What suggestions are to keep of a piece: locks of its scene, what is level or upright, and its symmetry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from restshape_apps.furniture.guidance import amounts
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import FREEDOMS, Piece
from restshape_apps.furniture.shape.symmetry import SAME, groups, keeps, mirrors

SYMMETRY, LEVEL, HEIGHT = "symmetry", "level", "height"
"""What may be kept of the whole piece; of a plank it is "PLANK level", and "PLANK place" where it must not change."""
PLACE = "place"
STRAIGHT = 1e-9
"""How far from 1 or 0 the cosine with the vertical is of a plank that is level or upright."""
GROWN, LARGER = 0.1, 0.25
"""Parts by which an outer size of a piece may grow before that is said, and before its shape does not count as kept."""
STEP = 1e-3
"""Change of a freedom [m or rad] by which it is found what else it moves."""
STILL = 1e-9
"""How far what is kept may move by that step [m]."""

Freedom = tuple[int, int]


def kept_modes(furniture: Furniture, keep: Sequence[str]) -> list[DesignModes]:
    """Modes that suggestions are made of, first those that keep symmetry and level, then level, then what is locked.

    Args:
        furniture: the model of the piece.
        keep: locks that are never given up, as in `[effects.guidance]`.
    """
    piece = furniture.piece
    free = [one for one in map(tuple, furniture.kernel.freedoms()) if _unlocked(furniture, one, keep)]
    furniture.test()
    level = [one for one in free if _keeps_level(piece, one)]
    planes = mirrors(piece)
    sets = [_grouped(piece, level, planes)] if planes else []
    if SYMMETRY in keep and planes:
        return sets if LEVEL in keep else [*sets, _grouped(piece, free, planes)]
    sets.append(DesignModes.of(piece, level))
    if LEVEL not in keep:
        sets.append(DesignModes.of(piece, free))
    distinct = [one for k, one in enumerate(sets) if len(one) and not any(_same(one, other) for other in sets[:k])]
    return distinct or [DesignModes.of(piece, free)]


def preserved(before: Piece, after: Piece) -> tuple[bool, bool]:
    """Whether a change keeps what is level or upright so, and whether it keeps the symmetry of a piece."""
    level = all(not _straight(old.axes) or _straight(new.axes) for old, new in zip(before.planks, after.planks))
    return level, keeps(before, after)


def shape_costs(before: Piece, after: Piece) -> str:
    """What a change costs the shape of a piece: symmetry that is lost, and outer sizes that grow by more than `GROWN`;
    empty where it costs nothing."""
    lost = {one.axis for one in mirrors(before)} - {one.axis for one in mirrors(after)}
    sides = [f"lop-sided across {' and '.join('xy'[axis] for axis in sorted(lost))}"] if lost else []
    grown = (
        f"{amounts.amount(new, 'm')} along {axis} in all, not {amounts.amount(old, 'm')}"
        for axis, old, new in zip("xyz", outer_size(before).tolist(), outer_size(after).tolist())
        if new > (1.0 + GROWN) * old
    )
    return "; ".join([*sides, *grown])


def grows(before: Piece, after: Piece) -> bool:
    """Whether an outer size of a piece grows by more than `LARGER`."""
    return bool(np.any(outer_size(after) > (1.0 + LARGER) * outer_size(before)))


def outer_size(piece: Piece) -> np.ndarray:
    """Sizes (3,) of a piece along the axes of the room [m]."""
    return np.ptp(np.concatenate([plank.corners() for plank in piece.planks]), axis=0)


def locked(before: Piece, after: Piece, keep: Sequence[str]) -> bool:
    """Whether a change obeys all locks: what is level or upright, mirror planes, places of corners, the highest one.

    Args:
        before, after: the piece, which has the same planks first, and then those that are added.
        keep: as in `[effects.guidance]`.
    """
    return all(_obeyed(before, after, *lock.rpartition(" ")[::2]) for lock in keep)


def _obeyed(before: Piece, after: Piece, name: str, what: str) -> bool:
    if what == SYMMETRY:
        return keeps(before, after)
    pairs = [(old, new) for old, new in zip(before.planks, after.planks) if name in ("", old.name)]
    if what == LEVEL:
        return all(not _straight(old.axes) or _straight(new.axes) for old, new in pairs)
    room = SAME * before.size
    if what == PLACE:
        return all(np.abs(new.corners() - old.corners()).max() <= room for old, new in pairs)
    added = [] if name else [plank.corners() for plank in after.planks[len(before.planks) :]]
    old, new = _whole([(old.corners(), new.corners()) for old, new in pairs])
    highest = max(float(corners[:, 2].max()) for corners in [new, *added])
    return not len(old) or abs(highest - float(old[:, 2].max())) <= room


def farthest_move(before: Piece, after: Piece) -> float:
    """How far [m] the corner moves that goes farthest; planks that are added move nothing."""
    moves = (
        float(np.linalg.norm(new.corners() - old.corners(), axis=1).max())
        for old, new in zip(before.planks, after.planks)
    )
    return max(moves, default=0.0)


def way_of_material(before: Piece, after: Piece) -> float:
    """How far material goes [m]: mean distance that corners of planks move, by their volumes; an added plank counts as
    moved by the piece's size."""
    volume = np.array([float(np.prod(plank.size)) for plank in after.planks])
    far = [
        float(np.linalg.norm(new.corners() - old.corners(), axis=1).mean())
        for old, new in zip(before.planks, after.planks)
    ]
    far += [before.size] * (len(after.planks) - len(before.planks))
    return float(np.dot(volume, far) / volume.sum())


def _grouped(piece: Piece, free: Sequence[Freedom], planes: tuple) -> DesignModes:
    members = groups(piece, free, planes)
    modes = DesignModes.of(piece, [(plank, number) for (plank, number, _), *_ in members])
    return replace(modes, mates=tuple(tuple(others) for _, *others in members))


def _same(one: DesignModes, other: DesignModes) -> bool:
    return one.mates == other.mates and np.array_equal(one.freedoms, other.freedoms)


def _straight(axes: np.ndarray) -> bool:
    """Whether a plank is level, or upright with an edge that is vertical."""
    up = np.abs(axes[2])
    return bool(up.max() > 1.0 - STRAIGHT)


def _keeps_level(piece: Piece, freedom: Freedom) -> bool:
    """Whether a freedom keeps a plank level or upright that is so: turns only about what is vertical."""
    plank, number = freedom
    axes = piece.planks[plank].axes
    return not 3 <= number < 6 or not _straight(axes) or abs(axes[2, number - 3]) > 1.0 - STRAIGHT


def _unlocked(furniture: Furniture, freedom: Freedom, keep: Sequence[str]) -> bool:
    """Whether a freedom moves nothing that is locked."""
    piece, (plank, number) = furniture.piece, freedom
    for lock in keep:
        name, _, what = lock.rpartition(" ")
        if what == LEVEL and name == piece.planks[plank].name and not _keeps_level(piece, freedom):
            return False
        if what not in (PLACE, HEIGHT):
            continue
        gamma = np.zeros((len(piece.planks), len(FREEDOMS)))
        gamma[plank, number] = STEP
        pairs = [
            (old.corners(), new.corners())
            for old, new in zip(piece.planks, furniture.moved(gamma).planks)
            if name in ("", old.name)
        ]
        if any(_moves(old, new, what) for old, new in ([_whole(pairs)] if what == HEIGHT else pairs)):
            return False
    return True


def _whole(pairs: Sequence[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    old, new = zip(*pairs)
    return np.concatenate(old), np.concatenate(new)


def _moves(old: np.ndarray, new: np.ndarray, what: str) -> bool:
    """Whether corners move, or the highest of them gets another height."""
    if what == PLACE:
        return bool(np.abs(new - old).max() > STILL)
    return bool(abs(new[:, 2].max() - old[:, 2].max()) > STILL)
