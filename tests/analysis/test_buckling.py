"""Critical load factors of columns against closed forms, and what they must not depend on."""

import numpy as np
import pytest
from columns import FOOT, HINGES, PUSHED, column, euler, solved
from scipy.linalg import eigh
from scipy.optimize import brentq

from restshape.analysis.buckling.buckling_matrices import products
from restshape.errors import UserError

HINGED = (HINGES, PUSHED.format(1e3))


def elastic_column(height: float, length: float, n: int) -> float:
    """The n-th critical stress over E of a hinged column in plane elasticity without lateral strain (nu = 0), exact.

    u = f(x) sin ky, v = g(x) cos ky, f = sum A cosh ax, g = sum B sinh ax, with no stress on the sides.
    """
    k, M, G, half = n * np.pi / length, 1.0, 0.5, height / 2

    def determinant(p: float) -> float:
        # (M a^2 - k^2 (G - p)) (G a^2 - k^2 (M - p)) + k^2 G^2 a^2 = 0
        squares = np.roots([M * G, k**2 * (G**2 - M * (M - p) - G * (G - p)), k**4 * (G - p) * (M - p)])
        a = np.sqrt(squares.astype(complex))
        b = (M * a**2 - k**2 * (G - p)) / (k * G * a)
        side = M * a * np.sinh(a * half)
        shear = (k + b * a) * np.cosh(a * half)
        value = side[0] * shear[1] - side[1] * shear[0]
        return float((value / (a[0] ** 2 - a[1] ** 2)).real)

    euler = (k * height) ** 2 / 12
    return brentq(determinant, 0.5 * euler, 1.05 * euler, xtol=1e-14)


@pytest.mark.parametrize(
    ("ends", "z"),
    [
        ((FOOT, PUSHED.format(1e3)), (0.5 * np.pi, 1.5 * np.pi)),
        (HINGED, (np.pi, 2 * np.pi)),
        ((FOOT, HINGES, PUSHED.format(1e3)), (4.493409457909064, 7.725251836937707)),
    ],
    ids=["flagpole", "hinged", "propped"],
)
def test_euler(tmp_path, ends, z):
    analysis = solved(tmp_path, column(*ends, height=0.004, size=0.012))
    for factor, root in zip(analysis.load_factors, z):
        assert 1e3 * factor == pytest.approx(euler(0.004, root), rel=1e-3)


def test_own_weight(tmp_path):
    # Greenhill 1881: a clamped column stands while its weight is below 7.8373 E I / L^2.
    analysis = solved(tmp_path, column(FOOT, "\n[effects.gravity]\ng = [-10, 0]\n", height=0.01, size=0.012))
    weight = 8000 * 10 * 0.01 * 0.01
    assert weight * analysis.load_factors[0] == pytest.approx(7.8373 / 12 * 200e9 * 0.01 * 0.01**3, rel=1e-3)


@pytest.mark.parametrize(("order", "sizes", "rate"), [(1, (0.05, 0.025), 2), (2, (0.05, 0.025), 4)])
def test_rate_against_plane_elasticity(tmp_path, order, sizes, rate):
    height = 0.2
    exact = elastic_column(height, 1.0, 1) * 200e9 * height * 0.01
    errors = []
    for size in sizes:
        found = solved(tmp_path, column(*HINGED, height=height, size=size, order=order)).load_factors[0]
        errors.append(1e3 * found / exact - 1.0)
    # Stiffness is never too small.
    assert errors[0] > errors[1] > 0.0
    assert np.log2(errors[0] / errors[1]) == pytest.approx(rate, abs=0.3)


def test_exact_column_tends_to_eulers():
    assert elastic_column(0.01, 1.0, 1) == pytest.approx(np.pi**2 / 12 * 0.01**2, rel=5e-4)


def test_a_moving_support_loads_as_a_force_does(tmp_path):
    pressed = '\n[supports.head]\non = "right"\nfix = { x = -1e-5, y = 0 }\n'
    found = solved(tmp_path, column(FOOT, pressed, height=0.01, size=0.012)).load_factors[0]
    assert 200e9 * 1e-5 * 0.01 * 0.01 * found == pytest.approx(euler(0.01, 2 * np.pi), rel=2e-3)


def test_a_load_that_is_turned_round(tmp_path):
    pulled = '\n[loads.head]\non = "right"\nforce = [1e3, 0]\n'
    given = solved(tmp_path, column(FOOT, '\n[loads.head]\non = "right"\nforce = [-1e3, 0]\n'))
    turned = solved(tmp_path, column(FOOT, pulled, load="reversed"))
    np.testing.assert_allclose(turned.load_factors, given.load_factors, rtol=1e-9)


def test_nothing_is_left_out_and_modes_are_orthonormal(tmp_path):
    """All load factors of a coarse column, by LAPACK."""
    analysis = solved(tmp_path, column(height=0.2, size=0.15, order=1, modes=6))
    state, prebuckling = analysis.state, analysis.state.prebuckling
    free = np.flatnonzero(prebuckling.problem.boundary.mask.ravel() == 0)
    K, G = products(prebuckling.problem, np.eye(prebuckling.x.size), prebuckling.x, state.sign)
    G *= -1.0
    values = eigh(-G[np.ix_(free, free)], K[np.ix_(free, free)], eigvals_only=True)
    np.testing.assert_allclose(analysis.load_factors, np.sort(1.0 / values[values > 0.0])[:6], rtol=1e-8)
    modes = state.modes.vectors[:, free]
    np.testing.assert_allclose(modes @ K[np.ix_(free, free)] @ modes.T, np.eye(6), atol=1e-8)
    assert analysis.residual_norm() < 1e-8


@pytest.mark.slow
def test_incompressible_column(tmp_path):
    """Mean dilatation in plane strain: E / (1 - nu^2) takes the place of E."""
    text = column(height=0.04, size=0.005, nu=0.4999, model="plane_strain")
    analysis = solved(tmp_path, text)
    prebuckling = analysis.state.prebuckling
    assert prebuckling.problem.geometric_stiffness(prebuckling.x).element.name == "geometric_dilatation_tri6"
    assert 1e3 * analysis.load_factors[0] == pytest.approx(euler(0.04, np.pi / 2) / (1 - 0.4999**2), rel=3e-3)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("[effects.buckling]", "[effects.large_deformation]\n[effects.buckling]", "large deformation"),
        (PUSHED.format(1e3), "", "nothing loads the body"),
        ("load_factor = 2", "load_factor = 3", "only 2 load factors are computed"),
        ('load = "given"', 'load = "both"', "given"),
        ('[effects.buckling]\nmodes = 2\nload = "given"\n', "", "without buckling there are no load factors"),
        ('app = "plane"', 'app = "beams"', "buckling"),
        ('app = "plane"', 'app = "moving"', "buckling"),
    ],
)
def test_what_users_read(tmp_path, old, new, words):
    text = column()
    assert old in text
    with pytest.raises(UserError, match=words) as reported:
        solved(tmp_path, text.replace(old, new))
    assert reported.value.do
