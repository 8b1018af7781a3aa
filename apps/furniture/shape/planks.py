"""Pieces of furniture as data: planks, nail joints, feet on planes, weights and pushes."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import product

import numpy as np

from restshape.errors import UserError

SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")
"""Sides of a plank by their number: four ends, then the two faces."""

CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
"""The corners of a plank (8, 3), in parts of its size from its centre."""

FREEDOMS = ("move x", "move y", "move z", "turn x", "turn y", "turn z", "length x", "length y")
"""Design parameters of a plank by their number, along and about its own axes."""


@dataclass(frozen=True)
class Plank:
    """A rigid board.

    Args:
        name: what people call it.
        centre: (3,) [m].
        axes: (3, 3) its axes as columns: the third is normal to its faces.
        size: (3,) lengths along its axes [m]; the third is its thickness.
        wood: a name in `physics/woods.toml`.
    """

    name: str
    centre: np.ndarray
    axes: np.ndarray
    size: np.ndarray
    wood: str = "mdf"

    @classmethod
    def between(
        cls, name: str, start: Sequence[float], end: Sequence[float], width: Sequence[float], thickness: float, **more
    ) -> "Plank":
        """A plank whose middle line runs from `start` to `end`, with the width as a vector (3,) across it [m].

        Raises:
            UserError: the width lies along the line, or one of them has no length.
        """
        start, end, width = (np.array(v, dtype=float) for v in (start, end, width))
        along, length = end - start, float(np.linalg.norm(end - start))
        across = width - along * (along @ width) / max(length * length, 1e-300)
        size = float(np.linalg.norm(across))
        if length == 0.0 or size <= 1e-9 * length:
            raise UserError(*_no_plank(length, float(np.linalg.norm(width)), name))
        x, y = along / length, across / size
        return cls(
            name, (start + end) / 2, np.stack([x, y, np.cross(x, y)], 1), np.array([length, size, thickness]), **more
        )

    def end(self, side: int) -> np.ndarray:
        """The middle (3,) of a side [m]."""
        sign = 1.0 if side % 2 else -1.0
        return self.centre + self.axes[:, side // 2] * (0.5 * sign * self.size[side // 2])

    def corners(self) -> np.ndarray:
        """Its eight corners (8, 3) [m]."""
        return self.centre + (CORNERS * self.size) @ self.axes.T


def _no_plank(length: float, width: float, name: str) -> tuple[str, str, str]:
    """What is wrong with two lines that make no plank, of which, and what to do; their lengths are in metres."""
    if length == 0.0:
        return "its middle line has no length: it ends where it begins", name, "let it go from one point to another one"
    if width <= 1e-9 * length:
        return "its width has no length", name, "draw a width across its middle line, as long as the plank is wide"
    return "its width lies along its middle line", name, "draw its width across its middle line"


@dataclass(frozen=True)
class Joint:
    """Plank `i` with its end `side` (0 to 3) against the face (4 or 5) of plank `j`, through which the fasteners go."""

    i: int
    side: int
    j: int
    face: int
    fastener: str = "nail-thesis"


@dataclass(frozen=True)
class Plane:
    """A fixed plane: a point (3,), its unit normal (3,), and the coefficient of friction mu on it."""

    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    normal: tuple[float, float, float] = (0.0, 0.0, 1.0)
    mu: float = 0.5


@dataclass(frozen=True)
class Foot:
    """A side of a plank that stands on a plane."""

    plank: int
    side: int
    plane: int = 0


@dataclass(frozen=True)
class Load:
    """A dead force (3,) [N] at a place (3,) of a plank, in parts of its size from its centre."""

    name: str
    plank: int
    place: tuple[float, float, float]
    force: tuple[float, float, float]


GRAVITY = (0.0, 0.0, -9.80665)

NEAR = 0.015
"""How near an end must be to a face to be joined to it [m]."""


@dataclass(frozen=True)
class Piece:
    """A piece of furniture. It must bear its weights alone, and with each of its pushes.

    Args:
        planks, joints, feet: what it is made of and stands on.
        planes: the floor first.
        weights: loads of every case.
        pushes: loads of a case each, beside the weights.
        gravity: (3,) [m/s^2].
        spacing: of fasteners along a joint [m].
        reach: how near ends are to faces that they are joined to [m].
        moments: those along joints' lines and about their normals count in the durability of joints.
    """

    planks: tuple[Plank, ...]
    joints: tuple[Joint, ...]
    feet: tuple[Foot, ...]
    planes: tuple[Plane, ...] = (Plane(),)
    weights: tuple[Load, ...] = ()
    pushes: tuple[Load, ...] = ()
    gravity: tuple[float, float, float] = GRAVITY
    spacing: float = 0.02
    name: str = field(default="", compare=False)
    reach: float = NEAR
    moments: bool = False

    @cached_property
    def size(self) -> float:
        """The longest side of its bounding box [m]."""
        corners = np.concatenate([plank.corners() for plank in self.planks])
        return float(np.ptp(corners, axis=0).max())

    @cached_property
    def parts(self) -> tuple[tuple[int, ...], ...]:
        """The planks of each part that joints hold together, the largest first."""
        part = list(range(len(self.planks)))
        for joint in self.joints:
            old, new = part[joint.i], part[joint.j]
            part = [new if one == old else one for one in part]
        found = [tuple(k for k, one in enumerate(part) if one == name) for name in dict.fromkeys(part)]
        return tuple(sorted(found, key=lambda planks: -len(planks)))

    def index(self, name: str) -> int:
        """The number of a plank by its name.

        Raises:
            UserError: there is none of that name.
        """
        for k, plank in enumerate(self.planks):
            if plank.name == name:
                return k
        raise UserError(f"there is no plank {name}", self.name, f"name one of {', '.join(p.name for p in self.planks)}")

    def placed(self, centre: np.ndarray, axes: np.ndarray, size: np.ndarray) -> "Piece":
        """The same piece with its planks at other places: centre (n, 3), axes (n, 3, 3), size (n, 3)."""
        planks = tuple(
            replace(plank, centre=c, axes=q, size=l) for plank, c, q, l in zip(self.planks, centre, axes, size)
        )
        return replace(self, planks=planks)


def weight(name: str, plank: int, kilograms: float, place: Sequence[float] = (0.0, 0.0, 0.5)) -> Load:
    """A mass [kg] put on a plank."""
    return Load(name, plank, tuple(place), (0.0, 0.0, GRAVITY[2] * kilograms))


LEAST_SLANT = 0.25
"""Cosine between a plank and the normal of what its end meets, from which on the two are joined."""

FLUSH = 1e-6
"""How far two faces may be from one plane for an end to be joined to both [m]."""

EDGE = 1e-9
"""How far beside a face the middle of an end may be that is drawn on its very edge [m], as in the kernel."""

LYING = 1e-3
"""How far a side that cannot be lengthened may be from the floor, or lean, to stand on it [m]."""


def joints_near(
    planks: Sequence[Plank],
    near: float = 1e-3,
    among: Iterable[int] | None = None,
    fastener: str = "nail-thesis",
    joints: Sequence[Joint] = (),
    feet: Sequence[Foot] = (),
) -> tuple[Joint, ...]:
    """Joints of all ends that lie near a face of another plank, and come to it from outside.

    An end is joined to the nearest face, and to others in the plane of that one. An end that has a joint already gets
    more of them in its plane only, one that stands on the floor none. Where two planks meet in a corner, each with an
    end at the other's face, they are joined once: by the end that is steeper, else by that of the plank drawn first.

    Args:
        planks: all planks.
        near: how far an end's middle may be from the face, short of it or beyond it [m].
        among: only joints that one of these planks has part in.
        fastener: of the joints.
        joints, feet: that there are already.
    """
    wanted = set(range(len(planks))) if among is None else set(among)
    standing = {(foot.plank, foot.side) for foot in feet}
    found = []
    for i, plank in enumerate(planks):
        for side in range(4):
            if (i, side) in standing:
                continue
            has = [(joint.j, joint.face) for joint in joints if (joint.i, joint.side) == (i, side)]
            there = {i, *(j for j, _ in has)}
            others = [j for j in (range(len(planks)) if i in wanted else wanted) if j not in there]
            spots = [(j, _spot(plank, side, planks[j], near)) for j in others]
            new = [(j, spot[1]) for j, spot in sorted((one for one in spots if one[1]), key=lambda one: one[1][0])]
            first, *_ = [*has, *new, (None, None)]
            found += [
                Joint(i, side, j, face, fastener)
                for j, face in new
                if _in_one_plane(planks[j], face, planks[first[0]], first[1])
            ]
    return _once(planks, found, joints)


def _once(planks: Sequence[Plank], found: Sequence[Joint], joints: Sequence[Joint]) -> tuple[Joint, ...]:
    """What was found, without joints of planks that are joined the other way round: two planes meet in one line."""
    kept = [(joint.i, joint.j) for joint in joints]
    once = []
    for joint in sorted(found, key=lambda one: -round(abs(float(planks[one.i].axes[2, one.side // 2])), 6)):
        if (joint.j, joint.i) not in kept:
            kept.append((joint.i, joint.j))
            once.append(joint)
    return tuple(joint for joint in found if joint in once)


def _spot(plank: Plank, side: int, other: Plank, near: float) -> tuple[float, int] | None:
    """How far an end is from the face of another plank that it comes to [m], and which; None if it meets none."""
    axis = plank.axes[:, side // 2] * (1.0 if side % 2 else -1.0)
    slope = float(axis @ other.axes[:, 2])
    half = 0.5 * plank.size[1 - side // 2] * (other.axes.T @ plank.axes[:, 1 - side // 2])
    if abs(slope) <= LEAST_SLANT or abs(half[2]) > near:
        return None
    face = 5 if slope < 0.0 else 4
    place = other.axes.T @ (plank.end(side) - other.centre)
    # Beyond the face along its normal: what the end is short of it.
    short = (place[2] if face == 5 else -place[2]) - 0.5 * other.size[2]
    if abs(short) > near:
        return None
    # Where the end's middle is once it is closed, and how much of its line then lies on the face.
    place = place + (other.axes.T @ axis) * (short / abs(slope))
    low, high = -1.0, 1.0
    for at, way, size in zip(place[:2], half[:2], other.size[:2]):
        if abs(way) < 1e-9:
            low, high = (low, high) if abs(at) <= 0.5 * size + EDGE else (0.0, 0.0)
            continue
        ends = sorted(((-0.5 * size - at) / way, (0.5 * size - at) / way))
        low, high = max(low, ends[0]), min(high, ends[1])
    return (float(abs(short)), face) if high > low else None


def _in_one_plane(plank: Plank, face: int, other: Plank, other_face: int) -> bool:
    """Whether two faces look the same way and lie in one plane."""
    normal, others = (one.axes[:, 2] * (1.0 if k == 5 else -1.0) for one, k in ((plank, face), (other, other_face)))
    apart = float(normal @ (plank.end(face) - other.end(other_face)))
    lean = float(np.linalg.norm(normal - others)) * max(*plank.size, *other.size)
    return abs(apart) + lean <= FLUSH


def feet_near(
    planks: Sequence[Plank], near: float = LYING, planes: Sequence[Plane] = (Plane(),), joints: Sequence[Joint] = ()
) -> tuple[Foot, ...]:
    """Feet of all sides that lie in a plane.

    Args:
        planks: all planks.
        near: how far an end may be from the plane, or lean, to be meant to stand on it [m]; faces lie in it.
        planes: that planks may stand on.
        joints: whose ends stand on no plane.
    """
    joined = {(joint.i, joint.side) for joint in joints}
    feet = []
    for k, plane in enumerate(planes):
        normal, point = np.array(plane.normal), np.array(plane.point)
        for i, plank in enumerate(planks):
            for side in range(6):
                if (i, side) in joined:
                    continue
                axis = plank.axes[:, side // 2] * (1.0 if side % 2 else -1.0)
                across = [a for a in range(2) if a != side // 2]
                tilt = sum(0.5 * plank.size[a] * abs(plank.axes[:, a] @ normal) for a in across)
                reach = near if side < 4 else min(near, LYING)
                away = abs((plank.end(side) - point) @ normal)
                if axis @ normal < -LEAST_SLANT and away <= reach and tilt <= reach:
                    feet.append(Foot(i, side, k))
    return tuple(feet)


def parts_of(piece: Piece) -> tuple[tuple[int, ...], ...]:
    """The planks of each part that joints hold together, the largest first."""
    return piece.parts


def on_floor_without(piece: Piece, plank: int) -> set[int]:
    """The planks that joints connect with a foot although one plank is away."""
    beside: dict[int, list[int]] = {}
    for joint in piece.joints:
        beside.setdefault(joint.i, []).append(joint.j)
        beside.setdefault(joint.j, []).append(joint.i)
    found, left = {plank}, [foot.plank for foot in piece.feet]
    while left:
        one = left.pop()
        if one not in found:
            found.add(one)
            left += beside.get(one, [])
    return found - {plank}
