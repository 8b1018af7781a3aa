"""Preconditioners are chosen by what a problem declares of its matrices."""

import numpy as np
import pytest
from petsc4py import PETSc
from scipy.sparse import csr_matrix

from restshape.algebra.linear import LinearSolver
from restshape.algebra.reuse.candidates import PLANE, SPACE, candidates
from restshape.algebra.reuse.choice import Choice
from restshape.algebra.reuse.prices import Size
from restshape.algebra.reuse.traits import Traits
from restshape.algebra.stages import Stages
from restshape.calibration import Calibration


def csr(dense: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A matrix as PETSc takes it, with its diagonal, zeros too."""
    found = csr_matrix(dense + 2e3 * np.eye(len(dense)))
    found.setdiag(dense.diagonal())
    return found.indptr, found.indices, found.data


def test_candidates_follow_the_declared_dimension_and_not_the_fields():
    assert candidates(Traits(fields=1)) == candidates(Traits(fields=3)) == PLANE
    assert candidates(Traits(fields=1, dimension=3)) == SPACE


def test_without_candidates_there_is_a_complete_factor_that_fits():
    for traits in (Traits(symmetric=False), Traits(definite=False)):
        assert candidates(traits) == ()
    assert (Traits().factor, Traits().krylov) == ("cholesky", "cg")
    assert (Traits(symmetric=False).factor, Traits(symmetric=False).krylov) == ("lu", "gmres")
    saddle = Traits(definite=False)
    assert (saddle.factor, saddle.krylov, saddle.pivots) == ("cholesky", "gmres", True)
    assert not Traits().pivots and not Traits(symmetric=False).pivots


def test_fill_and_iterations_follow_the_declared_unknowns_of_a_node():
    # One unknown a node has the pattern of nodes that two have at twice the unknowns, in blocks of a quarter.
    choice = Choice(Calibration.load())
    scalar, elastic = Size(20_000, 140_000.0, fields=1), Size(40_000, 560_000.0, fields=2)
    assert elastic.width == scalar.width == 1.0
    assert choice.filled(PLANE[0], scalar) == pytest.approx(choice.filled(PLANE[0], elastic) / 4.0)
    assert choice.expected(PLANE[1], scalar) == pytest.approx(choice.expected(PLANE[1], elastic))
    for known in (Size(40_000, 560_000.0), Size(39_999, 2e6, 3)):
        declared = Size(known.unknowns, known.nonzeros, known.dimension, fields=known.dimension)
        assert [choice.cost(one, known) for one in PLANE] == [choice.cost(one, declared) for one in PLANE]


def test_a_symmetric_system_with_zeros_on_its_diagonal_is_solved():
    traits = Traits(definite=False, fields=1)
    n, rng = 40, np.random.default_rng(1)
    stiffness = np.diag(np.arange(1.0, n + 1)) + 0.1 * np.eye(n, k=1) + 0.1 * np.eye(n, k=-1)
    rows = rng.uniform(-1, 1, (10, n))
    full = np.block([[np.zeros((10, 10)), rows], [rows.T, stiffness]])
    mat = PETSc.Mat().createAIJ(full.shape, csr=csr(full), comm=PETSc.COMM_SELF)
    mat.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    b, x = mat.createVecLeft(), mat.createVecRight()
    b.array = rng.uniform(-1, 1, n + 10)
    for method in ("direct", "stale", "auto"):
        x.set(0.0)
        solver = LinearSolver(PETSc.COMM_SELF, "saddle_", method, 1e-9, Calibration.load(), Stages(), traits=traits)
        solver.solve(mat, b, x, True)
        assert np.linalg.norm(full @ x.array - b.array) < 1e-8 * b.norm(), method


def test_only_matrices_that_are_definite_where_stable_belong_to_an_energy_that_is_least():
    assert Traits().minimises and not Traits(definite=False).minimises and not Traits(symmetric=False).minimises
