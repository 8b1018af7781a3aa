"""Small pieces whose statics is worked by hand: benches, a stool, a ladder, a block; and pieces in a mirror."""

import numpy as np
from restshape_apps.furniture.pieces import cantilever
from restshape_apps.furniture.shape.planks import Foot, Joint, Piece, Plane, Plank, feet_near, joints_near, weight

THIN = 1e-4
"""Thickness of legs that stand on a line or a point [m]."""


def bench(place: float = 0.1, mu: float = 0.5, kilograms: float = 20.0, leg: float = THIN) -> Piece:
    """A board on two upright ones, 1 m apart, with a mass at `place` [m] from the middle; the legs stand on lines."""
    high, t = 0.5, 0.02
    top = Plank.between("top", (-0.6, 0, high + t / 2), (0.6, 0, high + t / 2), (0, 0.3, 0), t, wood="pine")
    legs = [Plank.between(f"leg {k}", (x, 0, 0), (x, 0, high), (0, 0.3, 0), leg) for k, x in ((1, -0.5), (2, 0.5))]
    planks = (top, *legs)
    put = weight("weight", 0, kilograms, (place / 1.2, 0.0, 0.0))
    return Piece(planks, joints_near(planks), feet_near(planks), (Plane(mu=mu),), (put,))


def stretched(place: float, kilograms: float = 70.0) -> Piece:
    """A bench of 18 mm with a stretcher between its legs 0.7 m apart, and a mass at `place` [m] from the middle."""
    t, sides = 0.018, {"left": -0.35, "right": 0.35}
    seat = Plank.between("seat", (-0.5, 0, 0.45 + t / 2), (0.5, 0, 0.45 + t / 2), (0, 0.3, 0), t, wood="pine")
    legs = [Plank.between(name, (x, 0, 0), (x, 0, 0.45), (0, 0.26, 0), t, wood="pine") for name, x in sides.items()]
    rail = Plank.between("rail", (-0.35 + t / 2, 0, 0.15), (0.35 - t / 2, 0, 0.15), (0, 0.2, 0), t, wood="pine")
    planks = (seat, *legs, rail)
    joints = joints_near(planks, fastener="screw")
    return Piece(planks, joints, feet_near(planks), weights=(weight("sitter", 0, kilograms, (place, 0.0, 0.5)),))


def stool(
    feet: list[tuple[float, float]],
    at: tuple[float, float],
    kilograms: float = 10.0,
    short: int = -1,
    mu: float = 0.5,
    width: tuple[float, float, float] = (0.0, THIN, 0.0),
) -> Piece:
    """A square board of 1 m on legs that stand on points, with a mass at `at`; leg `short` misses the floor."""
    high, t = 0.4, 0.02
    top = Plank.between("top", (-0.5, 0, high + t / 2), (0.5, 0, high + t / 2), (0, 1.0, 0), t, wood="pine")
    legs = [
        Plank.between(f"leg {k}", (x, y, 0.01 if k == short else 0.0), (x, y, high), width, THIN)
        for k, (x, y) in enumerate(feet)
    ]
    planks = (top, *legs)
    put = weight("weight", 0, kilograms, (at[0], at[1], 0.0))
    return Piece(planks, joints_near(planks), feet_near(planks), (Plane(mu=mu),), (put,))


def ladder(angle: float, mu: float, length: float = 1.0) -> Piece:
    """A plank that leans against a smooth wall."""
    end = (length * np.cos(angle), 0.0, length * np.sin(angle))
    plank = Plank.between("ladder", (0, 0, 0), end, (0, 0.3, 0), 1e-7)
    wall = Plane((end[0], 0.0, 0.0), (-1.0, 0.0, 0.0), 0.0)
    return Piece((plank,), (), (Foot(0, 0, 0), Foot(0, 1, 1)), (Plane(mu=mu), wall))


def block(base: float, high: float, mu: float, incline: float = 0.0) -> Piece:
    """A plank that stands on its end, on a plane of that incline."""
    up = np.array([np.sin(incline), 0.0, np.cos(incline)])
    plank = Plank.between("block", (0, 0, 0), tuple(high * up), (0, 0.4, 0), base)
    return Piece((plank,), (), (Foot(0, 0, 0),), (Plane((0, 0, 0), tuple(up), mu),))


def placed(place: float, kilograms: float = 30.0) -> Piece:
    """A board of 1.2 m that lies flat on the floor, with a mass at `place` [m] from its middle."""
    board = Plank.between("board", (-0.6, 0, 0.009), (0.6, 0, 0.009), (0, 0.2, 0), 0.018, wood="pine")
    return Piece((board,), (), feet_near((board,)), (Plane(),), (weight("mass", 0, kilograms, (place / 1.2, 0, 0.5)),))


def nailed_along(kilograms: float) -> Piece:
    """A shelf of 1 m nailed all along its long side to a board that stands behind it, with a mass in its middle."""
    back = Plank.between("back", (-0.5, 0, 0), (-0.5, 0, 0.6), (0, 1.2, 0), 0.018)
    shelf = Plank.between("shelf", (-0.491, 0, 0.3), (-0.291, 0, 0.3), (0, 1.0, 0), 0.012)
    planes = (Plane(), Plane((0.0, 0.0, 0.6), (0.0, 0.0, -1.0)))
    feet = (Foot(0, 0, 0), Foot(0, 1, 1))
    loads = (weight("mass", 1, kilograms, (0.0, 0.0, 0.5)),)
    return Piece((back, shelf), joints_near((back, shelf)), feet, planes, loads)


def toppling(kilograms: float = 2.0) -> Piece:
    """A nail cantilever with so long an arm that its load lies beyond its foot."""
    return cantilever(width=0.08, arm=0.6, kilograms=kilograms, fastener="nail-thesis")


def mirrored(piece: Piece) -> Piece:
    """The piece in the mirror x = 0; the thickness of its planks points the other way."""
    flip = np.diag([-1.0, 1.0, 1.0])
    other = {4: 5, 5: 4}
    planks = tuple(
        Plank(p.name, flip @ p.centre, flip @ p.axes @ np.diag([1.0, 1.0, -1.0]), p.size, p.wood) for p in piece.planks
    )
    joints = tuple(Joint(j.i, j.side, j.j, other[j.face], j.fastener) for j in piece.joints)
    loads = tuple(
        weight(w.name, w.plank, w.force[2] / -9.80665, (w.place[0], w.place[1], -w.place[2])) for w in piece.weights
    )
    feet = tuple(Foot(f.plank, other.get(f.side, f.side), f.plane) for f in piece.feet)
    return Piece(planks, joints, feet, piece.planes, loads, spacing=piece.spacing)
