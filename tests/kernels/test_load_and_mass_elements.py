"""Masses and loads on sides: the inherited checks, and totals in closed form."""

import numpy as np
import pytest
from element_case import TRI3, ElementCase
from sample_meshes import unit_box

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


@pytest.mark.parametrize("name", ["mass_tri3", "lumped_mass_tri3"])
def test_uniform_acceleration_needs_the_whole_mass(name):
    X, cells, _ = unit_box(2, 4)
    out = np.zeros_like(X)
    k.Element(name).residual(X, np.tile([1.0, -2.0], (len(X), 1)), cells, np.array([3.0]), out)
    np.testing.assert_allclose(out.sum(axis=0), [3.0, -6.0], rtol=1e-13)


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
    with pytest.raises(ValueError, match="there are linear_elastic_tri3"):
        k.Element("linear_elastic_tri4")
    with pytest.raises(ValueError, match="does not exist"):
        element.energy(X, x, np.array([[0, 1, 3]], np.int32), p)
    with pytest.raises(ValueError, match="params of shape"):
        element.energy(X, x, cells, p[:4])
    with pytest.raises(TypeError):
        element.residual(X, x, cells, p, np.zeros((3, 2), np.float32))
