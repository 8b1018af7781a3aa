"""Bending and deflection of planks by beam theory, from the forces that an equilibrium of rigid planks gives."""

from dataclasses import dataclass, replace

import numpy as np
from restshape_apps.furniture.physics.fasteners import wood
from restshape_apps.furniture.physics.furniture import Forces, Furniture, Geometry
from restshape_apps.furniture.physics.plank_beam import Action, Actions, Line, cross, deflection
from restshape_apps.furniture.shape.planks import Piece, on_floor_without

STATIONS = 201


@dataclass(frozen=True)
class AxisBending:
    """Bending of a plank along one of its two sides.

    Args:
        s: (k,) stations along the side from the plank's middle [m].
        moment: (k,) bending moment [N m].
        deflection: (k,) along the plank's normal, 0 at the outermost places that support it [m].
    """

    s: np.ndarray
    moment: np.ndarray
    deflection: np.ndarray


@dataclass(frozen=True)
class PlankBending:
    """What bends a plank out of its plane.

    Args:
        along: bending along its first and its second axis; deflections of the two add up.
        max_deflection: the largest deflection [m].
        stress: the largest bending stress [Pa].
        utilisation: of its bending strength, in parts of it.
    """

    along: tuple[AxisBending, AxisBending]
    max_deflection: float
    stress: float
    utilisation: float


def plank_bending(furniture: Furniture, plank: int, case: int = 0) -> PlankBending:
    """Bending of one plank of the piece as it is, under the forces of a case that was just tested.

    The plank is an Euler-Bernoulli beam along each of its two sides, of its whole extent across that side; both bear
    all loads, and their deflections add up. A support holds the plank straight along the line in which it runs, so
    that a plank bends between its supports, or away from a single one. Where supports run along both sides, those along
    one bear all: the way with less deflection counts. Its weight is spread evenly, a joint's force over the part of the
    beam along which the joint runs. A plank that lies on the floor is pushed where it would go through it. Joints
    support it to whose other plank a way of joints leads from the floor past this one; what hangs on it loads it.

    Args:
        furniture: the model, tested at no change of its design parameters.
        plank: its number.
        case: of the loads.
    """
    board = furniture.piece.planks[plank]
    thickness, material = float(board.size[2]), wood(board.wood)
    found = furniture.geometry(), furniture.forces(case)
    beams = [_actions(furniture, plank, case, a, *found) for a in (0, 1)]
    second = [float(board.size[1 - a]) * thickness**3 / 12.0 for a in (0, 1)]
    bent = [_bent(beams[a], material.E * second[a]) for a in (0, 1)]
    ways = [way for way in ((bent[0][0], bent[1][1]), (bent[0][1], bent[1][0])) if None not in way]
    largest = [_largest(way) for way in ways]
    stresses = [
        max(float(np.abs(one.moment).max()) * 0.5 * thickness / second[a] for a, one in enumerate(way)) for way in ways
    ]
    least, stress = int(np.argmin(largest)), min(stresses)
    return PlankBending(ways[least], largest[least], stress, stress / material.bending)


def _bent(beam: Actions, stiffness: float) -> tuple[AxisBending | None, AxisBending]:
    """Bending of a beam of a stiffness [N m^2], by supports across it alone if there are any, and held straight too."""
    across, s = beam.borne_across(), beam.stations(STATIONS)

    def bent(moment: np.ndarray, constrained: np.ndarray) -> AxisBending:
        return AxisBending(s, moment, deflection(s, moment / stiffness, constrained))

    moment = beam.moments(s)
    if across is beam:
        free = bent(moment, beam.constrained())
        return free, free
    straight = bent(np.where(beam.straightened(s), 0.0, moment), beam.constrained())
    if across is None:
        return None, straight
    # The more of the beam supports along it take, the less its deflection is measured from them.
    part, moment = float(beam.straight.max()) / beam.length, across.moments(s)
    one, other = bent(moment, beam.constrained()), bent(moment, beam.constrained(across=True))
    return replace(one, deflection=(1.0 - part) * one.deflection + part * other.deflection), straight


def _largest(way: tuple[AxisBending, AxisBending]) -> float:
    """The largest sum of two deflections [m]."""
    return float(max(abs(sum(sign(one.deflection) for one in way)) for sign in (np.max, np.min)))


def _actions(furniture: Furniture, plank: int, case: int, a: int, geometry: Geometry, forces: Forces) -> Actions:
    """What acts on a plank as a beam along its axis a, with the floor on which it lies."""
    board, piece = furniture.piece.planks[plank], furniture.piece
    bed = next((foot.side for foot in piece.feet if foot.plank == plank and foot.side >= 4), None)
    # Friction of a floor acts on the face that lies on it, below what it holds.
    centre = board.centre if bed is None else board.end(bed)
    line = Line(centre, board.axes[:, a], board.axes[:, 2], float(board.size[a]))
    rows = [*_joints(piece, plank, line, geometry, forces), *_feet(piece, plank, line, a, geometry, forces)]
    for k, load in enumerate((*piece.weights, *piece.pushes)):
        if load.plank == plank:
            at = board.centre + board.axes @ (np.array(load.place) * board.size)
            rows.append(Action(at, 0.0, furniture.cases[case, k], np.zeros(3)))
    weight = geometry.mass[plank] * np.array(piece.gravity)
    beam = Actions.on(line, rows, float(weight @ line.normal) / line.length)
    if bed is None:
        return beam
    up = -1.0 if bed == 5 else 1.0
    # A floor that cannot hold what acts leaves no beam to bend.
    lying = None if beam.presses(up) else beam.on_floor(up)
    return lying or Actions.on(line, [], 0.0)


def _joints(piece: Piece, plank: int, line: Line, geometry: Geometry, forces: Forces) -> list[Action]:
    """What joints do to a plank."""
    rows, borne = [], on_floor_without(piece, plank)
    for k, joint in enumerate(piece.joints):
        if plank not in (joint.i, joint.j):
            continue
        # Joint forces are those that pull i back to j.
        sign = -1.0 if joint.i == plank else 1.0
        frame = np.stack([geometry.n[k], geometry.x[k], geometry.y[k]])
        h = np.array([forces.tension[k], *forces.shear[k]]) @ frame
        # The rotation of j seen from i opens a joint, so that its couple has the other sign.
        c = np.array([forces.twist[k, 1], forces.twist[k, 0], forces.bending[k]]) @ frame
        length, cosine = float(geometry.length[k]), float(abs(geometry.y[k] @ line.along))
        holds = (joint.j if joint.i == plank else joint.i) in borne
        # A line across holds no part of the beam straight, nor does one at 45 degrees either of the two beams.
        straight = length * max(0.0, 2.0 * cosine**2 - 1.0)
        rows.append(Action(geometry.p[k], length * cosine, sign * h, -sign * c, holds, straight))
    return rows


def _feet(piece: Piece, plank: int, line: Line, a: int, geometry: Geometry, forces: Forces) -> list[Action]:
    """What the floor does to the edges with which a plank stands on it."""
    rows = []
    for k, foot in enumerate(piece.feet):
        if foot.plank != plank or foot.side >= 4:
            continue
        points, pushes = geometry.contacts[4 * k : 4 * k + 4], forces.contacts[4 * k : 4 * k + 4]
        middle, span = points.mean(axis=0), float(np.ptp(points @ line.along))
        couple = cross(points - middle, pushes).sum(axis=0)
        rows.append(Action(middle, span, pushes.sum(axis=0), couple, True, span if foot.side // 2 != a else 0.0))
    return rows
