"""Support planks: boards between two parallel planks, or a plank and the floor, that take load off a weak joint."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, count, islice, product
from math import dist

import numpy as np
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, UNBALANCED, UNSTABLE, Furniture, TestResult
from restshape_apps.furniture.shape.planks import Foot, Joint, Piece, Plank
from restshape_apps.furniture.shape.symmetry import SAME, Mirror, mirrors, same_place

from restshape.errors import UserError

PARALLEL = 0.9
"""Least |n_i . n_j| of planks that count as parallel."""

WIDTH = 0.15
"""Of a support plank [m], where there is room."""

AWAY = (0.0, 0.12, 0.3, 0.5)
"""How far a support plank is from the third plank, in parts of the face it stands on."""

ALONG = (-1.0, 0.0, 1.0)
"""Where it is along the joint: at one end, in the middle, at the other."""

FAR = (1.0, 0.85, 0.7)
"""The same for a prop far from the third plank; 1 is flush with the end of the face."""

Spot = tuple[bool, float, float]
"""Whether the board's width points away from the third plank, and how far away and along the joint it is."""

ROUNDS: tuple[tuple[Spot, ...], ...] = (
    tuple(product((True, False), AWAY, ALONG)),
    tuple((across, away, along) for along, away, across in product((0.0, -1.0, 1.0), FAR, (False, True))),
)
"""Spots that are tried one after the other: near the weak joint, and, where none of these makes all valid, far."""

SHOWN = 2
TRIALS = 36
"""Tests at most of a round."""

EACH = 8
"""Tests at most of one pair of planks in a round."""

FLOOR = -1
"""Stands for the first plane, in place of a plank's number."""


@dataclass(frozen=True)
class SupportPlank:
    """A piece with one more plank, or with that and its mirror images.

    Args:
        piece: with the plank, and its mirror images, as its last ones.
        between: the two planks that it connects; the second may be `FLOOR`.
        third: the plank they share, through the weak joint.
        result: of the full test: valid, or weak in joints that were weak before.
        relieved: joints that are weak no more.
        plank: the first of those that are added.
        mirrored: axes across which it has mirror images, 0 or 1.
    """

    piece: Piece
    between: tuple[int, int]
    third: int
    result: TestResult
    relieved: tuple[int, ...]
    plank: Plank
    mirrored: tuple[int, ...] = ()


def support_planks(furniture: Furniture, shown: int = SHOWN, trials: int = TRIALS) -> tuple[SupportPlank, ...]:
    """Support planks that make a weak joint durable, at most `shown`; those that make the whole piece valid are first.

    Between two planks i and j that are nearly parallel and share a third plank k through joints, one of them weak,
    a board goes straight across, with its face along k or across it, at places along the joint and away from k: near
    it at first, and out to the far end of plank i where no near one makes the piece valid. The floor counts as such a
    plank j where k stands on it. No other joint may become weak. A board of a piece with mirror planes comes with its
    images: first those that are their own, then with these, then those alone that break the symmetry, the next ones
    only where none makes the piece valid.

    Args:
        furniture: the model of the weak piece, just tested at no change of its design parameters.
        shown: how many to give.
        trials: full tests at most of near places, and as many of far ones; as many again of each of these three.

    Source: docs/theory/furniture.md; the thesis, section 6.5.5.
    """
    planes = mirrors(furniture.piece)
    reliefs = Reliefs(furniture)
    found: list[SupportPlank] = []
    for kept, alone in ((planes, True), (planes, False), ((), False)) if planes else (((), False),):
        if not any(one.result.valid for one in found):
            found += searched(reliefs, shown, trials, kept, alone)
    furniture.test()
    return tuple(sorted(found, key=lambda one: (not one.result.valid, -len(one.relieved)))[:shown])


def searched(reliefs: Reliefs, shown: int, trials: int, planes: Sequence[Mirror], alone: bool) -> list[SupportPlank]:
    """Support planks, each with its images in mirror planes; `alone`: those alone that are their own images."""
    piece, geometry = reliefs.furniture.piece, reliefs.geometry
    found: list[SupportPlank] = []
    for spots in ROUNDS:
        if any(one.result.valid for one in found):
            break
        left = trials
        for i, j, k, joint in _candidates(piece, reliefs.utilisation):
            if left <= 0 or sum(one.result.valid for one in found) >= shown:
                break
            places = _planks(piece, (i, j, k), geometry.p[joint], geometry.y[joint], spots)
            groups = (_images(piece, (plank, (i, j)), planes) for plank in places)
            for boards in islice(groups, min(EACH, left)):
                if alone and len(boards) > 1:
                    continue
                left -= 1
                plank = boards[0][0]
                if _is_found(piece, plank, found):
                    break
                if one := reliefs.by(boards, k, joint):
                    # Where its joints are closed, it may be in the place of an image of what was found.
                    if _is_found(piece, one.plank, found):
                        break
                    images = ((plane.axis, plane.image(plank)) for plane in planes)
                    axes = tuple(axis for axis, image in images if not _in_place(piece, image, [plank]))
                    found.append(replace(one, mirrored=axes))
                    # The next one shall be another suggestion.
                    break
    return found


