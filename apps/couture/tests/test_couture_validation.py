"""References of the validation of cloth, found again in other ways, and cases that need little time."""

import numpy as np
import pytest
from petsc4py import PETSc
from restshape_studies.verification import verification
from restshape_verification.couture.comparisons import Counted
from restshape_verification.couture.nested_folds import nested_heights
from restshape_verification.couture.validation import CASES
from restshape_verification.couture.validation_buckling import DENSITY, NU, SLENDER, D, lightest
from restshape_verification.couture.validation_cantilever import ELASTICA, equilateral
from restshape_verification.couture.validation_friction import Hung
from restshape_verification.couture.validation_hanging import chain, stretched
from restshape_verification.couture.validation_layers import loop_height
from restshape_verification.couture.validation_meshes import slope
from restshape_verification.couture.validation_plates import SIDES
from scipy.integrate import quad, solve_bvp, solve_ivp
from scipy.optimize import brentq
from scipy.special import jv

from restshape.mesh.importer import read_mesh
from restshape.mesh.quality import areas


def test_the_application_offers_them():
    assert verification("couture").load_validation() is CASES


@pytest.mark.parametrize(("distance", "table"), [(0.9, 0.190709), (0.8, 0.26543751), (0.5, 0.39819418)])
def test_the_chain_is_in_equilibrium(distance, table):
    """H z'' = w sqrt(1 + z'^2) from the lowest point to the support, with H for which it is half as long."""

    def ends(H):
        def slopes(x, y):
            return [y[1], np.hypot(1.0, y[1]) / H, np.hypot(1.0, y[1])]

        return solve_ivp(slopes, (0, distance / 2), [0.0, 0.0, 0.0], rtol=1e-11, atol=1e-13).y[:, -1]

    H = brentq(lambda H: ends(H)[2] - 0.5, 0.05, 2.0, xtol=1e-13)
    sag, tension = chain(distance)
    np.testing.assert_allclose([sag, tension], [ends(H)[0], np.hypot(H, 0.5)], rtol=1e-8)
    assert sag == pytest.approx(table, abs=1e-7)


@pytest.mark.parametrize(("W", "table"), [(0.1, 0.045797685), (0.5, 0.182257884), (1.0, 0.305359307)])
def test_the_hanging_strip_sinks_by_the_roots_of_its_cubic(W, table):
    def stretch(s):
        return max(root.real for root in np.roots([0.5, 0.0, -0.5, -W * s]) if abs(root.imag) < 1e-9)

    assert stretched(W) == pytest.approx(quad(stretch, 0, 1)[0] - 1.0, rel=1e-9)
    assert stretched(W) == pytest.approx(table, rel=1e-8)


@pytest.mark.parametrize("gamma", ELASTICA)
def test_the_table_of_the_elastica(gamma):
    """By following solutions of the boundary value problem to larger weights."""
    s = np.linspace(0, 1, 201)
    y = np.vstack([0 * s, 0 * s, s, 0 * s])
    for load in np.geomspace(0.5, gamma, 2 + int(4 * np.log10(2 * gamma))):

        def slopes(s, y, load=load):
            return np.vstack([y[1], -load * (1 - s) * np.cos(y[0]), np.cos(y[0]), -np.sin(y[0])])

        found = solve_bvp(slopes, lambda a, b: np.array([a[0], b[1], a[2], a[3]]), s, y, tol=1e-8, max_nodes=40000)
        assert found.success
        s, y = found.x, found.y
    away, down, angle = ELASTICA[gamma]
    np.testing.assert_allclose(y[2:, -1], [away, -down], atol=2e-6)
    assert np.degrees(y[0, -1]) == pytest.approx(angle, abs=2e-5 if gamma < 1000 else 1e-3)


