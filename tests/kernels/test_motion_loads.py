"""Loads of a motion on a new mesh, beside sums over the points one by one."""

import numpy as np
import pytest

from restshape import _kernels
from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.mesh.quadrature import SAMPLES

POINTS, WEIGHTS = SAMPLES
AT = np.ascontiguousarray(POINTS[:, 1:])
CELLS = {3: [[0, 1, 2], [1, 3, 2]], 6: [[0, 1, 2, 4, 5, 6], [1, 3, 2, 7, 8, 5]]}
NODES = [[0, 0], [1, 0], [0, 1], [1, 1], [0.5, 0], [0.5, 0.5], [0, 0.5], [1, 0.5], [0.5, 1]]


def basis(points, nodes):
    if nodes == 6:
        return quadratic_basis(points)
    x, y = points.T
    return np.stack([1 - x - y, x, y], axis=1), np.tile([[-1.0, -1.0], [1.0, 0.0], [0.0, 1.0]], (len(points), 1, 1))


def mesh(nodes, rng):
    X = np.array(NODES[: 4 if nodes == 3 else 9], dtype=float)
    return X + 0.05 * rng.normal(size=X.shape), np.array(CELLS[nodes], dtype=np.int32)


@pytest.mark.parametrize("averaged", [False, True])
@pytest.mark.parametrize("nodes", [3, 6])
def test_lacking_forces_are_those_of_the_points_one_by_one(nodes, averaged):
    rng = np.random.default_rng(nodes)
    (old_X, cells), (X, _) = mesh(nodes, rng), mesh(nodes, rng)
    u, start = rng.normal(size=old_X.shape), rng.normal(size=X.shape)
    found = rng.integers(0, 2, size=2 * len(AT)).astype(np.int32)
    places = rng.dirichlet([1, 1, 1], size=len(found))[:, 1:]
    values, slopes = basis(places, nodes)
    moduli = rng.uniform(1, 2, size=(2, 3))
    means = rng.normal(size=2) if averaged else np.empty(0)
    forces = _kernels.lacking_forces(
        old_X, cells, u, X, cells, start, AT, WEIGHTS, found, np.ascontiguousarray(values), moduli, means
    )
    wanted = np.zeros_like(X)
    own_slopes = basis(AT, nodes)[1]
    for e, (lame, shear, thickness) in enumerate(moduli):
        parts = []
        for q, weight in enumerate(WEIGHTS):
            k = len(AT) * e + q
            there = np.linalg.solve(slopes[k].T @ old_X[cells[found[k]]], slopes[k].T @ u[cells[found[k]]])
            jacobian = own_slopes[q].T @ X[cells[e]]
            gradients = np.linalg.solve(jacobian, own_slopes[q].T)
            here = gradients @ start[cells[e]]
            parts.append((weight * np.linalg.det(jacobian), gradients, there, here, found[k]))
        area = sum(part for part, *_ in parts)
        mean = sum(p * (means[cell] - np.trace(here)) for p, _, _, here, cell in parts) / area if averaged else 0.0
        for part, gradients, there, here, _ in parts:
            strain = 0.5 * (there - here + (there - here).T)
            stress = lame * (mean if averaged else np.trace(strain)) * np.eye(2) + 2 * shear * strain
            np.add.at(wanted, cells[e], 0.5 * part * thickness * gradients.T @ stress)
    np.testing.assert_allclose(forces, wanted, rtol=0, atol=1e-12)


def test_momenta_are_those_of_the_points_one_by_one():
    rng = np.random.default_rng(1)
    (_, cells), (X, _) = mesh(6, rng), mesh(6, rng)
    v, density = rng.normal(size=X.shape), rng.uniform(1, 2, size=(2, 1))
    found = rng.integers(0, 2, size=2 * len(AT)).astype(np.int32)
    values = basis(rng.dirichlet([1, 1, 1], size=len(found))[:, 1:], 6)[0]
    momenta = _kernels.momenta(cells, v, X, cells, AT, WEIGHTS, found, np.ascontiguousarray(values), density)
    wanted, (own, slopes) = np.zeros_like(X), basis(AT, 6)
    for e, (mass,) in enumerate(density):
        for q, weight in enumerate(WEIGHTS):
            k = len(AT) * e + q
            velocity = values[k] @ v[cells[found[k]]]
            part = 0.5 * weight * mass * np.linalg.det(slopes[q].T @ X[cells[e]])
            np.add.at(wanted, cells[e], part * np.outer(own[q], velocity))
    np.testing.assert_allclose(momenta, wanted, rtol=0, atol=1e-13)


def test_points_in_cells_that_do_not_exist_are_refused():
    rng = np.random.default_rng(1)
    X, cells = mesh(6, rng)
    values = basis(np.tile(AT, (2, 1)), 6)[0]
    found = np.full(2 * len(AT), 2, dtype=np.int32)
    with pytest.raises(ValueError, match="points lie in cells that do not exist"):
        _kernels.momenta(cells, X, X, cells, AT, WEIGHTS, found, values, np.ones(1))