Board = tuple[Plank, tuple[int, int]]
"""A plank that is added, and what it is between."""


def _images(piece: Piece, board: Board, planes: Sequence[Mirror]) -> list[Board]:
    """A board with its images in mirror planes, each once."""
    found = [board]
    for plane in planes:
        for plank, between in found[:]:
            image = plane.image(plank)
            if not _in_place(piece, image, [each for each, _ in found]):
                i, j = (k if k == FLOOR else plane.images[k] for k in between)
                found.append((image, (i, j)))
    return found


def _in_place(piece: Piece, plank: Plank, others: Sequence[Plank]) -> bool:
    """Whether one of other planks lies in the place of a plank."""
    room, centre = SAME * piece.size, plank.centre.tolist()
    # Planks in one another's place have one centre, which is looked at first.
    near = (other for other in others if dist(other.centre, centre) <= room)
    return any(same_place(plank.corners(), other.corners(), room) for other in near)


def _is_found(piece: Piece, plank: Plank, found: Sequence[SupportPlank]) -> bool:
    """Whether a plank lies in the place of one of those that were found, or of an image of it."""
    return any(_in_place(piece, plank, one.piece.planks) for one in found)


class Reliefs:
    """What boards do to a weak piece; what was tested is not tested again."""

    def __init__(self, furniture: Furniture) -> None:
        self.furniture, self.geometry = furniture, furniture.geometry()
        self.utilisation = _utilisations(furniture)
        self._tested: dict[tuple[object, ...], SupportPlank | None] = {}

    def by(self, boards: Sequence[Board], third: int, joint: int) -> SupportPlank | None:
        """The piece with these boards, if they take enough load off the joint and overload no other."""
        places = ((*between, *plank.centre.tolist(), *plank.size.tolist()) for plank, between in boards)
        tried = (joint, *places)
        if tried not in self._tested:
            self._tested[tried] = self._test(boards, third, joint)
        return self._tested[tried]

    def _test(self, boards: Sequence[Board], third: int, joint: int) -> SupportPlank | None:
        piece = self.furniture.piece
        try:
            for plank, between in boards:
                piece = _with(piece, plank, *between)
            model = Furniture(piece, self.furniture.compliance)
        except UserError:
            # Its fasteners do not hold there.
            return None
        result = model.test()
        if result.flaws & (LOST | OVERLAPPING | UNSTABLE | UNBALANCED):
            return None
        now, before = _utilisations(model), self.utilisation
        weak = now > 1.0
        known = np.append(before > 1.0, np.zeros(len(now) - len(before), dtype=bool))
        if weak[joint] or np.any(weak & ~known):
            return None
        moved, relieved = model.moved(), tuple(map(int, np.flatnonzero(known & ~weak)))
        added = moved.planks[len(self.furniture.piece.planks)]
        return SupportPlank(moved, boards[0][1], third, result, relieved, added)


def _utilisations(furniture: Furniture) -> np.ndarray:
    """The largest utilisation (j,) of each joint's strength in the cases of the last test."""
    utilisation = np.zeros(len(furniture.piece.joints))
    for case in range(len(furniture.cases)):
        forces = furniture.forces(case)
        utilisation = np.maximum(utilisation, forces.utilisation)
    return utilisation


def _candidates(piece: Piece, utilisation: np.ndarray) -> Iterator[tuple[int, int, int, int]]:
    """Planks i, j, the third k that both are joined to, and the weak joint of i and k; the weakest joint first."""
    joined: dict[int, set[int]] = {}
    for joint in piece.joints:
        joined.setdefault(joint.i, set()).add(joint.j)
        joined.setdefault(joint.j, set()).add(joint.i)
    normals = np.array([plank.axes[:, 2] for plank in piece.planks])
    level = np.abs(normals @ np.array(piece.planes[0].normal)) > PARALLEL
    standing = {foot.plank for foot in piece.feet if foot.plane == 0}
    order = np.argsort(-utilisation)
    for number in order[utilisation[order] > 1.0]:
        ends = piece.joints[number].i, piece.joints[number].j
        for i, k in (ends, ends[::-1]):
            for j in sorted(joined[k] - {i}):
                if abs(normals[i] @ normals[j]) > PARALLEL:
                    yield i, j, k, int(number)
            if level[i] and k in standing:
                yield i, FLOOR, k, int(number)


