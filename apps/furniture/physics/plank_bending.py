"""Bending and deflection of planks by beam theory, from the forces that an equilibrium of rigid planks gives."""

from dataclasses import dataclass

import numpy as np
from restshape_apps.furniture.physics.fasteners import wood
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.physics.plank_beam import Actions, Line, deflection
from restshape_apps.furniture.shape.planks import on_floor_without

STATIONS = 201


@dataclass(frozen=True)
class PlankBending:
    """What bends a plank, out of its plane along its longer side.

    Args:
        s: (k,) stations along the plank from its middle [m].
        moment: (k,) bending moment [N m].
        deflection: (k,) along the plank's normal, 0 at the outermost places that support it [m].
        max_deflection: the largest deflection [m].
        stress: the largest bending stress [Pa].
        utilisation: of its bending strength, in parts of it.
    """

    s: np.ndarray
    moment: np.ndarray
    deflection: np.ndarray
    max_deflection: float
    stress: float
    utilisation: float


def plank_bending(furniture: Furniture, plank: int, case: int = 0) -> PlankBending:
    """Bending of one plank of the piece as it is, under the forces of a case that was just tested.

    The plank is an Euler-Bernoulli beam of its whole width: planks much longer than wide are met best. Its weight is
    spread evenly, a joint's force over the part of the beam along which the joint runs. A plank that lies on the floor
    is pushed where it would go through it; one that stands on a long edge is held along it, and does not bend. Joints
    support it to whose other plank a way of joints leads from the floor past this one; what hangs on it loads it.

    Args:
        furniture: the model, tested at no change of its design parameters.
        plank: its number.
        case: of the loads.
    """
    board = furniture.piece.planks[plank]
    a = int(np.argmax(board.size[:2]))
    length, width, thickness = float(board.size[a]), float(board.size[1 - a]), float(board.size[2])
    bed = _bed(furniture, plank, a)
    # Friction of a floor acts on the face that lies on it, below what it holds.
    centre = board.centre if bed is None else board.end(bed)
    acts = _actions(furniture, plank, case, Line(centre, board.axes[:, a], board.axes[:, 2], length), a)
    if bed is not None:
        acts = acts.on_floor(-1.0 if bed == 5 else 1.0) if bed >= 4 else None
    material, inertia = wood(board.wood), width * thickness**3 / 12.0
    if acts is None:
        s = np.linspace(-length / 2, length / 2, STATIONS)
        return PlankBending(s, np.zeros(STATIONS), np.zeros(STATIONS), 0.0, 0.0, 0.0)
    s = acts.stations(STATIONS)
    moment = acts.moments(s)
    bent = deflection(s, moment / (material.E * inertia), acts.constrained())
    stress = float(np.abs(moment).max() * 0.5 * thickness / inertia)
    return PlankBending(s, moment, bent, float(np.abs(bent).max()), stress, stress / material.bending)


def _bed(furniture: Furniture, plank: int, a: int) -> int | None:
    """The side with which a plank stands on a floor along its longer side a, an edge before a face; None if none."""
    sides = [foot.side for foot in furniture.piece.feet if foot.plank == plank and foot.side // 2 != a]
    return min(sides, default=None)


def _actions(furniture: Furniture, plank: int, case: int, line: Line, a: int) -> Actions:
    """What acts on a plank, but a floor that runs along its longer side a."""
    geometry, forces, piece = furniture.geometry(), furniture.forces(case), furniture.piece
    board = piece.planks[plank]
    rows: list[tuple[np.ndarray, float, np.ndarray, np.ndarray, bool]] = []
    borne = on_floor_without(piece, plank)
    for k, joint in enumerate(piece.joints):
        if plank not in (joint.i, joint.j):
            continue
        # Joint forces are those that pull i back to j.
        sign = -1.0 if joint.i == plank else 1.0
        frame = np.stack([geometry.n[k], geometry.x[k], geometry.y[k]])
        h = np.array([forces.tension[k], *forces.shear[k]]) @ frame
        # The rotation of j seen from i opens a joint, so that its couple has the other sign.
        c = np.array([forces.twist[k, 1], forces.twist[k, 0], forces.bending[k]]) @ frame
        span = float(geometry.length[k] * abs(geometry.y[k] @ line.along))
        holds = (joint.j if joint.i == plank else joint.i) in borne
        rows.append((geometry.p[k], span, sign * h, -sign * c, holds))
    for k, foot in enumerate(piece.feet):
        if foot.plank == plank and foot.side // 2 == a:
            for c in range(4 * k, 4 * k + 4):
                rows.append((geometry.contacts[c], 0.0, forces.contacts[c], np.zeros(3), True))
    for k, load in enumerate((*piece.weights, *piece.pushes)):
        if load.plank == plank:
            at = board.centre + board.axes @ (np.array(load.place) * board.size)
            rows.append((at, 0.0, furniture.cases[case, k], np.zeros(3), False))
    own = float(geometry.mass[plank] * np.array(piece.gravity) @ line.normal) / line.length
    return Actions.on(line, rows, own)
