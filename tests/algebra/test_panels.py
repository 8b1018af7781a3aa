"""Substitutions by panels: solutions of systems that numpy solves too, from factors that PETSc has made."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy.sparse as sp
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.linear import LinearSolver
from restshape.algebra.preconditioner import order_factor
from restshape.algebra.reuse import kept_preconditioner
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration


def matrix(n, fields, rng):
    """Positive definite (n n f, n n f): springs between neighbours of a grid, with so many unknowns a node."""
    line = sp.diags([1.0, 1.0], [-1, 1], (n, n))
    grid = sp.kron(sp.eye(n), line) + sp.kron(line, sp.eye(n)) + sp.kron(line, line) + sp.eye(n * n)
    pairs = sp.coo_matrix(sp.triu(sp.kron(grid, np.ones((fields, fields))), 1))
    springs = sp.coo_matrix((rng.uniform(-1.0, 1.0, pairs.nnz), (pairs.row, pairs.col)), pairs.shape)
    both = (springs + springs.T).tocsr()
    return (both + sp.diags(np.abs(both).sum(axis=1).A1 + 0.1)).tocsr()


def petsc(found):
    return PETSc.Mat().createAIJ(found.shape, csr=(found.indptr, found.indices, found.data), comm=PETSc.COMM_SELF)


def factored(mat, kind="cholesky", ordering="amd"):
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType(kind)
    if ordering == "nodes":
        order_factor(pc)
    else:
        pc.setFactorOrdering(ordering)
    pc.setOperators(mat)
    pc.setUp()
    return pc


def solved(pc, b):
    right, x = (PETSc.Vec().createWithArray(array, comm=PETSc.COMM_SELF) for array in (b.copy(), np.zeros_like(b)))
    pc.getFactorMatrix().solve(right, x)
    return x.getArray().copy()


@pytest.mark.parametrize(("n", "fields"), [(1, 1), (2, 1), (12, 1), (12, 2), (7, 3), (5, 11)])
@pytest.mark.parametrize("ordering", ["nodes", "amd", "natural", "nd"])
def test_a_system_is_solved(n, fields, ordering):
    rng = np.random.default_rng(n)
    found = matrix(n, fields, rng)
    pc, b = factored(petsc(found), ordering=ordering), rng.normal(size=found.shape[0])
    assert _kernels.solve_by_panels(pc.getFactorMatrix().handle)
    np.testing.assert_allclose(solved(pc, b), np.linalg.solve(found.toarray(), b), rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize(("fields", "ordering"), [(1, "nodes"), (2, "nodes"), (3, "nodes"), (2, "amd")])
def test_it_takes_the_values_of_a_factor_that_is_made_again(fields, ordering):
    rng = np.random.default_rng(5)
    found = matrix(9, fields, rng)
    mat, b = petsc(found), rng.normal(size=found.shape[0])
    pc = factored(mat, ordering=ordering)
    handle = pc.getFactorMatrix().handle
    assert _kernels.solve_by_panels(handle) and _kernels.solve_by_panels(handle)
    mat.scale(4.0)
    pc.setOperators(mat)
    pc.setUp()
    expected = np.linalg.solve(4.0 * found.toarray(), b)
    assert pc.getFactorMatrix().handle == handle
    np.testing.assert_allclose(solved(pc, b), expected, rtol=1e-10)
    assert _kernels.solve_by_panels(handle)
    np.testing.assert_allclose(solved(pc, b), expected, rtol=1e-10)


@pytest.mark.parametrize(("fields", "ordering"), [(1, "nodes"), (2, "nodes"), (3, "nodes"), (2, "amd")])
def test_single_precision_serves_until_double_is_asked_for(fields, ordering):
    rng = np.random.default_rng(6)
    found = matrix(9, fields, rng)
    pc, b = factored(petsc(found), ordering=ordering), rng.normal(size=found.shape[0])
    handle, expected = pc.getFactorMatrix().handle, np.linalg.solve(found.toarray(), b)

    def error(single):
        assert _kernels.solve_by_panels(handle, single)
        return np.linalg.norm(solved(pc, b) - expected) / np.linalg.norm(expected)

    assert 1e-10 < error(single=True) < 1e-5
    assert error(single=False) < 1e-12
    assert error(single=True) < 1e-12


def test_what_single_precision_cannot_solve_has_double():
    n = 400
    chain = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], (n, n)).tolil()
    chain[-1, -1] = 1.0
    beam = sp.csr_matrix(chain @ chain)
    pc, b = factored(petsc(beam), ordering="natural"), np.ones(n)
    assert _kernels.solve_by_panels(pc.getFactorMatrix().handle, single=True)
    expected = sp.linalg.spsolve(sp.csc_matrix(beam), b)
    assert np.linalg.norm(solved(pc, b) - expected) < 1e-4 * np.linalg.norm(expected)


def test_what_is_not_a_number_leaves_nothing_behind():
    rng = np.random.default_rng(6)
    found, b = matrix(9, 2, rng), rng.normal(size=162)
    pc = factored(petsc(found), ordering="nodes")
    assert _kernels.solve_by_panels(pc.getFactorMatrix().handle)
    before = solved(pc, b)
    assert np.isnan(solved(pc, np.full_like(b, np.nan))).all()
    np.testing.assert_array_equal(solved(pc, b), before)


def test_factors_of_other_kinds_stay_as_they_are():
    found = matrix(6, 2, np.random.default_rng(7))
    assert not _kernels.solve_by_panels(factored(petsc(found), "lu").getFactorMatrix().handle)
    assert not _kernels.solve_by_panels(petsc(found).handle)
    rough = factored(petsc(found), "icc", "natural")
    b = np.ones(found.shape[0])
    before = solved(rough, b)
    _kernels.solve_by_panels(rough.getFactorMatrix().handle)
    np.testing.assert_allclose(solved(rough, b), before, rtol=1e-12)


@pytest.mark.parametrize(("method", "expected"), [("stale", [0, 1, 1]), ("direct", [0, 1, 1])])
def test_a_factor_goes_by_panels_from_its_second_solve_on(monkeypatch, method, expected):
    singles = []

    def by_panels(handle, single):
        singles.append(single)
        assert _kernels.solve_by_panels(handle, single)

    used = {"solve_by_panels": by_panels, "forget_cycle": _kernels.forget_cycle}
    used["forget_failure"] = _kernels.forget_failure
    monkeypatch.setattr(kept_preconditioner, "_kernels", SimpleNamespace(**used))
    mat = petsc(matrix(6, 2, np.random.default_rng(8)))
    traits, stages = Traits(True), Stages()
    solver = LinearSolver(PETSc.COMM_SELF, "panels_", method, 1e-8, Calibration.load(), stages, traits=traits)
    b, x = mat.createVecs()
    counts = []
    for scale in (1.0, 1.01, 1.0) if method == "stale" else (1.0, 1.0, 1.0):
        mat.scale(scale)
        b.set(1.0)
        solver.solve(mat, b, x, new_system=not counts, same_matrix=method == "direct" and bool(counts))
        counts.append(len(singles))
    assert counts == expected
    # Where no iteration follows, single precision would be that of the solution.
    assert singles == [method == "stale"]
