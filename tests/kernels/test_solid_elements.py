"""Solids: the inherited checks, and stiffness and stress against formulas that know nothing of dual numbers."""

import numpy as np
from element_case import LAMBDA, MU, TET4, TRI3, SolidCase, curved
from sample_meshes import second_order, unit_box

from restshape import _kernels as k


class TestLinearElasticTri3(SolidCase):
    name, params, X = "linear_elastic_tri3", (LAMBDA, MU, 0.8, 0.3, -0.9), TRI3

    def patch(self):
        return unit_box(2, 3)

    def test_stiffness_of_the_constant_strain_triangle(self, element):
        """B^T D B A t, as in any textbook."""
        corners = np.column_stack([np.ones(3), self.X])
        gradients = np.linalg.inv(corners)[1:]
        B = np.zeros((3, 6))
        B[0, 0::2], B[1, 1::2] = gradients
        B[2, 0::2], B[2, 1::2] = gradients[1], gradients[0]
        D = np.array([[LAMBDA + 2 * MU, LAMBDA, 0], [LAMBDA, LAMBDA + 2 * MU, 0], [0, 0, MU]])
        expected = B.T @ D @ B * np.linalg.det(corners) / 2 * 0.8
        tangent = element.tangent_block(self.X, np.zeros((3, 2)), self.p)
        np.testing.assert_allclose(tangent, expected, atol=1e-14)


class TestLinearElasticTri6(SolidCase):
    name, params, X = "linear_elastic_tri6", (LAMBDA, MU, 0.8, 0.3, -0.9), curved(TRI3)

    def patch(self):
        return second_order(*unit_box(2, 3), bend=0.03)

    def test_straight_cell_has_the_energy_of_a_quadratic_field(self, element):
        """u = (x^2, 0): eps_xx = 2x, so psi = (lambda/2 + mu) 4 x^2, whose integral on the unit square is 4/3 of it."""
        X, cells, _ = second_order(*unit_box(2, 3))
        u = np.column_stack([X[:, 0] ** 2, np.zeros(len(X))])
        energy = element.energy(X, u, cells, self.unloaded).sum()
        np.testing.assert_allclose(energy, (LAMBDA / 2 + MU) * 4 / 3 * self.thickness, rtol=1e-13)


class TestLinearElasticTet4(SolidCase):
    name, params, X = "linear_elastic_tet4", (LAMBDA, MU, 0.3, -0.9, 0.5), TET4

    def patch(self):
        return unit_box(3, 3)


class TestLinearElasticTet10(SolidCase):
    name, params, X = "linear_elastic_tet10", (LAMBDA, MU, 0.3, -0.9, 0.5), curved(TET4)

    def patch(self):
        return second_order(*unit_box(3, 3), bend=0.02)

    def test_straight_cell_has_the_energy_of_a_quadratic_field(self, element):
        """u = (0, 0, y z): eps_zz = y and eps_yz = z/2, so the energy of the unit cube is lambda/6 + mu/3 + mu/6."""
        X, cells, _ = second_order(*unit_box(3, 3))
        u = np.zeros_like(X)
        u[:, 2] = X[:, 1] * X[:, 2]
        energy = element.energy(X, u, cells, self.unloaded).sum()
        np.testing.assert_allclose(energy, LAMBDA / 6 + MU / 2, rtol=1e-13)


class TestStVenantKirchhoffTri3(SolidCase):
    name, params, X = "stvk_tri3", (LAMBDA, MU, 0.8, 0.3, -0.9), TRI3

    def patch(self):
        return unit_box(2, 3)

    def rotation(self):
        c, s = np.cos(1.1), np.sin(1.1)
        return np.array([[c, -s], [s, c]]) - np.eye(2)

    def law_tolerance(self, scale):
        return 1e-2 * scale

    def test_energy_and_stress_of_a_stretch_that_is_turned(self, element):
        """F = Q diag(1.2, 0.9): E and S in closed form, Cauchy stress F S F^T / J."""
        c, s = np.cos(0.6), np.sin(0.6)
        F = np.array([[c, -s], [s, c]]) @ np.diag([1.2, 0.9])
        E = np.array([(1.44 - 1) / 2, (0.81 - 1) / 2])
        S = LAMBDA * E.sum() + 2 * MU * E
        u = self.X @ (F - np.eye(2)).T
        area = np.linalg.det(np.column_stack([np.ones(3), self.X])) / 2
        energy = element.energy(self.X, u, self.cells, self.unloaded)[0]
        np.testing.assert_allclose(energy, np.sum(S * E) / 2 * area * 0.8, rtol=1e-13)
        cauchy = F @ np.diag(S) @ F.T / (1.2 * 0.9)
        out = np.zeros((1, 4))
        element.stress(self.X, u, self.cells, self.unloaded, out)
        np.testing.assert_allclose(
            out[0], [cauchy[0, 0], cauchy[1, 1], cauchy[0, 1], LAMBDA * E.sum() / (1.2 * 0.9)], rtol=1e-12
        )


def test_every_element_has_a_case():
    import test_load_and_mass_elements as others

    listed = {c.name for module in (globals(), vars(others)) for c in module.values() if hasattr(c, "X")}
    assert listed == set(k.element_names())
