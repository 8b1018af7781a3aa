"""Solids: the inherited checks, and stiffness and stress against formulas that know nothing of dual numbers."""

from importlib import import_module
from pathlib import Path

import numpy as np
from element_case import LAMBDA, MU, TET4, TRI3, LargeCase, SolidCase, curved
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


class TestStVenantKirchhoffTri3(LargeCase):
    name, params, X = "stvk_tri3", (LAMBDA, MU, 0.8, 0.3, -0.9), TRI3

    def patch(self):
        return unit_box(2, 3)


class TestStVenantKirchhoffTri6(LargeCase):
    name, params, X = "stvk_tri6", (LAMBDA, MU, 0.8, 0.3, -0.9), curved(TRI3)

    def patch(self):
        return second_order(*unit_box(2, 3), bend=0.03)


class TestStVenantKirchhoffTet4(LargeCase):
    name, params, X = "stvk_tet4", (LAMBDA, MU, 0.3, -0.9, 0.5), TET4

    def patch(self):
        return unit_box(3, 3)


class TestStVenantKirchhoffTet10(LargeCase):
    name, params, X = "stvk_tet10", (LAMBDA, MU, 0.3, -0.9, 0.5), curved(TET4)

    def patch(self):
        return second_order(*unit_box(3, 3), bend=0.02)


def test_every_element_has_a_case():
    modules = [import_module(path.stem) for path in Path(__file__).parent.glob("test_*_elements.py")]
    listed = {
        case.name
        for module in modules
        for case in vars(module).values()
        if isinstance(case, type) and hasattr(case, "X") and hasattr(case, "name")
    }
    assert listed == set(k.element_names())
