"""Integrals of elements: stresses, and the work's derivatives by the places of nodes, against Taylor's remainder."""

from dataclasses import replace

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.operator import Operator
from restshape.fem.assembled import Assembled
from restshape.fem.elements import OSEEN, TRACTION
from restshape.fem.integral import Integral

X = np.array([[0.0, 0.0], [1.0, 0.1], [0.9, 1.2], [-0.1, 0.8]])
CELLS = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
LAW = np.array([2.0, 1.0, 0.5, 0.0, 0.0])


def integral(places: np.ndarray, factor: float = 1.0) -> Integral:
    return Integral(_kernels.Element("linear_elastic_tri3"), places, CELLS, LAW, factor)


@pytest.mark.parametrize("factor", [1.0, -3.0])
def test_derivatives_of_the_work_by_the_places_of_nodes(factor):
    rng = np.random.default_rng(1)
    x, dX = rng.uniform(-1, 1, X.shape), rng.uniform(-1, 1, X.shape)
    rates = integral(X, factor).work_derivatives(x)
    gradient = np.zeros_like(X)
    np.add.at(gradient, CELLS, rates)

    def work(h: float) -> float:
        return float((x * Assembled([integral(X + h * dX, factor)]).residual(x)).sum())

    remainders = [abs(work(h) - work(0.0) - h * (gradient * dX).sum()) for h in (1e-3, 5e-4)]
    assert np.log2(remainders[0] / remainders[1]) == pytest.approx(2.0, abs=0.05)


def test_stress_of_a_stretch():
    stretch = np.column_stack([0.01 * X[:, 0], 0.0 * X[:, 1]])
    points = np.array([[0.2, 0.3], [0.5, 0.1]])
    for stress in (integral(X).stress(stretch), *integral(X).stress(stretch, points).swapaxes(0, 1)):
        np.testing.assert_allclose(stress[:, :3], [[0.04, 0.02, 0.0]] * 2, atol=1e-15)


@pytest.mark.parametrize("block", [0, 1, None])
def test_an_element_without_a_tangent_has_no_block(block):
    facets = np.array([[0, 1]], dtype=np.int32)
    X = np.array([[0.0, 0.0], [1.0, 0.0]])
    assert Integral(TRACTION["edge2"], X, facets, np.zeros(7), block=block).block is None


SEAM = np.array([[0, 1, 1], [0, 1, 0]], dtype=np.int32)
"""The nodes whose unknowns the two triangles have where the upper side is sewn to the lower one: 3 is 0, 2 is 1."""


def sewn(places: np.ndarray) -> Integral:
    return Integral(_kernels.Element("linear_elastic_tri3"), places, CELLS, LAW, dofs=SEAM)


def advected(places: np.ndarray, w: np.ndarray, dw: np.ndarray) -> tuple[Integral, np.ndarray]:
    """A flow advected with a velocity w that changes by dw a unit of the motion, and its dofs."""
    cell, dofs = np.arange(6, dtype=np.int32)[None], np.arange(15, dtype=np.int32)[None]
    params = np.array([0.7, 0.3, -0.9, 1.3])
    made = Integral(OSEEN["tri6"], places, cell, params, coefficients=w, dofs=dofs, coefficient_rate=lambda dX: dw)
    return made, dofs


def test_a_seam_is_a_matter_of_dofs():
    rng = np.random.default_rng(5)
    x, owner = rng.uniform(-1, 1, (2, 2)), np.array([0, 1, 1, 0])
    whole = integral(X)
    # As many unknowns as nodes, tied together by a matrix: the residual of the sewn body is the sum over ties.
    expected = np.zeros_like(x)
    np.add.at(expected, owner, Assembled([whole]).residual(x[owner]))
    np.testing.assert_allclose(Assembled([sewn(X)]).residual(x), expected, atol=1e-14)
    np.testing.assert_allclose(sewn(X).energies(x), whole.energies(x[owner]))
    np.testing.assert_allclose(sewn(X).stress(x), whole.stress(x[owner]))
    np.testing.assert_allclose(sewn(X).work_derivatives(x), whole.work_derivatives(x[owner]), atol=1e-14)
    d, dX = rng.uniform(-1, 1, x.shape), rng.uniform(-1, 1, X.shape)
    expected[:] = 0.0
    np.add.at(expected, owner, Assembled([whole]).design_product(x[owner], dX, d[owner]))
    np.testing.assert_allclose(Assembled([sewn(X)]).design_product(x, dX, d), expected, atol=1e-14)


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
def test_the_tangent_of_a_seam_is_that_of_its_product(backend):
    x, d = np.random.default_rng(6).uniform(-1, 1, (2, 2, 2))
    operator = Operator(PETSc.COMM_SELF, 2, np.array([0, 2], dtype=np.int32), backend)
    operator.set_topology([(CELLS, SEAM)], np.zeros(4, dtype=np.uint8))
    assembled = Assembled([sewn(X)], operator)
    right = np.zeros_like(x)
    mat = assembled.tangent(x, right)
    dense = mat.convert("dense", PETSc.Mat()).getDenseArray()
    np.testing.assert_allclose(dense @ d.ravel(), assembled.tangent_product(x, d).ravel(), atol=1e-13)
    np.testing.assert_allclose(right, assembled.residual(x), atol=1e-13)


def test_nodal_coefficients_reach_residual_tangent_and_design():
    rng = np.random.default_rng(7)
    places = np.array([[0.0, 0.0], [1.0, 0.1], [0.2, 0.9], [0.5, 0.0], [0.65, 0.5], [0.05, 0.45]])
    w, dw, dX = rng.uniform(-1, 1, (3, 6, 2))
    x, d = rng.uniform(-1, 1, (2, 15, 1))
    made, dofs = advected(places, w, dw)
    still, _ = advected(places, np.zeros_like(w), dw)
    assert np.abs(Assembled([made]).residual(x) - Assembled([still]).residual(x)).max() > 1e-3
    operator = Operator(PETSc.COMM_SELF, 1, np.array([0, 15], dtype=np.int32), symmetric=False)
    operator.set_topology([(made.entities, dofs)], np.zeros(15, dtype=np.uint8))
    for assembled in (Assembled([made], operator), Assembled([replace(made, factor=-2.0)], operator)):
        dense = assembled.tangent(x).convert("dense", PETSc.Mat()).getDenseArray()
        np.testing.assert_allclose(dense @ d, assembled.tangent_product(x, d), atol=1e-13)
        right = np.zeros_like(x)
        assembled.system(x, right)
        np.testing.assert_allclose(right, -assembled.residual(x), atol=1e-13)
    rate, start, remainders = Assembled([made]).design_product(x, dX), Assembled([made]).residual(x), []
    for h in (2e-4, 1e-4):
        there, _ = advected(places + h * dX, w + h * dw, dw)
        remainders.append(np.linalg.norm(Assembled([there]).residual(x) - start - h * rate))
    assert remainders[0] / remainders[1] == pytest.approx(4.0, rel=0.05)
    assert np.abs(rate - Assembled([replace(made, coefficient_rate=None)]).design_product(x, dX)).max() > 1e-3
