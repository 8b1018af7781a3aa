"""Support planks: boards between two parallel planks that take load off a weak joint to a third."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from restshape.physics.furniture import ALL, Furniture, Verdict
from restshape.shape.planks import Joint, Piece, Plank

PARALLEL = 0.9
"""Least |n_i . n_j| of planks that count as parallel."""

WIDTH = 0.15
"""Of a support plank [m], where there is room."""

AWAY = (0.0, 0.12, 0.3, 0.5)
"""How far a support plank is from the third plank, in parts of the face it stands on."""

ALONG = (-1.0, 0.0, 1.0)
"""Where it is along the joint: at one end, in the middle, at the other."""

SHOWN = 2
TRIALS = 24


@dataclass(frozen=True)
class SupportPlank:
    """A piece with one more plank, which passes the full test.

    Args:
        piece: with the plank as its last.
        between: the two planks that it connects.
        third: the plank they share, through the weak joint.
        verdict: of the full test.
    """

    piece: Piece
    between: tuple[int, int]
    third: int
    verdict: Verdict


def support_planks(furniture: Furniture, shown: int = SHOWN, trials: int = TRIALS) -> tuple[SupportPlank, ...]:
    """Support planks that make a piece durable, at most `shown`, tried in the order of the rules.

    Between two planks i and j that are nearly parallel and share a third plank k through joints, one of them weak,
    a board goes straight across, with its face along k or across it, at places along the joint and away from k.

    Args:
        furniture: the model of the weak piece, just tested at no change of its design parameters.
        shown: how many to give.
        trials: full tests at most.

    Source: docs/theory.md, section 11; the thesis, section 6.5.5.
    """
    weak = _weak_joints(furniture)
    geometry = furniture.geometry()
    found: list[SupportPlank] = []
    tried = 0
    for i, j, k, joint in _candidates(furniture.piece, weak):
        for plank in _planks(furniture.piece, i, j, k, geometry.p[joint], geometry.y[joint]):
            if len(found) >= shown or tried >= trials:
                break
            tried += 1
            model = Furniture(_with(furniture.piece, plank, i, j), furniture.compliance)
            verdict = model.test(None, ALL, True)
            if verdict.valid:
                found.append(SupportPlank(model.moved(), (i, j), k, verdict))
                # The next one shall be another idea.
                break
    furniture.test()
    return tuple(found)


def _weak_joints(furniture: Furniture) -> np.ndarray:
    """Numbers of the weak joints, the weakest first."""
    use = np.zeros(len(furniture.piece.joints))
    for case in range(len(furniture.cases)):
        forces = furniture.forces(case)
        use = np.maximum(use, np.maximum(forces.pull_use, forces.shear_use))
    order = np.argsort(-use)
    return order[use[order] > 1.0]


def _candidates(piece: Piece, weak: np.ndarray) -> Iterator[tuple[int, int, int, int]]:
    """Planks i, j, the third k that both are joined to, and the weak joint of i and k."""
    joined: dict[int, set[int]] = {}
    for joint in piece.joints:
        joined.setdefault(joint.i, set()).add(joint.j)
        joined.setdefault(joint.j, set()).add(joint.i)
    normals = np.array([plank.axes[:, 2] for plank in piece.planks])
    for number in weak:
        ends = piece.joints[number].i, piece.joints[number].j
        for i, k in (ends, ends[::-1]):
            for j in sorted(joined[k] - {i}):
                if abs(normals[i] @ normals[j]) > PARALLEL:
                    yield i, j, k, int(number)


def _planks(piece: Piece, i: int, j: int, k: int, p: np.ndarray, y: np.ndarray) -> Iterator[Plank]:
    """Support planks from plank i to plank j beside plank k, by the rules of this module."""
    one, other, third = piece.planks[i], piece.planks[j], piece.planks[k]
    # Straight along k, where that meets both.
    across_k = one.axes[:, 2] - third.axes[:, 2] * (one.axes[:, 2] @ third.axes[:, 2])
    size = float(np.linalg.norm(across_k))
    if size < PARALLEL:
        return
    way = across_k / size * np.sign(across_k @ (other.centre - one.centre))
    aside = one.axes.T @ (other.centre - one.centre - way * (way @ (other.centre - one.centre)))
    if np.any(np.abs(aside) >= 0.5 * (one.size + np.abs(one.axes.T @ other.axes) @ other.size)):
        return
    y = y - way * (y @ way)
    y /= np.linalg.norm(y)
    down = np.cross(way, y)
    down *= np.sign(down @ (one.centre - p)) or 1.0
    reach, free = (float(np.abs(one.axes.T @ v) @ one.size) for v in (down, y))
    wide = min(WIDTH, free)
    # An end lies flush with a slanted face only if its edge runs along that.
    turns = (True, False) if max(abs(plank.axes[:, 2] @ down) for plank in (one, other)) < 1e-9 else (False,)
    for across, away, along in product(turns, AWAY, ALONG):
        high, broad = (wide, float(third.size[2])) if across else (float(third.size[2]), wide)
        if along and free - broad < 1e-3:
            continue
        offset = 0.5 * third.size[2] + 0.5 * high + 1e-3 + away * reach
        place = p + down * offset + y * ((one.centre - p) @ y + 0.5 * along * (free - broad))
        ends = [_met(plank, place, way) for plank in (one, other)]
        if ends[0] is None or ends[1] is None or (ends[1] - ends[0]) @ way <= 0.02:
            continue
        width = (down if across else y) * wide
        yield Plank.between("support", ends[0], ends[1], width, float(third.size[2]), wood=third.wood)


def _met(plank: Plank, place: np.ndarray, way: np.ndarray) -> np.ndarray | None:
    """Where a line meets the middle plane of a plank; None where it misses the plank."""
    slope = way @ plank.axes[:, 2]
    point = place + way * ((plank.centre - place) @ plank.axes[:, 2] / slope)
    inside = np.abs(plank.axes.T @ (point - plank.centre))[:2] < 0.5 * plank.size[:2]
    return point if abs(slope) > 1e-3 and inside.all() else None


def _with(piece: Piece, plank: Plank, i: int, j: int) -> Piece:
    """The piece with a plank more, its ends against planks i and j; they are drawn to the middle of those."""
    new, fastener = len(piece.planks), piece.joints[0].fastener
    ways = (1.0 if piece.planks[p].axes[:, 2] @ (plank.centre - piece.planks[p].centre) > 0 else -1.0 for p in (i, j))
    faces = [5 if way > 0 else 4 for way in ways]
    joints = (Joint(new, 0, i, faces[0], fastener), Joint(new, 1, j, faces[1], fastener))
    return replace(piece, planks=(*piece.planks, plank), joints=(*piece.joints, *joints))
