"""Masses and loads on sides: the inherited checks, and totals in closed form."""

import numpy as np
import pytest
from element_case import SIDES, TET4, TRI3, ElementCase, curved
from sample_meshes import second_order, unit_box
from scipy.special import factorial

from restshape import _kernels as k

AREA = np.linalg.det(np.column_stack([np.ones(3), TRI3])) / 2


class TestMassTri3(ElementCase):
    name, params, X = "mass_tri3", (2.5,), TRI3

    def test_consistent_mass_in_closed_form(self, element):
        """rho A / 12 (1 + delta_ij) for each component."""
        expected = np.kron(2.5 * AREA / 12 * (np.ones((3, 3)) + np.eye(3)), np.eye(2))
        np.testing.assert_allclose(element.tangent_block(self.X, np.zeros((3, 2)), self.p), expected, atol=1e-15)


class TestLumpedMassTri3(ElementCase):
    name, params, X = "lumped_mass_tri3", (2.5,), TRI3

    def test_lumped_mass_is_a_third_each(self, element):
        tangent = element.tangent_block(self.X, np.zeros((3, 2)), self.p)
        np.testing.assert_allclose(tangent, 2.5 * AREA / 3 * np.eye(6), atol=1e-15)


class TestMassTri6(ElementCase):
    name, params, X = "mass_tri6", (2.5,), curved(TRI3)

    def test_consistent_mass_of_a_straight_cell_in_closed_form(self, element):
        """rho A / 180 times 6, -1, -4 among corners, 32, 16 among mid-sides."""
        corner = 7 * np.eye(3) - np.ones((3, 3))
        opposite = -4 * np.roll(np.eye(3), 1, axis=1)  # corner i and the mid-side of the two others
        side = 16 * (np.ones((3, 3)) + np.eye(3))
        expected = np.kron(2.5 * AREA / 180 * np.block([[corner, opposite], [opposite.T, side]]), np.eye(2))
        X = curved(TRI3, bend=0.0)
        np.testing.assert_allclose(element.tangent_block(X, np.zeros((6, 2)), self.p), expected, atol=1e-15)

    def test_curved_cell_has_the_moments_of_its_area(self, element):
        """x M x is rho times the integral of x^2: by Green's theorem on the three parabolas, 8 Gauss points each."""
        moment = 0.0
        for a, b, m in ((0, 1, 3), (1, 2, 4), (2, 0, 5)):
            at, weights = np.polynomial.legendre.leggauss(8)
            s, weights = (at[:, None] + 1) / 2, weights / 2
            A, B, M = self.X[a], self.X[b], self.X[m]
            place = A * (1 - s) * (1 - 2 * s) + B * s * (2 * s - 1) + 4 * M * s * (1 - s)
            slope = A * (4 * s - 3) + B * (4 * s - 1) + 4 * M * (1 - 2 * s)
            moment += weights @ (place[:, 0] ** 3 / 3 * slope[:, 1])
        x = np.column_stack([self.X[:, 0], np.zeros(6)])
        energy = element.energy(self.X, x, self.cells, self.p)[0]
        np.testing.assert_allclose(2 * energy, 2.5 * moment, rtol=1e-13)


class TestLumpedMassTri6(ElementCase):
    name, params, X = "lumped_mass_tri6", (2.5,), curved(TRI3)

    def test_masses_of_a_straight_cell(self, element):
        """3/57 of the whole at corners, 16/57 at mid-sides: 6 and 32 to 114."""
        expected = 2.5 * AREA / 57 * np.kron(np.diag([3, 3, 3, 16, 16, 16]), np.eye(2))
        tangent = element.tangent_block(curved(TRI3, bend=0.0), np.zeros((6, 2)), self.p)
        np.testing.assert_allclose(tangent, expected, atol=1e-15)


VOLUME = np.linalg.det(TET4[1:] - TET4[0]) / 6


class TestMassTet4(ElementCase):
    name, params, X = "mass_tet4", (2.5,), TET4

    def test_consistent_mass_in_closed_form(self, element):
        """rho V / 20 (1 + delta_ij) for each component."""
        expected = np.kron(2.5 * VOLUME / 20 * (np.ones((4, 4)) + np.eye(4)), np.eye(3))
        np.testing.assert_allclose(element.tangent_block(self.X, np.zeros((4, 3)), self.p), expected, atol=1e-15)


class TestMassTet10(ElementCase):
    name, params, X = "mass_tet10", (2.5,), curved(TET4)

    def test_consistent_mass_of_a_straight_cell_in_closed_form(self, element):
        """Products of l_i (2 l_i - 1) and 4 l_i l_j; the mean of l_0^a ... l_3^d is 3! a! b! c! d! / (n + 3)!."""
        basis = [{(i, i): 2.0, (i,): -1.0} for i in range(4)] + [{side: 4.0} for side in SIDES[4]]

        def mean(f, g):
            terms = [(cf * cg, np.bincount(mf + mg)) for mf, cf in f.items() for mg, cg in g.items()]
            return sum(c * 6 * np.prod(factorial(n)) / factorial(n.sum() + 3) for c, n in terms)

        block = [[mean(f, g) for g in basis] for f in basis]
        tangent = element.tangent_block(curved(TET4, bend=0.0), np.zeros((10, 3)), self.p)
        np.testing.assert_allclose(tangent, np.kron(2.5 * VOLUME * np.array(block), np.eye(3)), atol=1e-15)


class TestLumpedMassTet4(ElementCase):
    name, params, X = "lumped_mass_tet4", (2.5,), TET4

    def test_lumped_mass_is_a_quarter_each(self, element):
        tangent = element.tangent_block(self.X, np.zeros((4, 3)), self.p)
        np.testing.assert_allclose(tangent, 2.5 * VOLUME / 4 * np.eye(12), atol=1e-15)


