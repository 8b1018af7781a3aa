"""Bending and deflection of planks by beam theory, from the forces that an equilibrium of rigid planks gives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from restshape_apps.furniture.physics.fasteners import wood
from restshape_apps.furniture.physics.furniture import Forces, Furniture, Geometry
from restshape_apps.furniture.physics.plank_beam import Action, Actions, Line, cross, deflection
from restshape_apps.furniture.physics.plank_findings import ACROSS, OVERBENT, load_case
from restshape_apps.furniture.shape.planks import Piece, on_floor_without

from restshape.findings import Finding

STATIONS = 201


@dataclass(frozen=True)
class AxisBending:
    """Bending of a plank along one of its two sides.

    Args:
        s: (k,) stations along the side from the plank's middle [m].
        moment: (k,) bending moment [N m].
        deflection: (k,) along the plank's normal, or its shorter side, 0 at the outermost places that support it [m].
    """

    s: np.ndarray
    moment: np.ndarray
    deflection: np.ndarray


@dataclass(frozen=True)
class PlankBending:
    """What bends a plank, out of its plane and in it.

    Args:
        along: bending along its first and its second axis; deflections of the two add up.
        on_edge: bending in its plane along its longer side, whose deflection is along the shorter one.
        max_deflection: the largest deflection, of both ways together [m].
        stress: the largest bending stress, of both ways together [Pa].
        utilisation: of its bending strength, in parts of it.
        across: whether the strength is that across its fibres.
    """

    along: tuple[AxisBending, AxisBending]
    on_edge: AxisBending
    max_deflection: float
    stress: float
    utilisation: float
    across: bool = False


def plank_bending(furniture: Furniture, plank: int, case: int = 0) -> PlankBending:
    """Bending of one plank of the piece as it is, under the forces of a case that was just tested.

    The plank is an Euler-Bernoulli beam along each of its two sides, of its whole extent across that side; both bear
    all loads, and their deflections add up. A support holds the plank straight along the line in which it runs, so
    that a plank bends between its supports, or away from a single one. Where supports run along both sides, those along
    one bear all: the way with less deflection counts. Its weight is spread evenly, a joint's force over the part of the
    beam along which the joint runs. A plank that lies on the floor is pushed where it would go through it. Joints
    support it to whose other plank a way of joints leads from the floor past this one; what hangs on it loads it.

    Forces in its plane bend it along its longer side, on edge, as a beam as deep as the shorter one. Stresses of both
    ways add up at its corners. Fibres of solid wood run along the first axis: across them it is less stiff and strong.

    Args:
        furniture: the model, tested at no change of its design parameters.
        plank: its number.
        case: of the loads.
    """
    board = furniture.piece.planks[plank]
    thickness, material = float(board.size[2]), wood(board.wood)
    moduli, strengths = (material.E, material.modulus_across), (material.bending, material.strength_across)
    geometry = furniture.geometry()
    rows = [_rows(furniture, plank, case, a, geometry) for a in (0, 1)]
    weighs = geometry.mass[plank] * np.array(furniture.piece.gravity)
    beams = [_actions(furniture.piece, plank, a, rows[a], weighs) for a in (0, 1)]
    second = [float(board.size[1 - a]) * thickness**3 / 12.0 for a in (0, 1)]
    bent = [_bent(beams[a], moduli[a] * second[a]) for a in (0, 1)]
    longer = int(board.size[1] > board.size[0])
    deep = float(board.size[1 - longer])
    _, on_edge = _bent(
        _on_edge(furniture.piece, plank, longer, rows[longer], weighs), moduli[longer] * thickness * deep**3 / 12.0
    )
    at_edge = on_edge.s, 6.0 * np.abs(on_edge.moment) / (thickness * deep**2)
    ways = [way for way in ((bent[0][0], bent[1][1]), (bent[0][1], bent[1][0])) if None not in way]
    largest = [_largest(way, on_edge, longer) for way in ways]
    stresses = [
        [
            _largest_stress(one, 0.5 * thickness / second[a], at_edge if a == longer else None)
            for a, one in enumerate(way)
        ]
        for way in ways
    ]
    least = int(np.argmin(largest))
    used = [[stress / strength for stress, strength in zip(of_way, strengths, strict=True)] for of_way in stresses]
    weakest = min(range(len(ways)), key=lambda k: max(used[k]))
    side = int(np.argmax(used[weakest]))
    across = side == 1 and not material.panel
    return PlankBending(ways[least], on_edge, largest[least], stresses[weakest][side], used[weakest][side], across)


def overbent(piece: Piece, bent: Mapping[int, Sequence[PlankBending]]) -> list[Finding]:
    """Planks that bend beyond their strength, each under the load case that bends it most, the worst first.

    Args:
        piece: whose planks they are.
        bent: by the number of a plank, its bending in each load case.
    """
    utilisation = {(k, case): one.utilisation for k, cases in bent.items() for case, one in enumerate(cases)}
    worst = [(k, max(range(len(cases)), key=lambda case: utilisation[k, case])) for k, cases in bent.items()]
    worst = sorted((one for one in worst if utilisation[one] > 1.0), key=lambda one: -round(utilisation[one], 6))
    return [
        Finding(
            OVERBENT,
            ACROSS if bent[k][case].across else "",
            (piece.planks[k].name,),
            utilisation[k, case],
            1.0,
            case=load_case(piece, case),
        )
        for k, case in worst
    ]


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


def _largest(way: tuple[AxisBending, AxisBending], on_edge: AxisBending, longer: int) -> float:
    """The largest deflection [m]: the sum of two along the normal, and in the plane what there is beside them."""
    one, other = way[longer], way[1 - longer].deflection
    out = np.maximum(np.abs(one.deflection + other.max()), np.abs(one.deflection + other.min()))
    if not on_edge.deflection.any():
        return float(out.max())
    s = np.union1d(one.s, on_edge.s)
    return float(np.hypot(np.interp(s, one.s, out), np.interp(s, on_edge.s, on_edge.deflection)).max())


def _largest_stress(bent: AxisBending, lever: float, at_edge: tuple[np.ndarray, np.ndarray] | None) -> float:
    """The largest stress [Pa] of a moment over `lever` [1/m^3], with what bending on edge adds at places (k,) [m]."""
    stress = lever * np.abs(bent.moment)
    if at_edge is None or not at_edge[1].any():
        return float(stress.max())
    s = np.union1d(bent.s, at_edge[0])
    return float((np.interp(s, bent.s, stress) + np.interp(s, *at_edge)).max())


def _actions(piece: Piece, plank: int, a: int, rows: Sequence[Action], weighs: np.ndarray) -> Actions:
    """What acts on a plank as a beam along its axis a, with the floor on which it lies."""
    board, bed = piece.planks[plank], _bed(piece, plank)
    # Friction of a floor acts on the face that lies on it, below what it holds.
    centre = board.centre if bed is None else board.end(bed)
    line = Line(centre, board.axes[:, a], board.axes[:, 2], float(board.size[a]))
    beam = Actions.on(line, rows, float(weighs @ line.normal) / line.length)
    if bed is None:
        return beam
    up = -1.0 if bed == 5 else 1.0
    # A floor that cannot hold what acts leaves no beam to bend.
    lying = None if beam.presses(up) else beam.on_floor(up)
    return lying or Actions.on(line, [], 0.0)


def _on_edge(piece: Piece, plank: int, a: int, rows: Sequence[Action], weighs: np.ndarray) -> Actions:
    """What acts on a plank as a beam along its axis a that bends in its plane, but for one that lies on a floor."""
    board = piece.planks[plank]
    line = Line(board.centre, board.axes[:, a], board.axes[:, 1 - a], float(board.size[a]))
    if _bed(piece, plank) is not None:
        return Actions.on(line, [], 0.0)
    return Actions.on(line, rows, float(weighs @ line.normal) / line.length)


def _bed(piece: Piece, plank: int) -> int | None:
    """The face with which a plank lies on the floor, if it does."""
    return next((foot.side for foot in piece.feet if foot.plank == plank and foot.side >= 4), None)


def _rows(furniture: Furniture, plank: int, case: int, a: int, geometry: Geometry) -> list[Action]:
    """What joints, feet that are edges and loads do to a plank, spread along its axis a."""
    board, piece = furniture.piece.planks[plank], furniture.piece
    forces, along = furniture.forces(case), board.axes[:, a]
    rows = [*_joints(piece, plank, along, geometry, forces), *_feet(piece, plank, along, a, geometry, forces)]
    for k, load in enumerate((*piece.weights, *piece.pushes)):
        if load.plank == plank:
            at = board.centre + board.axes @ (np.array(load.place) * board.size)
            rows.append(Action(at, 0.0, furniture.cases[case, k], np.zeros(3)))
    return rows


def _joints(piece: Piece, plank: int, along: np.ndarray, geometry: Geometry, forces: Forces) -> list[Action]:
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
        length, cosine = float(geometry.length[k]), float(abs(geometry.y[k] @ along))
        holds = (joint.j if joint.i == plank else joint.i) in borne
        # A line across holds no part of the beam straight, nor does one at 45 degrees either of the two beams.
        straight = length * max(0.0, 2.0 * cosine**2 - 1.0)
        rows.append(Action(geometry.p[k], length * cosine, sign * h, -sign * c, holds, straight))
    return rows


def _feet(piece: Piece, plank: int, along: np.ndarray, a: int, geometry: Geometry, forces: Forces) -> list[Action]:
    """What the floor does to the edges with which a plank stands on it."""
    rows = []
    for k, foot in enumerate(piece.feet):
        if foot.plank != plank or foot.side >= 4:
            continue
        points, pushes = geometry.contacts[4 * k : 4 * k + 4], forces.contacts[4 * k : 4 * k + 4]
        middle, span = points.mean(axis=0), float(np.ptp(points @ along))
        couple = cross(points - middle, pushes).sum(axis=0)
        rows.append(Action(middle, span, pushes.sum(axis=0), couple, True, span if foot.side // 2 != a else 0.0))
    return rows
