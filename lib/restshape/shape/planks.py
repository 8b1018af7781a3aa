"""Pieces of furniture as data: planks, nail joints, feet on planes, weights and pushes."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from restshape.errors import UserError

SIDES = ("-x", "+x", "-y", "+y", "-z", "+z")
"""Sides of a plank by their number: four ends, then the two faces."""

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
            UserError: the width is parallel to the line, or one of them has no length.
        """
        start, end, width = (np.array(v, dtype=float) for v in (start, end, width))
        along, length = end - start, float(np.linalg.norm(end - start))
        across = width - along * (along @ width) / max(length * length, 1e-300)
        size = float(np.linalg.norm(across))
        if length == 0.0 or size <= 1e-9 * length:
            raise UserError("the two lines of a plank must have lengths and differ in direction", name)
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
        signs = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
        return self.centre + (signs * self.size) @ self.axes.T


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

    @property
    def size(self) -> float:
        """The longest side of its bounding box [m]."""
        corners = np.concatenate([plank.corners() for plank in self.planks])
        return float(np.ptp(corners, axis=0).max())

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


def joints_near(
    planks: Sequence[Plank], near: float = 1e-3, among: Iterable[int] | None = None, fastener: str = "nail-thesis"
) -> tuple[Joint, ...]:
    """Joints of all ends that lie near a face of another plank.

    Args:
        planks: all planks.
        near: how far an end's middle may be from the face [m].
        among: only joints that one of these planks has part in.
        fastener: of the joints.
    """
    wanted = set(range(len(planks))) if among is None else set(among)
    found = []
    for i, plank in enumerate(planks):
        for side in range(4):
            middle, along = plank.end(side), plank.axes[:, 1 - side // 2]
            for j, other in enumerate(planks):
                if i == j or not {i, j} & wanted:
                    continue
                place = other.axes.T @ (middle - other.centre)
                face = 5 if place[2] > 0 else 4
                half = 0.5 * plank.size[1 - side // 2] * np.abs(other.axes.T @ along)
                if (
                    abs(abs(place[2]) - 0.5 * other.size[2]) <= near
                    and half[2] <= near
                    and np.all(np.abs(place[:2]) - half[:2] < 0.5 * other.size[:2])
                    and np.all(np.abs(place[:2]) <= 0.5 * other.size[:2] + near + half[:2])
                    and abs(plank.axes[:, side // 2] @ other.axes[:, 2]) > 0.25
                ):
                    found.append(Joint(i, side, j, face, fastener))
    return tuple(found)


def feet_near(planks: Sequence[Plank], near: float = 1e-3, planes: Sequence[Plane] = (Plane(),)) -> tuple[Foot, ...]:
    """Feet of all sides that lie in a plane, up to `near` [m]."""
    feet = []
    for k, plane in enumerate(planes):
        normal, point = np.array(plane.normal), np.array(plane.point)
        for i, plank in enumerate(planks):
            for side in range(6):
                axis = plank.axes[:, side // 2] * (1.0 if side % 2 else -1.0)
                across = [a for a in range(2) if a != side // 2]
                tilt = sum(0.5 * plank.size[a] * abs(plank.axes[:, a] @ normal) for a in across)
                if axis @ normal < -0.25 and abs((plank.end(side) - point) @ normal) <= near and tilt <= near:
                    feet.append(Foot(i, side, k))
    return tuple(feet)
