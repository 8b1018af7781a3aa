"""Solids with the mean dilatation of each element: the inherited checks, the inf-sup condition, and no locking."""

import numpy as np
import pytest
from element_case import LAMBDA, MU, TRI3, LargeCase, SolidCase, curved
from sample_meshes import oriented, second_order, unit_box
from scipy.linalg import eigh
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from restshape import _kernels as k


class DilatationCase:
    """What the mean brings: a second-order cell knows one dilatation only."""

    def patch(self):
        return second_order(*unit_box(2, 3), bend=0.03)

    def mean_dilatation(self, X, dilatation, at):
        """Of a linear field: its value at the centroid."""
        corners = np.column_stack([np.ones(3), at[:3]])
        return np.full(len(at), np.mean(corners @ np.linalg.solve(corners, dilatation[:3])))


class TestLinearElasticDilatationTri6(DilatationCase, SolidCase):
    name, params, X = "linear_elastic_dilatation_tri6", (LAMBDA, MU, 0.8, 0.3, -0.9), curved(TRI3)

    def test_equals_the_displacement_element_where_the_dilatation_is_constant(self, element):
        """u = (x^2 + 0.3 x, -2 x y): its divergence is 0.3 everywhere."""
        X, cells, _ = second_order(*unit_box(2, 3))
        x, y = X.T
        u = np.column_stack([x**2 + 0.3 * x, -2 * x * y])
        forces = [np.zeros_like(X), np.zeros_like(X)]
        energies = []
        for out, e in zip(forces, (element, k.Element("linear_elastic_tri6"))):
            e.residual(X, u, cells, self.p, out)
            energies.append(e.energy(X, u, cells, self.p))
        np.testing.assert_allclose(*forces, atol=1e-14)
        np.testing.assert_allclose(*energies, rtol=1e-12)

    def test_varying_dilatation_stores_the_energy_of_its_mean(self, element):
        """u = (x^2, 0) on one right triangle: mean of 2x is 2/3, of 4x^2 is 2/3."""
        X = curved(np.array([[0.0, 0], [1, 0], [0, 1]]), 0.0)
        u = np.column_stack([X[:, 0] ** 2, np.zeros(6)])
        energy = element.energy(X, u, self.cells, np.array([LAMBDA, MU, 1.0, 0, 0]))[0]
        np.testing.assert_allclose(energy, (LAMBDA / 2 * (2 / 3) ** 2 + MU * 2 / 3) / 2, rtol=1e-13)


class TestStVenantKirchhoffDilatationTri6(DilatationCase, LargeCase):
    name, params, X = "stvk_dilatation_tri6", (LAMBDA, MU, 0.8, 0.3, -0.9), curved(TRI3)

    def test_equals_the_displacement_element_where_the_dilatation_is_constant(self, element):
        X, cells, _ = self.patch()
        u = X @ np.random.default_rng(2).uniform(-0.4, 0.4, (2, 2))
        forces = [np.zeros_like(X), np.zeros_like(X)]
        for out, e in zip(forces, (element, k.Element("stvk_tri6"))):
            e.residual(X, u, cells, self.p, out)
        np.testing.assert_allclose(*forces, atol=1e-13)


def stiffness(name: str, X: np.ndarray, cells: np.ndarray, p: np.ndarray):
    """The sparse matrix of a linear element."""
    element = k.Element(name)
    blocks = np.array([element.tangent_block(X[cell], 0 * X[cell], p) for cell in cells])
    dofs = (2 * cells[:, :, None] + np.arange(2)).reshape(len(cells), -1)
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    return coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), (X.size, X.size)).tocsr()