class TestLumpedMassTet10(ElementCase):
    name, params, X = "lumped_mass_tet10", (2.5,), curved(TET4)

    def test_masses_of_a_straight_cell(self, element):
        """1/36 of the whole at corners, 4/27 at mid-sides: the diagonal 6 and 32 of 420, scaled to a sum of 1."""
        expected = 2.5 * VOLUME / 108 * np.kron(np.diag([3] * 4 + [16] * 6), np.eye(3))
        tangent = element.tangent_block(curved(TET4, bend=0.0), np.zeros((10, 3)), self.p)
        np.testing.assert_allclose(tangent, expected, atol=1e-15)


def of_every_shape(kind: str) -> list[str]:
    return [f"{kind}_{shape}" for shape in ("tri3", "tri6", "tet4", "tet10")]


@pytest.mark.parametrize("name", of_every_shape("mass") + of_every_shape("lumped_mass"))
def test_uniform_acceleration_needs_the_whole_mass(name):
    box = unit_box(k.Element(name).dim, 3)
    X, cells, _ = second_order(*box, bend=0.03) if name.endswith(("6", "10")) else box
    out, acceleration = np.zeros_like(X), np.array([1.0, -2.0, 0.5])[: X.shape[1]]
    k.Element(name).residual(X, np.tile(acceleration, (len(X), 1)), cells, np.array([3.0]), out)
    np.testing.assert_allclose(out.sum(axis=0), 3.0 * acceleration, rtol=1e-13)


class TractionCase(ElementCase):
    params = (1.0, -2.0, 0.5, 3.0, 0.7, -0.4, 0.8)

    def test_has_no_tangent(self, element):
        assert not element.has_tangent


class TestTractionEdge2(TractionCase):
    name, X = "traction_edge2", np.array([[0.1, 0.2], [1.3, -0.4]])

    def test_total_is_length_times_the_mean(self, element):
        along = self.X[1] - self.X[0]
        outward = np.array([along[1], -along[0]])
        t, p = np.array([[1.0, -2.0], [0.5, 3.0]]).mean(axis=0), (0.7 - 0.4) / 2
        total = (np.linalg.norm(along) * t - outward * p) * 0.8
        np.testing.assert_allclose(self.residual(element, self.X, np.zeros((2, 2))).sum(axis=0), -total, rtol=1e-13)

    def test_uniform_pressure_pushes_inward(self, element):
        """Material on the left of a side that runs in +x lies above: pressure pushes up."""
        out = np.zeros((2, 2))
        params = np.array([0, 0, 0, 0, 5.0, 5.0, 0.1])
        element.residual(np.array([[0.0, 0], [2, 0]]), out * 0, np.array([[0, 1]], np.int32), params, out)
        np.testing.assert_allclose(-out, [[0, 0.5], [0, 0.5]], atol=1e-15)


class TestTractionEdge3(TractionCase):
    name, X = "traction_edge3", np.array([[0.1, 0.2], [1.3, -0.4], [0.75, -0.05]])

    def test_uniform_traction_on_a_parabola(self, element):
        """y = x^2/4 on [-1, 1] is this side exactly; its length is sqrt(5)/2 + 2 asinh(1/2)."""
        X = np.array([[-1.0, 0.25], [1, 0.25], [0, 0]])
        out = np.zeros((3, 2))
        element.residual(X, out * 0, self.cells, np.array([1.0, 0, 1, 0, 0, 0, 1]), out)
        np.testing.assert_allclose(-out.sum(axis=0), [np.sqrt(5) / 2 + 2 * np.arcsinh(0.5), 0], rtol=1e-4)


@pytest.mark.parametrize("order", [1, 2])
def test_pressure_on_a_closed_loop_has_no_resultant(order):
    """Neither force nor moment, on any polygon (and on any closed chain of parabolas)."""
    rng = np.random.default_rng(4)
    n = 11
    angle = np.sort(rng.uniform(0, 2 * np.pi, n))
    X = rng.uniform(0.5, 1.5, (n, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])
    cells = np.column_stack([np.arange(n), np.roll(np.arange(n), -1)])
    if order == 2:
        X = np.vstack([X, X[cells].mean(axis=1) + rng.uniform(-0.1, 0.1, (n, 2))])
        cells = np.column_stack([cells, np.arange(n, 2 * n)])
    out = np.zeros_like(X)
    params = np.array([0, 0, 0, 0, 2.0, 2.0, 0.3])
    k.Element(f"traction_edge{order + 1}").residual(X, np.zeros_like(X), cells.astype(np.int32), params, out)
    assert np.abs(out).max() > 0.01
    np.testing.assert_allclose(out.sum(axis=0), 0, atol=1e-14)
    np.testing.assert_allclose(np.sum(X[:, 0] * out[:, 1] - X[:, 1] * out[:, 0]), 0, atol=1e-14)


def test_bad_arguments_are_refused():
    element = k.Element("linear_elastic_tri3")
    X, x, cells, p = TRI3, np.zeros((3, 2)), np.array([[0, 1, 2]], np.int32), np.array([1.0, 1, 1, 0, 0])
    with pytest.raises(ValueError, match=r"there are .*linear_elastic_tri3"):
        k.Element("linear_elastic_tri4")
    with pytest.raises(ValueError, match="does not exist"):
        element.energy(X, x, np.array([[0, 1, 3]], np.int32), p)
    with pytest.raises(ValueError, match="params of shape"):
        element.energy(X, x, cells, p[:4])
    with pytest.raises(TypeError):
        element.residual(X, x, cells, p, np.zeros((3, 2), np.float32))