def test_deflections_of_square_plates():
    """Navier's double series of the simply supported one, and a clamped one by Ritz with products of polynomials."""
    odd = np.arange(1, 400, 2)
    m, n = np.meshgrid(odd, odd)
    signs = (-1.0) ** ((m + n) / 2 - 1)
    navier = 16 / np.pi**6 * (signs / (m * n * (m**2 + n**2) ** 2)).sum()
    assert SIDES["simply supported"][1] == pytest.approx(navier, rel=1e-5)
    # On (-1, 1): (1 - x^2)^2 x^2i, integrated exactly.
    bases = [np.polynomial.Polynomial([1, 0, -2, 0, 1]) * np.polynomial.Polynomial([0] * 2 * i + [1]) for i in range(7)]
    gauss, weights = np.polynomial.legendre.leggauss(30)
    f, curved = (np.array([b.deriv(k)(gauss) if k else b(gauss) for b in bases]) for k in (0, 2))
    mass, bent, mixed = ((a * weights) @ b.T for a, b in ((f, f), (curved, curved), (curved, f)))
    K = np.kron(bent, mass) + np.kron(mass, bent) + np.kron(mixed, mixed.T) + np.kron(mixed.T, mixed)
    load = np.kron(f @ weights, f @ weights)
    at_middle = np.kron([b(0.0) for b in bases], [b(0.0) for b in bases])
    # The side is 2 there.
    assert SIDES["clamped"][1] == pytest.approx(at_middle @ np.linalg.solve(K, load) / 2**4, rel=2e-5)


def test_slender_blades_turn_over_at_a_zero_of_a_bessel_function():
    zero = brentq(lambda z: jv(-1 / 6, z), 1.5, 2.5)
    assert 6 * zero == pytest.approx(SLENDER, rel=1e-8)
    # Hardly any correction for the stiffness upright is left of a wide one: Gamma = 14.508 by D.
    assert DENSITY * lightest(10.0) / D == pytest.approx(14.508, rel=1e-4)
    assert SLENDER * np.sqrt((1 - NU**2) * 2 * (1 - NU)) == pytest.approx(14.508, rel=1e-4)


@pytest.mark.parametrize("mu", [0.1, 0.3, 0.8])
def test_the_capstan_with_weight(mu):
    """The tension of a strip that slips, from one side of a bar to the other; weight by length is 1."""
    radius, short = 0.05, 0.1

    def growth(a, T):
        # From the side where the strip comes up, over the top at pi/2, to where it goes down.
        return mu * (T + radius * np.sin(a)) + radius * np.cos(a)

    long = solve_ivp(growth, (0, np.pi), [short], rtol=1e-10, atol=1e-12).y[0, -1]
    hung = Hung(short, long, radius)
    assert hung.most(mu) == pytest.approx(hung.ratio, rel=1e-8)
    assert hung.most(hung.friction(0.5)) == pytest.approx(2 * hung.ratio, rel=1e-9)


def test_equilateral_triangles_are_such(tmp_path):
    mesh, _ = read_mesh(equilateral(tmp_path, 20).parent / "strip.msh")
    X = mesh.X[mesh.cells]
    sides = np.linalg.norm(X - np.roll(X, 1, axis=1), axis=2)
    whole = np.isclose(sides.min(axis=1), sides.max(axis=1))
    # Those at the sides are halved: two in each of 20 rows.
    assert (~whole).sum() == 40 and len(whole) == 20 * (2 * 4 + 1)
    assert areas(mesh.X, mesh.cells).sum() == pytest.approx(0.05 * mesh.X[:, 1].max())
    for name, axis, place in (("left", 0, 0.0), ("right", 0, 0.05), ("bottom", 1, 0.0)):
        assert np.allclose(mesh.X[mesh.nodes_of(name), axis], place)


def test_counting_steps_and_slopes():
    class Matrices:
        constrained = 7

        def step_matrix(self, x, inertia):
            return x + inertia

    counted = Counted(Matrices())
    assert counted.step_matrix(1, 2) == 3 and counted.constrained == 7 and counted.matrices == 1
    assert slope([0.4, 0.1]) == pytest.approx(2.0)


@pytest.mark.slow
def test_identities_of_derivatives_of_drapes():
    checks = CASES["drape_identities"](PETSc.COMM_WORLD)
    assert len(checks) == 6 and all(check.value < check.tolerance for check in checks)


@pytest.mark.slow
def test_nested_folds_whose_tips_meet_are_as_high_as_one_alone():
    """One of 2 D and 2 w is as high as one of D and w."""
    inner, outer = nested_heights(1e-4, 0.02)
    assert inner < loop_height(0.0) < outer
    assert [inner, outer] == pytest.approx([loop_height(0.0)] * 2, rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("case", ["sewn_loop", "sewn_cylinder", "sewn_dart"])
def test_sewn_cloth_is_that_of_closed_forms(case):
    checks = CASES[case](PETSc.COMM_WORLD)
    assert all(check.passed for check in checks), [(check.quantity, check.error) for check in checks]