def inf_sup(per_side: int) -> float:
    """The smallest inf-sup constant of the constrained unit square's displacements and one pressure an element.

    It is the root of the smallest eigenvalue above 0 of B A^-1 B^T against the areas, A the vector Laplacian's
    equal 2 mu eps:eps (Korn), B the integrals of the divergence, read from the part of the tangent that lambda scales.
    """
    X, cells, _ = second_order(*unit_box(2, per_side))
    free = np.flatnonzero(np.repeat(np.all((X > 1e-9) & (X < 1 - 1e-9), axis=1), 2))
    A = stiffness("linear_elastic_dilatation_tri6", X, cells, np.array([0, 0.5, 1.0, 0, 0])).toarray()
    edges = X[cells[:, 1:3]] - X[cells[:, :1]]
    areas = np.linalg.det(edges) / 2
    B = np.zeros((len(cells), X.size))
    element = k.Element("linear_elastic_dilatation_tri6")
    for e, cell in enumerate(cells):
        lame = element.tangent_block(X[cell], 0 * X[cell], np.array([1.0, 0, 1.0, 0, 0]))
        value, vector = np.linalg.eigh(lame)
        assert np.all(np.abs(value[:-1]) < 1e-12 * value[-1])  # one pressure an element
        dofs = (2 * cell[:, None] + np.arange(2)).ravel()
        B[e, dofs] = vector[:, -1] * np.sqrt(value[-1] * areas[e])
        B[e] *= np.sign(B[e, dofs] @ X[cell].ravel())  # a growing cell has a positive divergence
    S = B[:, free] @ np.linalg.solve(A[np.ix_(free, free)], B[:, free].T)
    values = eigh(S, np.diag(areas), eigvals_only=True)
    assert abs(values[0]) < 1e-12  # the constant pressure, which a constrained body does not feel
    return float(np.sqrt(values[1]))


def test_inf_sup_constant_does_not_fall_with_the_mesh():
    constants = [inf_sup(per_side) for per_side in (2, 4, 8)]
    assert constants[-1] > 0.3 and constants[-1] > 0.85 * constants[-2]


def cook(name: str, per_side: int, nu: float) -> float:
    """Deflection of Cook's membrane at (48, 52), plane strain, E = 1."""
    X, cells, inner = unit_box(2, per_side)
    axes = np.linspace(0, 1, per_side + 1)
    X = np.stack(np.meshgrid(axes, axes, indexing="ij"), axis=-1).reshape(-1, 2)  # not jittered
    if name.endswith("6"):
        X, cells, _ = second_order(X, oriented(X, cells), inner)
    s, t = X.T
    place = np.column_stack([48 * s, 44 * s * (1 - t) + t * (44 + 16 * s)])
    lam, mu = nu / ((1 + nu) * (1 - 2 * nu)), 1 / (2 * (1 + nu))
    K = stiffness(name, place, cells, np.array([lam, mu, 1.0, 0, 0]))
    load = np.zeros_like(place)
    right = np.flatnonzero(s > 1 - 1e-9)
    right = right[np.argsort(t[right])]
    step, order = (2, 3) if name.endswith("6") else (1, 2)
    facets = np.array([[right[i], right[i + step], *right[i + 1 : i + step]] for i in range(0, len(right) - 1, step)])
    params = np.array([0, 1 / 16, 0, 1 / 16, 0, 0, 1.0])
    k.Element(f"traction_edge{order}").residual(place, 0 * place, facets.astype(np.int32), params, load)
    free = np.flatnonzero(np.repeat(s > 1e-9, 2))
    u = np.zeros(place.size)
    u[free] = spsolve(K[free][:, free], -load.ravel()[free])
    middle = right[len(right) // 2]
    assert np.allclose(place[middle], [48, 52])
    return float(u[2 * middle + 1])


@pytest.mark.parametrize("name", ["linear_elastic_tri3", "linear_elastic_dilatation_tri6"])
def test_cooks_membrane_does_not_lock(name):
    """nu = 0.4999, plane strain: 18.527 at the middle of the right side (still moving in its third digit)."""
    found = cook(name, 16, 0.4999)
    if name.endswith("tri3"):
        assert found < 0.6 * 18.527  # what locking looks like
    else:
        assert found == pytest.approx(18.527, rel=5e-3)


def test_mean_dilatation_still_converges_to_the_compressible_answer():
    """Plane strain at nu = 1/3: against the displacement element on a finer mesh."""
    fine = cook("linear_elastic_tri6", 24, 1 / 3)
    assert cook("linear_elastic_dilatation_tri6", 12, 1 / 3) == pytest.approx(fine, rel=3e-3)