def _planks(
    piece: Piece, between: tuple[int, int, int], p: np.ndarray, y: np.ndarray, spots: Sequence[Spot]
) -> Iterator[Plank]:
    """Support planks at spots from plank i to plank j or the floor beside plank k, by the rules of this module."""
    i, j, k = between
    one, third = piece.planks[i], piece.planks[k]
    way = _way(piece, i, j, k)
    if way is None:
        return
    y = y - way * (y @ way)
    y /= np.linalg.norm(y)
    down = np.cross(way, y)
    down *= np.sign(down @ (one.centre - p)) or 1.0
    reach, free = (float(np.abs(one.axes.T @ v) @ one.size) for v in (down, y))
    wide = min(WIDTH, free)
    normals = [one.axes[:, 2], np.array(piece.planes[0].normal) if j == FLOOR else piece.planks[j].axes[:, 2]]
    # An end lies flush with a slanted face only if its edge runs along that.
    slanted = max(abs(normal @ down) for normal in normals) >= 1e-9
    end = (one.centre - p) @ down + 0.5 * reach
    for across, away, along in spots:
        high, broad = (wide, float(third.size[2])) if across else (float(third.size[2]), wide)
        if (across and slanted) or (along and free - broad < 1e-3):
            continue
        offset = 0.5 * third.size[2] + 0.5 * high + 1e-3 + away * reach
        if away in FAR:
            offset = min(offset, end - 0.5 * high)
        place = p + down * offset + y * ((one.centre - p) @ y + 0.5 * along * (free - broad))
        ends = [_met(one, place, way), _landed(piece, place, way) if j == FLOOR else _met(piece.planks[j], place, way)]
        if ends[0] is None or ends[1] is None or (ends[1] - ends[0]) @ way <= 0.02:
            continue
        width = (down if across else y) * wide
        yield Plank.between("support", ends[0], ends[1], width, float(third.size[2]), wood=third.wood)


def _way(piece: Piece, i: int, j: int, k: int) -> np.ndarray | None:
    """The direction (3,) from plank i to plank j along plank k, or down to the floor; None where that misses j."""
    one, third = piece.planks[i], piece.planks[k]
    if j == FLOOR:
        return -np.array(piece.planes[0].normal)
    other = piece.planks[j]
    # Straight along k, where that meets both.
    across_k = one.axes[:, 2] - third.axes[:, 2] * (one.axes[:, 2] @ third.axes[:, 2])
    size = float(np.linalg.norm(across_k))
    if size < PARALLEL:
        return None
    way = across_k / size * np.sign(across_k @ (other.centre - one.centre))
    aside = one.axes.T @ (other.centre - one.centre - way * (way @ (other.centre - one.centre)))
    return way if np.all(np.abs(aside) < 0.5 * (one.size + np.abs(one.axes.T @ other.axes) @ other.size)) else None


def _met(plank: Plank, place: np.ndarray, way: np.ndarray) -> np.ndarray | None:
    """Where a line meets the middle plane of a plank; None where it misses the plank."""
    slope = way @ plank.axes[:, 2]
    point = place + way * ((plank.centre - place) @ plank.axes[:, 2] / slope)
    inside = np.abs(plank.axes.T @ (point - plank.centre))[:2] < 0.5 * plank.size[:2]
    return point if abs(slope) > 1e-3 and inside.all() else None


def _landed(piece: Piece, place: np.ndarray, way: np.ndarray) -> np.ndarray:
    """Where a line down meets the floor."""
    normal = np.array(piece.planes[0].normal)
    return place + way * ((np.array(piece.planes[0].point) - place) @ normal / (way @ normal))


def _with(piece: Piece, plank: Plank, i: int, j: int) -> Piece:
    """The piece with a plank more, its ends against planks i and j, or on the floor; they are drawn to their middle."""
    new, fastener = len(piece.planks), piece.joints[0].fastener
    plank = replace(plank, name=_free_name(piece, plank.name))
    joints = []
    for side, p in ((0, i), (1, j)):
        if p != FLOOR:
            above = piece.planks[p].axes[:, 2] @ (plank.centre - piece.planks[p].centre) > 0
            joints.append(Joint(new, side, p, 5 if above else 4, fastener))
    feet = (*piece.feet, Foot(new, 1, 0)) if j == FLOOR else piece.feet
    return replace(piece, planks=(*piece.planks, plank), joints=(*piece.joints, *joints), feet=feet)


def _free_name(piece: Piece, name: str) -> str:
    """A name that no plank has yet: this one, or it with a number."""
    taken = {plank.name for plank in piece.planks}
    return next(one for one in chain([name], (f"{name}-{k}" for k in count(2))) if one not in taken)
