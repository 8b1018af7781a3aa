"""Bending and sag of planks by beam theory, from the forces that an equilibrium of rigid planks gives."""

from dataclasses import dataclass

import numpy as np

from restshape.physics.fasteners import wood
from restshape.physics.furniture import Furniture

STATIONS = 201


@dataclass(frozen=True)
class PlankBending:
    """What bends a plank, out of its plane along its longer side.

    Args:
        s: (k,) stations along the plank from its middle [m].
        moment: (k,) bending moment [N m].
        deflection: (k,) along the plank's normal, 0 at the outermost places where it is held [m].
        sag: the largest deflection [m].
        stress: the largest bending stress [Pa].
        use: of its bending strength, in parts of it.
    """

    s: np.ndarray
    moment: np.ndarray
    deflection: np.ndarray
    sag: float
    stress: float
    use: float


def plank_bending(furniture: Furniture, plank: int, case: int = 0) -> PlankBending:
    """Bending of one plank of the piece as it is, under the forces of a case that was just tested.

    The plank is an Euler-Bernoulli beam of its whole width: planks much longer than wide are met best. Its weight is
    spread evenly, a joint's force acts at its middle.

    Args:
        furniture: the model, tested at no change of its design parameters.
        plank: its number.
        case: of the loads.
    """
    board = furniture.piece.planks[plank]
    a = int(np.argmax(board.size[:2]))
    along, normal = board.axes[:, a], board.axes[:, 2]
    length, width, thickness = float(board.size[a]), float(board.size[1 - a]), float(board.size[2])
    at, force, couple, held = _actions(furniture, plank, case)
    arms = at - board.centre
    place = np.clip(arms @ along, -length / 2, length / 2)
    # Moments about the axis that bends the plank, with those of forces along it whose line misses the middle.
    axis = np.cross(along, normal)
    q = force @ normal
    m = couple @ axis + np.cross(arms - place[:, None] * along, force) @ axis
    # The moment may jump at a place: there are stations on both sides of it.
    beside = 1e-9 * length
    s = np.concatenate([np.linspace(-length / 2, length / 2, STATIONS), place - beside, place + beside])
    s = np.unique(np.clip(s, -length / 2 - beside, length / 2 + beside))
    spread = float(furniture.geometry().mass[plank] * np.array(furniture.piece.gravity) @ normal) / length
    right = s[:, None] > place[None, :]
    moment = (right * (q * (s[:, None] - place) - m)).sum(axis=1) + 0.5 * spread * np.clip(
        s + length / 2, 0.0, length
    ) ** 2
    material = wood(board.wood)
    inertia = width * thickness**3 / 12.0
    deflection = _deflection(s, moment / (material.E * inertia), place[held])
    stress = float(np.abs(moment).max() * 0.5 * thickness / inertia)
    return PlankBending(s, moment, deflection, float(np.abs(deflection).max()), stress, stress / material.bending)


def _actions(furniture: Furniture, plank: int, case: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Places (k, 3), forces (k, 3), couples (k, 3) on a plank, and which of them hold it."""
    geometry, forces, piece = furniture.geometry(), furniture.forces(case), furniture.piece
    rows: list[tuple[np.ndarray, np.ndarray, np.ndarray, bool]] = []
    for k, joint in enumerate(piece.joints):
        if plank not in (joint.i, joint.j):
            continue
        # Joint forces are those that pull i back to j.
        sign = -1.0 if joint.i == plank else 1.0
        frame = np.stack([geometry.n[k], geometry.x[k], geometry.y[k]])
        h = np.array([forces.tension[k], *forces.shear[k]]) @ frame
        # The rotation of j seen from i opens a joint, so that its couple has the other sign.
        c = np.array([forces.twist[k, 1], forces.twist[k, 0], forces.bending[k]]) @ frame
        rows.append((geometry.p[k], sign * h, -sign * c, True))
    for k, foot in enumerate(piece.feet):
        if foot.plank == plank:
            for c in range(4 * k, 4 * k + 4):
                rows.append((geometry.contacts[c], forces.contacts[c], np.zeros(3), True))
    for k, load in enumerate((*piece.weights, *piece.pushes)):
        if load.plank == plank:
            board = piece.planks[plank]
            at = board.centre + board.axes @ (np.array(load.place) * board.size)
            rows.append((at, furniture.cases[case, k], np.zeros(3), False))
    if not rows:
        return np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3)), np.zeros(0, dtype=bool)
    at, force, couple, held = zip(*rows)
    return np.array(at), np.array(force), np.array(couple), np.array(held)


def _deflection(s: np.ndarray, curvature: np.ndarray, held: np.ndarray) -> np.ndarray:
    """The integral of a curvature twice, 0 at the outermost places held; held at one, its slope is 0 there too."""
    step = np.diff(s)
    slope = np.concatenate([[0.0], np.cumsum(0.5 * step * (curvature[1:] + curvature[:-1]))])
    # The curvature runs straight between stations.
    rise = slope[:-1] * step + step**2 * (curvature[:-1] / 3.0 + curvature[1:] / 6.0)
    w = np.concatenate([[0.0], np.cumsum(rise)])
    if not len(held):
        return w - np.interp(0.0, s, w)
    first, last = held.min(), held.max()
    w_first, w_last = np.interp([first, last], s, w)
    if last - first > 1e-9:
        return w - w_first - (w_last - w_first) / (last - first) * (s - first)
    return w - w_first - np.interp(first, s, slope) * (s - first)
