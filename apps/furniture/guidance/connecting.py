"""Suggestions that make one piece of parts: a part is moved until an end of it meets a face, or a face an end."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from restshape_apps.furniture.guidance import amounts
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, Furniture
from restshape_apps.furniture.shape.free_ends import free_ends, half_thick, onto
from restshape_apps.furniture.shape.plank_edits import connected
from restshape_apps.furniture.shape.planks import FLUSH, LEAST_SLANT, SIDES, Piece, Plank, parts_of

from restshape.errors import UserError

TESTED = 2
"""Moves tested in full for each suggestion that is shown."""


@dataclass(frozen=True)
class Connection:
    """A part moved to the rest.

    Args:
        words: what it does.
        piece: with the part where it is joined.
        way: (3,) how far that is [m].
        flaws: what the full test still finds.
        free: ends of the part that nothing holds there, near a face; 1 at least where it sticks out by one end alone.
        name: its kind.
    """

    words: str
    piece: Piece
    way: np.ndarray
    flaws: int
    free: int = 0
    name: str = "a part joined"


def connections(piece: Piece, shown: int = 8) -> tuple[Connection, ...]:
    """Moves of a part as a whole that join it to the rest; those that leave nothing wrong first, then the shortest.

    Args:
        piece: in parts, its joints closed.
        shown: at most so many.
    """
    others = parts_of(piece)[1:]
    ways: dict[tuple[int, ...], tuple[Sequence[int], np.ndarray]] = {}
    for part in others:
        for way in _ways(piece, part):
            ways.setdefault((part[0], *np.round(way, 4).tolist()), (part, way))
    nearest = sorted(ways.values(), key=lambda one: float(np.linalg.norm(one[1])))
    tried = (_joined(piece, part, way) for part, way in nearest[: TESTED * shown])
    found = [one for one in tried if one and len(parts_of(one.piece)) <= len(others)]
    return tuple(sorted(found, key=lambda one: one.flaws != 0)[:shown])


def same_place(one: Piece, other: Piece) -> bool:
    """Whether all planks of two pieces are where those of the other are."""
    pairs = zip(one.planks, other.planks, strict=True)
    return all(np.allclose(a.corners(), b.corners(), rtol=0.0, atol=FLUSH) for a, b in pairs)


def _joined(piece: Piece, part: Sequence[int], way: np.ndarray) -> Connection | None:
    """The piece with a part moved and joined; None where that is no joint."""
    try:
        joined = Furniture(_moved(piece, part, way)).moved()
        flaws = Furniture(joined).test().flaws
    except UserError:
        # The fastener does not suit these planks.
        return None
    if flaws & (LOST | OVERLAPPING):
        return None
    alone = _alone(joined, part)
    words = _words(piece, joined, part, way) + (f" by its end {alone} alone: it sticks out there" if alone else "")
    return Connection(words, joined, way, flaws, max(len(free_ends(joined, part)), int(bool(alone))))


def _alone(piece: Piece, part: Sequence[int]) -> str:
    """The end of a plank, its only joint, by which it sticks out of the piece; empty where it is no such plank."""
    joints = [joint for joint in piece.joints if joint.i in part or joint.j in part]
    standing = any(foot.plank in part for foot in piece.feet)
    if len(part) > 1 or standing or len({(joint.i, joint.side) for joint in joints}) > 1 or joints[0].i not in part:
        return ""
    along = int(np.argmax(piece.planks[part[0]].size[:2]))
    return SIDES[joints[0].side] if joints[0].side // 2 == along else ""


def _ways(piece: Piece, part: Sequence[int]) -> Iterator[np.ndarray]:
    """Moves (3,) of a part that bring an end to a face, one of both being the part's."""
    taken = {(joint.i, joint.side) for joint in piece.joints}
    standing = {(foot.plank, foot.side) for foot in piece.feet}
    for i, plank in enumerate(piece.planks):
        for j, other in enumerate(piece.planks):
            if (i in part) is (j in part):
                continue
            for side in range(4):
                if (i, side) in taken | (standing if i not in part else set()):
                    continue
                way = _to_face(plank, side, other)
                if way is not None:
                    yield way if i in part else -way


def _to_face(plank: Plank, side: int, other: Plank) -> np.ndarray | None:
    """The shortest move (3,) of an end into the face of another plank that it looks at; None if it cannot lie in it."""
    axis = plank.axes[:, side // 2] * (1.0 if side % 2 else -1.0)
    slope = float(axis @ other.axes[:, 2])
    half = np.abs(other.axes.T @ plank.axes[:, 1 - side // 2]) * 0.5 * plank.size[1 - side // 2]
    if abs(slope) <= LEAST_SLANT or half[2] > FLUSH:
        return None
    place = other.axes.T @ (plank.end(side) - other.centre)
    # All of the end lies on the face, its thickness too.
    along = onto(place[:2], half[:2] + half_thick(plank, other), other.size[:2])
    return other.axes @ np.array([*along, -np.sign(slope) * 0.5 * other.size[2] - place[2]])


def _moved(piece: Piece, part: Sequence[int], way: np.ndarray) -> Piece:
    """The piece with a part moved, and joined to what it has come near."""
    planks = tuple(replace(p, centre=p.centre + way) if k in part else p for k, p in enumerate(piece.planks))
    feet = tuple(foot for foot in piece.feet if foot.plank not in part)
    moved = replace(piece, planks=planks, feet=feet)
    fastener = piece.joints[0].fastener if piece.joints else "nail-thesis"
    for plank in part:
        moved = connected(moved, plank, fastener=fastener)
    return moved


def _words(piece: Piece, joined: Piece, part: Sequence[int], way: np.ndarray) -> str:
    """What a move of a part does, and what it is joined to."""
    name = piece.planks[part[0]].name + (f" with {len(part) - 1} more" if len(part) > 1 else "")
    new = joined.joints[len(piece.joints) :]
    met = dict.fromkeys(joined.planks[k].name for joint in new for k in (joint.i, joint.j) if k not in part)
    to = f"joined to {' and '.join(met)}"
    far = float(np.linalg.norm(way))
    if far < FLUSH:
        return f"{name} {to} where it is"
    by = ", ".join(str(round(1e3 * x)) for x in way.tolist())
    return f"{name} moved {amounts.amount(far, 'm')}, by ({by}) mm, and {to}"
