"""Unilateral contact on a floor far stiffer than joints: Coulomb's law by an interior path, in numpy, beside the model.

A path of smooth problems: a contact pressed by p with the friction f has a gap
of tau / p and slides by 2 tau f / (mu^2 p^2 - f^2), and tau goes to 0. Displacements are small, and none is guessed.
"""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.physics.joint_compliance import _springs, compliances, utilisation_range
from restshape_apps.furniture.pieces import shelf_1, stool_chair, table
from restshape_apps.furniture.shape.planks import Piece
from test_joint_compliance import cross


def assembled(furniture: Furniture) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness of the joints, loads of the weights, and the displacements (3 c, 6 n) of contacts, by those of planks;
    a joint yields by 1 for each N."""
    piece, g, n = furniture.piece, furniture.geometry(), len(furniture.piece.planks)
    K, f, rows = np.zeros((6 * n, 6 * n)), np.zeros(6 * n), []
    ratio = furniture.compliance.joint_r / furniture.compliance.joint_t
    for k, joint in enumerate(piece.joints):
        B = np.zeros((6, 6 * n))
        for plank, sign in ((joint.i, 1.0), (joint.j, -1.0)):
            B[:3, 6 * plank : 6 * plank + 6] = sign * np.hstack([np.eye(3), -cross(g.p[k] - g.centre[plank])])
            B[3:, 6 * plank + 3 : 6 * plank + 6] = sign * np.eye(3)
        K += B.T @ (np.array([1.0] * 3 + [1.0 / ratio] * 3)[:, None] * B)
    for k, point in enumerate(g.contacts):
        plank, B = piece.feet[k // 4].plank, np.zeros((3, 6 * n))
        B[:, 6 * plank : 6 * plank + 6] = np.hstack([np.eye(3), -cross(point - g.centre[plank])])
        rows.append(B)
    for k in range(n):
        f[6 * k : 6 * k + 3] += g.mass[k] * np.array(piece.gravity)
    for load in piece.weights:
        arm = g.axes[load.plank] @ (np.array(load.place) * g.size[load.plank])
        f[6 * load.plank : 6 * load.plank + 6] += np.concatenate([load.force, np.cross(arm, load.force)])
    return K, f, np.vstack(rows)


def contact_rows(v: np.ndarray, p: np.ndarray, mu: float, yields: float, tau: float) -> tuple[np.ndarray, np.ndarray]:
    """Residual (c, 3) of the smooth law of contacts on a level floor, and its derivatives (c, 3, 3) by the forces p."""
    left, t = mu**2 * p[:, 2] ** 2 - p[:, 0] ** 2 - p[:, 1] ** 2, p[:, :2]
    r = v + yields * p
    r[:, 2] -= tau / p[:, 2]
    r[:, :2] += 2.0 * tau * t / left[:, None]
    by = np.zeros((len(p), 3, 3))
    by[:, [0, 1, 2], [0, 1, 2]] = yields
    by[:, 2, 2] += tau / p[:, 2] ** 2
    by[:, [0, 1], [0, 1]] += (2.0 * tau / left)[:, None]
    by[:, :2, :2] += 4.0 * tau * t[:, :, None] * t[:, None, :] / left[:, None, None] ** 2
    by[:, :2, 2] -= 4.0 * tau * mu**2 * p[:, 2:] * t / left[:, None] ** 2
    return r, by


def reference_contacts(furniture: Furniture) -> np.ndarray:
    """Forces (c, 3) of the contacts on the planks [N]."""
    K, f, G = assembled(furniture)
    mu, n, c = furniture.piece.planes[0].mu, len(f), len(G) // 3
    weight, yields = -f[2::6].sum(), furniture.compliance.floor / furniture.compliance.joint_t
    u, p, tau = np.zeros(n), np.tile([0.0, 0.0, weight / c], (c, 1)), weight**2 / c
    while tau > 1e-13 * weight**2:
        for _ in range(60):
            r, by = contact_rows((G @ u).reshape(c, 3), p, mu, yields, tau)
            rest = np.concatenate([K @ u - G.T @ p.ravel() - f, r.ravel()])
            if np.abs(rest[:n]).max() < 1e-9 * weight and np.abs(r * p[:, 2:]).max() < 0.05 * tau:
                break
            A = np.block([[K, -G.T], [G, np.zeros((3 * c, 3 * c))]])
            for k in range(c):
                A[n + 3 * k : n + 3 * k + 3, n + 3 * k : n + 3 * k + 3] = by[k]
            step = np.linalg.solve(A, -rest)
            way, t = step[n:].reshape(c, 3), 1.0
            while not (np.hypot(*(p + t / 0.95 * way)[:, :2].T) < mu * (p + t / 0.95 * way)[:, 2]).all():
                t *= 0.7
            u, p = u + t * step[:n], p + t * way
        tau *= 0.3
    return p


def stiffest(piece: Piece) -> Compliance:
    """Joints that turn most easily, on the stiffer floor."""
    return compliances(piece, Compliance())[-1]


@pytest.mark.parametrize("make", [table, shelf_1])
def test_forces_on_a_stiff_floor_are_those_of_an_interior_path(make: Callable[[], Piece]) -> None:
    piece = Furniture(make()).moved()
    furniture = Furniture(piece, stiffest(piece))
    furniture.test()
    forces = furniture.forces()
    weight = forces.contacts[:, 2].sum()
    assert forces.one_sided and forces.contacts[:, 2].min() >= 0.0
    feet = reference_contacts(furniture).reshape(-1, 4, 3).sum(axis=1)
    assert forces.contacts.reshape(-1, 4, 3).sum(axis=1) == pytest.approx(feet, abs=1e-3 * weight)


def test_ranges_leave_out_springs_that_pull() -> None:
    # One who sits near the rear leg loads its joint at each ratio; with feet held down it bore 0.012 at one.
    piece = stool_chair()
    near_the_leg = {"sitter": (0.3, 0.0, 0.5)}
    weights = tuple(replace(load, place=near_the_leg.get(load.name, load.place)) for load in piece.weights)
    piece = replace(piece, weights=weights)
    known, all_found = utilisation_range(piece, Compliance()), []
    for one in compliances(piece, Compliance()):
        furniture = Furniture(piece, one)
        furniture.test()
        if furniture.forces().contacts[:, 2].min() >= 0.0:
            all_found.append(furniture.forces().utilisation)
    assert known.low == pytest.approx(np.min(all_found, axis=0), abs=1e-9)
    assert known.high == pytest.approx(np.max(all_found, axis=0), abs=1e-9)


def test_legs_that_a_drag_moves_come_to_rest_at_each_ratio_in_few_steps() -> None:
    # Eight to fourteen contacts touch as springs, five to seven as they only push: which ones is the whole question.
    furniture = Furniture(table())
    gamma, leg = np.zeros((len(furniture.piece.planks), 8)), furniture.piece.index("leg-4")
    for side, along in ((-0.289, 0.468), (-0.322, 0.426), (-0.2, 0.3), (-0.1, 0.1)):
        gamma[leg, 1:3] = side, along
        piece = furniture.moved(gamma)
        models = compliances(piece, Compliance())
        springs = _springs(Furniture(piece), models)
        _, _, sprung = springs.test()
        assert not any(sprung) and springs.steps < 230, (side, along)
    for one in models[1::2]:
        model = Furniture(piece, one)
        model.test()
        forces, feet = model.forces().contacts, reference_contacts(model)
        assert forces == pytest.approx(feet, abs=5e-4 * forces[:, 2].sum())
