"""Stresses recovered at the nodes of second-order triangles: exact where they must be, and their order."""

import numpy as np
import pytest
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import spsolve

from restshape import _kernels
from restshape.fem.recovery import NodalFlux

LAMBDA, MU = 1.3, 0.7
HOOKE = np.array([LAMBDA, MU, 1.0, 0.0, 0.0])


class Square:
    """Second-order triangles on the unit square: what the recovery knows of a mesh.

    Args:
        per_side: cells a side. jitter: of inner corners, bend: of inner sides, both in cell sizes.
        split: cells right of the middle are another region.
    """

    def __init__(self, per_side: int, jitter: float = 0.0, bend: float = 0.0, split: bool = False) -> None:
        n, rng = per_side + 1, np.random.default_rng(3)
        X = np.array([(i, j) for j in range(n) for i in range(n)], dtype=float)
        inner = np.all((X > 0) & (per_side > X), axis=1) & (2 * X[:, 0] != per_side)
        X[inner] += rng.uniform(-jitter, jitter, (inner.sum(), 2))
        first = np.array([j * n + i for j in range(n - 1) for i in range(n - 1)])
        quads = np.column_stack([first, first + 1, first + n + 1, first + n])
        corners = np.vstack([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        sides = np.sort(np.concatenate([corners[:, [i, (i + 1) % 3]] for i in range(3)]), axis=1)
        edges, index = np.unique(sides, axis=0, return_inverse=True)
        middles = X[edges].mean(axis=1)
        inside = np.all((middles > 0) & (middles < per_side), axis=1) & (2 * middles[:, 0] != per_side)
        middles[inside] += rng.uniform(-bend, bend, (inside.sum(), 2))
        self.X = np.vstack([X, middles]) / per_side
        self.cells = np.ascontiguousarray(np.hstack([corners, len(X) + index.reshape(3, -1).T]), dtype=np.int32)
        right = self.X[self.cells[:, :3]].mean(axis=1)[:, 0] > 0.5
        self.cell_region = (right if split else 0 * right).astype(np.int32)
        self.border = np.any((self.X == 0) | (self.X == 1), axis=1)

    def stress(self, u: np.ndarray, points: np.ndarray, element: str = "linear_elastic_tri6") -> np.ndarray:
        out = np.zeros((len(self.cells), len(points), 4))
        _kernels.Element(element).stress(self.X, u, self.cells, HOOKE, out, points)
        return out


def clamped(mesh: Square, u: np.ndarray) -> np.ndarray:
    """The finite element displacement that agrees with u (n, 2) on the border."""
    element = _kernels.Element("linear_elastic_tri6")
    blocks = np.array([element.tangent_block(mesh.X[cell], 0 * mesh.X[cell], HOOKE) for cell in mesh.cells])
    dofs = (2 * mesh.cells[:, :, None] + np.arange(2)).reshape(len(mesh.cells), -1)
    rows, columns = np.broadcast_arrays(dofs[:, :, None], dofs[:, None, :])
    K = coo_matrix((blocks.ravel(), (rows.ravel(), columns.ravel())), (u.size, u.size)).tocsr()
    fixed = np.repeat(mesh.border, 2)
    free, found = np.flatnonzero(~fixed), u.ravel().copy()
    found[free] = spsolve(K[free][:, free], -K[free][:, np.flatnonzero(fixed)] @ found[fixed])
    return found.reshape(-1, 2)


def equilibrium(X: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Displacements and stresses in equilibrium without body force, by Kolosov and Muskhelishvili's phi = e^z, psi = 0.

    2 mu (u + i v) = (3 - 4 nu) phi - z conj(phi'); xx + yy = 4 Re phi'; yy - xx + 2i xy = 2 conj(z) phi''.
    """
    z, nu = X[:, 0] + 1j * X[:, 1], LAMBDA / (2 * (LAMBDA + MU))
    phi = np.exp(z)
    u = ((3 - 4 * nu) * phi - z * np.conj(phi)) / (2 * MU)
    total, other = 4 * phi.real, 2 * np.conj(z) * phi
    stress = [(total - other.real) / 2, (total + other.real) / 2, other.imag / 2, nu * total]
    return np.column_stack([u.real, u.imag]), np.column_stack(stress)


@pytest.mark.parametrize("jitter", [0.0, 0.25])
def test_stress_of_a_quadratic_displacement_is_exact_at_all_nodes(jitter):
    """Straight sides hold any quadratic displacement; its stress is linear, at corners, sides and borders too."""
    mesh = Square(5, jitter)
    a = np.random.default_rng(1).normal(size=(2, 6))
    x, y = mesh.X.T
    u = np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y]) @ a.T
    zero, one = np.zeros_like(x), np.ones_like(x)
    ux = a @ np.array([zero, one, zero, 2 * x, y, zero])
    uy = a @ np.array([zero, zero, one, zero, x, 2 * y])
    trace = ux[0] + uy[1]
    exact = np.column_stack(
        [LAMBDA * trace + 2 * MU * ux[0], LAMBDA * trace + 2 * MU * uy[1], MU * (uy[0] + ux[1]), LAMBDA * trace]
    )
    recovery = NodalFlux(mesh)
    np.testing.assert_allclose(recovery(mesh.stress(u, recovery.points)), exact, atol=1e-11)


def test_quadratic_stresses_are_recovered_exactly_around_inner_corners():
    """Given samples of a quadratic field on curved cells: its value at each node but those of cells cut off."""
    mesh = Square(6, jitter=0.2, bend=0.05)
    a = np.random.default_rng(2).normal(size=(6, 4))

    def field(places):
        x, y = places.reshape(-1, 2).T
        return (np.column_stack([np.ones_like(x), x, y, x * x, x * y, y * y]) @ a).reshape(*places.shape[:-1], 4)

    recovery = NodalFlux(mesh)
    l1, l2 = recovery.points.T
    l0 = 1 - l1 - l2
    N = np.column_stack(
        [l0 * (2 * l0 - 1), l1 * (2 * l1 - 1), l2 * (2 * l2 - 1), 4 * l0 * l1, 4 * l1 * l2, 4 * l2 * l0]
    )
    samples = field(np.einsum("qi,eia->eqa", N, mesh.X[mesh.cells]))
    inner = np.flatnonzero(~mesh.border)
    near = np.unique(mesh.cells[np.isin(mesh.cells[:, :3], inner).any(axis=1)])
    found = recovery(samples)
    assert len(near) >= len(mesh.X) - 10
    np.testing.assert_allclose(found[near], field(mesh.X)[near], atol=1e-10)
    assert np.isfinite(found).all()


@pytest.mark.parametrize(("jitter", "order"), [(0.0, 2.3), (0.25, 1.9)])
def test_recovered_stress_converges_at_second_order(jitter, order):
    """Root mean square over all nodes, borders too; on even meshes the fits gain a part of an order."""
    errors, plain = [], []
    for per_side in (6, 12, 24):
        mesh = Square(per_side, jitter)
        u, exact = equilibrium(mesh.X)
        u = clamped(mesh, u)
        recovery = NodalFlux(mesh)
        found = recovery(mesh.stress(u, recovery.points))
        errors.append(np.sqrt(np.mean((found - exact) ** 2)))
        corners = mesh.stress(u, np.array([[0.0, 0], [1, 0], [0, 1]]))
        plain.append(np.sqrt(np.mean((corners - exact[mesh.cells[:, :3]]) ** 2)))
    rates = np.log2(np.array(errors[:-1]) / errors[1:])
    assert rates.mean() > order, rates
    assert errors[-1] < plain[-1] / 3


def test_curved_cells_with_bends_that_vanish_with_the_square_of_their_size_keep_the_order():
    errors = []
    for per_side in (6, 12, 24):
        mesh = Square(per_side, jitter=0.1, bend=0.3 / per_side)
        u, exact = equilibrium(mesh.X)
        recovery = NodalFlux(mesh)
        found = recovery(mesh.stress(clamped(mesh, u), recovery.points))
        errors.append(np.sqrt(np.mean((found - exact) ** 2)))
    assert np.log2(errors[0] / errors[-1]) / 2 > 1.9


def test_each_region_has_its_own_stress_at_their_border():
    mesh = Square(4, split=True)
    recovery = NodalFlux(mesh)
    samples = np.broadcast_to(np.where(mesh.cell_region, 7.0, 1.0)[:, None, None], (len(mesh.cells), 3, 4)).copy()
    found = recovery(samples)
    np.testing.assert_allclose(found, np.where(recovery.region, 7.0, 1.0)[:, None] * np.ones(4), rtol=1e-12)
    assert len(recovery.nodes) == len(mesh.X) + np.sum(mesh.X[:, 0] == 0.5)


def test_two_cells_alone_give_their_own_linear_stress():
    mesh = Square(1)
    x, y = mesh.X.T
    u = np.column_stack([x**2, 0 * y])
    recovery = NodalFlux(mesh)
    found = recovery(mesh.stress(u, recovery.points))
    np.testing.assert_allclose(found[:, 0], (LAMBDA + 2 * MU) * 2 * x, atol=1e-13)
    np.testing.assert_allclose(found[:, 1], LAMBDA * 2 * x, atol=1e-13)
