"""Solids with a grain: all checks of isotropic ones, and stiffness matrices that only a grain has."""

import numpy as np
import pytest
from element_case import LAMBDA, MU, TET4, TRI3, SolidCase, curved
from sample_meshes import second_order, unit_box

from restshape import _kernels as k

HOOKE = LAMBDA * np.pad(np.ones((3, 3)), (0, 3)) + MU * np.diag([2.0, 2, 2, 1, 1, 1])
PLANE_STRAIN = HOOKE[np.ix_([0, 1, 5], [0, 1, 5])]
VOIGT = {2: [(0, 0), (1, 1), (0, 1)], 3: [(0, 0), (1, 1), (2, 2), (1, 2), (0, 2), (0, 1)]}


def triangle_of(C: np.ndarray) -> list[float]:
    return list(C[np.triu_indices(len(C))])


def any_stiffness(dim: int) -> np.ndarray:
    """A stiffness without any symmetry of the material."""
    size = len(VOIGT[dim])
    root = np.random.default_rng(dim).uniform(-1, 1, (size, size))
    return root @ root.T + np.eye(size)


class FlatCase(SolidCase):
    @property
    def thickness(self):
        return self.params[6]

    def test_stress_of_a_linear_field(self, element):
        """The normal stress out of the plane is that of plane stress, whatever the constants are."""
        X, cells, _ = self.patch()
        strain = np.array([[1.0, 0.2], [0.2, -0.4]])
        out = np.zeros((len(cells), 4))
        element.stress(X, X @ strain, cells, self.unloaded, out)
        expected = LAMBDA * 0.6 * np.eye(2) + 2 * MU * strain
        np.testing.assert_allclose(out, np.tile([*np.diag(expected), expected[0, 1], 0], (len(cells), 1)), atol=1e-13)


class TestAnisotropicTri3(FlatCase):
    name, params, X = "anisotropic_tri3", (*triangle_of(PLANE_STRAIN), 0.8, 0.3, -0.9), TRI3

    def patch(self):
        return unit_box(2, 3)


class TestAnisotropicTri6(FlatCase):
    name, params, X = "anisotropic_tri6", (*triangle_of(PLANE_STRAIN), 0.8, 0.3, -0.9), curved(TRI3)

    def patch(self):
        return second_order(*unit_box(2, 3), bend=0.03)


class TestAnisotropicTet4(SolidCase):
    name, params, X = "anisotropic_tet4", (*triangle_of(HOOKE), 0.3, -0.9, 0.5), TET4

    def patch(self):
        return unit_box(3, 3)


class TestAnisotropicTet10(SolidCase):
    name, params, X = "anisotropic_tet10", (*triangle_of(HOOKE), 0.3, -0.9, 0.5), curved(TET4)

    def patch(self):
        return second_order(*unit_box(3, 3), bend=0.02)


CELLS = {"tri3": TRI3, "tri6": curved(TRI3), "tet4": TET4, "tet10": curved(TET4)}


@pytest.mark.parametrize("shape", CELLS)
def test_is_the_isotropic_element_where_the_stiffness_is_isotropic(shape):
    """On curved cells too, whose integrals are not those of straight ones."""
    X, flat = CELLS[shape], shape.startswith("tri")
    C, rest = (PLANE_STRAIN, [0.8, 0, 0]) if flat else (HOOKE, [0, 0, 0])
    ours = k.Element(f"anisotropic_{shape}").tangent_block(X, 0 * X, np.array([*triangle_of(C), *rest]))
    theirs = k.Element(f"linear_elastic_{shape}").tangent_block(X, 0 * X, np.array([LAMBDA, MU, *rest]))
    np.testing.assert_allclose(ours, theirs, atol=1e-13)


@pytest.mark.parametrize("shape", ["tri3", "tet4"])
def test_stiffness_and_stress_of_first_order(shape):
    """B^T C B times the volume, and C times the strain, for a stiffness without symmetry."""
    X = CELLS[shape]
    dim = X.shape[1]
    C, size = any_stiffness(dim), len(VOIGT[dim])
    gradients = np.linalg.inv(np.column_stack([np.ones(dim + 1), X]))[1:]
    B = np.zeros((size, dim * (dim + 1)))
    for row, (a, b) in enumerate(VOIGT[dim]):
        B[row, a::dim] += gradients[b]
        if a != b:
            B[row, b::dim] += gradients[a]
    volume = np.linalg.det(X[1:] - X[0]) / [None, None, 2, 6][dim]
    p = np.array([*triangle_of(C), *([1.0, 0, 0] if dim == 2 else [0, 0, 0])])
    element = k.Element(f"anisotropic_{shape}")
    np.testing.assert_allclose(element.tangent_block(X, 0 * X, p), B.T @ C @ B * volume, atol=1e-13)
    u = np.random.default_rng(1).uniform(-1, 1, X.shape)
    out = np.zeros((1, element.stress_components))
    element.stress(X, u, np.arange(dim + 1, dtype=np.int32)[None], p, out)
    stress = C @ B @ u.ravel()
    expected = [*stress[[0, 1, 2]], 0.0] if dim == 2 else stress[[0, 1, 5, 2, 3, 4]]
    np.testing.assert_allclose(out[0], expected, atol=1e-13)
