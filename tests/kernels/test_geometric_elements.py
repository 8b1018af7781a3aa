"""Geometric stiffness: the inherited checks, the derivative of the tangent of large deformation, a uniform stress."""

import numpy as np
import pytest
from element_case import LAMBDA, MU, TRI3, ElementCase, curved, strain_and_stress
from sample_meshes import second_order, unit_box

from restshape import _kernels as k

THICKNESS = 0.8


def displacement(X):
    """Some displacement of nodes X (n, 2)."""
    return np.random.default_rng(5).uniform(-0.1, 0.1, X.shape)


def params(X):
    return (LAMBDA, MU, THICKNESS, *displacement(X).ravel())


class GeometricCase(ElementCase):
    """What the element is made for."""

    large: str

    def test_is_what_the_tangent_of_large_deformation_does_to_turned_bodies(self, element):
        """phi . K(h u) phi grows with h phi . G phi for a rotation phi, which has no strain of first order."""
        large, u = k.Element(self.large), displacement(self.X)
        own = np.array([LAMBDA, MU, THICKNESS, 0.0, 0.0])
        # The tangent is of second degree in u: the central difference is exact.
        change = 0.5 * (large.tangent_block(self.X, u, own) - large.tangent_block(self.X, -u, own))
        turn = (self.X @ np.array([[0.0, 1.0], [-1.0, 0.0]])).ravel()
        found = element.tangent_block(self.X, np.zeros_like(self.X), self.p)
        np.testing.assert_allclose(turn @ found @ turn, turn @ change @ turn, rtol=1e-12)

    def test_is_linear_in_the_displacement(self, element):
        x = self.sample(element, 1)
        twice = self.p.copy()
        twice[3:] *= 2.0
        out = np.zeros_like(self.X)
        element.residual(self.X, x, self.cells, twice, out)
        np.testing.assert_allclose(out, 2.0 * self.residual(element, self.X, x), rtol=1e-13)

    def test_a_turn_of_the_body_has_no_stress(self, element):
        p = self.p.copy()
        p[3:] = (self.X @ np.array([[0.0, 1.0], [-1.0, 0.0]])).ravel()
        np.testing.assert_allclose(element.tangent_block(self.X, self.X, p), 0.0, atol=1e-13)


class TestTri3(GeometricCase):
    name, large, X, params = "geometric_tri3", "stvk_tri3", TRI3, params(TRI3)


class TestTri6(GeometricCase):
    name, large, X, params = "geometric_tri6", "stvk_tri6", curved(TRI3), params(curved(TRI3))


class TestDilatationTri6(GeometricCase):
    name, large, X, params = (
        "geometric_dilatation_tri6",
        "stvk_dilatation_tri6",
        curved(TRI3),
        params(curved(TRI3)),
    )


@pytest.mark.parametrize("name", ["geometric_tri6", "geometric_dilatation_tri6"])
def test_energy_of_linear_fields(name):
    """u = A X and phi = B X: the energy is half of area x thickness x sigma(A) : B^T B."""
    X, cells, _ = second_order(*unit_box(2, 3), bend=0.03)
    A, B = np.random.default_rng(3).uniform(-1, 1, (2, 2, 2))
    own = np.column_stack([np.tile([LAMBDA, MU, THICKNESS], (len(cells), 1)), (X @ A.T)[cells].reshape(len(cells), -1)])
    found = k.Element(name).energy(X, X @ B.T, cells, own).sum()
    _, sigma = strain_and_stress(A)
    np.testing.assert_allclose(found, 0.5 * THICKNESS * np.sum(sigma * (B.T @ B)), rtol=1e-12)
