"""The mixed system of SNES: its residual against its energy, its tangent against its residual, its answer."""

import gc
from weakref import ref

import numpy as np
import pytest
import scipy.sparse as sparse
from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.pieces import PIECES, chair, shelf_1, table
from restshape_apps.furniture.small_pieces import stool

STEPS = np.array([1e-1, 1e-2, 1e-3])


def state(solver: PlankEquilibrium, seed: int) -> np.ndarray:
    """Unknowns far from equilibrium: forces of 10 N, turns of some degrees."""
    rng, joints = np.random.default_rng(seed), 6 * len(solver.furniture.piece.joints)
    z = rng.normal(size=solver.mixed.size)
    return z * np.where(np.arange(len(z)) < joints, 10.0, 0.05)


def residual(solver: PlankEquilibrium, z: np.ndarray, law: int = 0) -> np.ndarray:
    """The residual at z."""
    out = np.zeros(len(z))
    solver.mixed.residual(0, law, z, out)
    return out


@pytest.mark.parametrize("make", [table, chair, shelf_1])
def test_the_residual_is_the_gradient_of_the_energy(make) -> None:
    solver = PlankEquilibrium(Furniture(make(), Compliance(1e-5, 1e-5, 1e-5)))
    z, d = state(solver, 1), state(solver, 2)
    joints = 6 * len(solver.furniture.piece.joints)
    # Rows of joints are divided by their compliance.
    slope = (residual(solver, z) * np.where(np.arange(len(z)) < joints, 1e-5, 1.0)) @ d
    rest = [
        abs(solver.mixed.energy(0, z + h * d) - solver.mixed.energy(0, z - h * d) - 2 * h * slope) for h in STEPS[:2]
    ]
    assert np.log10(rest[0] / rest[1]) == pytest.approx(3.0, abs=0.2)


@pytest.mark.parametrize("law", [0, 1])
@pytest.mark.parametrize("make", [table, chair, shelf_1])
def test_the_tangent_has_second_order_remainders(make, law: int) -> None:
    solver = PlankEquilibrium(Furniture(make(), Compliance(1e-5, 1e-5, 1e-5)))
    z, d = state(solver, 1), 1e-2 * state(solver, 2)
    rows, columns = solver.mixed.pattern()
    values = np.zeros(len(columns))
    solver.mixed.tangent(0, law, z, values, 0.0)
    K = sparse.csr_matrix((values, columns, rows))
    rest = [np.abs(residual(solver, z + h * d, law) - residual(solver, z, law) - h * (K @ d)).max() for h in STEPS]
    assert np.log10(np.array(rest[:-1]) / rest[1:]) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("name", sorted(PIECES))
def test_snes_and_the_eliminated_form_agree(name: str) -> None:
    furniture = Furniture(PIECES[name]())
    furniture.test()
    quick = furniture.forces()
    solver = PlankEquilibrium(furniture)
    forces = solver.solve()
    assert forces.one_sided == quick.one_sided
    assert solver.steps <= 12
    size = np.abs(quick.bending).max()
    assert forces.bending == pytest.approx(quick.bending, abs=1e-8 * size)
    assert forces.contacts == pytest.approx(quick.contacts, abs=1e-8 * np.abs(quick.contacts).max())
    solver.destroy()


def test_soft_joints_turn_far_and_still_balance() -> None:
    piece = stool([(-0.4, -0.3), (0.45, -0.2), (0.0, 0.4)], (0.1, 0.05), 5.0)
    furniture = Furniture(piece, Compliance(1e-4, 1e-3, 1e-4, least_overlap=1e-6))
    solver = PlankEquilibrium(furniture)
    forces = solver.solve(one_sided=False)
    load = furniture.geometry().mass.sum() * 9.80665 + 5.0 * 9.80665
    assert np.abs(forces.u).max() > 1e-3
    assert forces.contacts.sum(axis=0) == pytest.approx([0.0, 0.0, load], abs=1e-8 * load)
    solver.destroy()


def test_a_solver_follows_the_geometry_of_its_model() -> None:
    furniture = Furniture(table())
    solver = PlankEquilibrium(furniture)
    first = solver.solve()
    gamma = np.zeros((5, 8))
    gamma[4, 4] = 0.1
    moved = furniture.moved(gamma)
    now = solver.solve(guess=first.u)
    cold = PlankEquilibrium(Furniture(moved))
    assert now.bending == pytest.approx(cold.solve().bending, rel=1e-8)
    assert np.abs(now.bending - first.bending).max() > 1e-2 * np.abs(first.bending).max()
    for each in (solver, cold):
        each.destroy()


def test_a_solver_goes_with_the_last_reference_to_it() -> None:
    gc.disable()
    try:
        solver = PlankEquilibrium(Furniture(table(), Compliance(1e-5, 1e-5, 1e-5)))
        solver.solve()
        kept = ref(solver)
        del solver
        assert kept() is None
    finally:
        gc.enable()
