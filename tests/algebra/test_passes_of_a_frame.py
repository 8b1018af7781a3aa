"""What is done in one pass of compiled code gives what its parts give, one after the other."""

from time import perf_counter

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.linear_report import true_residual
from restshape.algebra.operator import CellSubset, Operator
from restshape.algebra.row_products import combined, row_products
from restshape.algebra.stages import Stages
from restshape.fem.elements import LINEAR_ELASTIC
from restshape.measurement import UNIT_STIFFNESS, plate, plate_system

RANDOM = np.random.default_rng(3)


def test_a_step_is_guessed_as_by_its_parts():
    forces, steps = RANDOM.normal(size=(4, 700)), RANDOM.normal(size=(3, 700))
    gram, guess = row_products(forces[:3], forces[:3]), RANDOM.normal(size=700)
    products, weights = row_products(forces, forces[3:])[:, 0], np.zeros((1, 3))
    _kernels.ridge_weights(gram, products, 1e-10, weights)
    wanted, found = guess + combined(weights, steps)[0], np.zeros(4)
    _kernels.guess_step(forces, gram, 1e-10, steps, found, guess)
    assert np.array_equal(found, products) and np.array_equal(guess, wanted)


def test_a_step_is_kept_with_its_force_and_products():
    forces, steps, gram = RANDOM.normal(size=(4, 6)), np.zeros((3, 8)), RANDOM.normal(size=(3, 3))
    now, before, products = RANDOM.normal(size=(4, 2)), RANDOM.normal(size=(4, 2)), np.arange(1.0, 5.0)
    rest = gram[np.ix_([0, 2], [0, 2])].copy()
    _kernels.keep_step(now, before, products, 1, steps, forces, gram)
    assert np.array_equal(steps[1], (now - before).ravel()) and not steps[[0, 2]].any()
    assert np.array_equal(forces[1], forces[3])
    assert gram[1].tolist() == gram[:, 1].tolist() == [1.0, 4.0, 3.0]
    assert np.array_equal(gram[np.ix_([0, 2], [0, 2])], rest)


def test_sizes_of_steps_are_looked_at():
    three, four = np.zeros((3, 5)), np.zeros((4, 5))
    with pytest.raises(ValueError, match="forces"):
        _kernels.guess_step(three, np.zeros((3, 3)), 0.0, three, np.zeros(4), np.zeros(5))
    with pytest.raises(ValueError, match="now and before"):
        _kernels.keep_step(np.zeros(4), np.zeros(5), np.zeros(4), 0, three, four, np.zeros((3, 3)))
    with pytest.raises(ValueError, match="now and before"):
        _kernels.keep_step(np.zeros(5), np.zeros(5), np.zeros(4), 3, three, four, np.zeros((3, 3)))


def test_points_follow_a_hand_as_whole_arrays_do():
    reference, basis = RANDOM.normal(size=(7, 2)), RANDOM.normal(size=(2, 7, 2))
    found = _kernels.moved_points(reference, basis, 0.3, -0.7)
    assert np.array_equal(found, reference + (0.3 * basis[0] + -0.7 * basis[1]))
    with pytest.raises(ValueError, match="basis"):
        _kernels.moved_points(reference, basis[:1], 0.3, -0.7)


def test_a_residual_needs_one_vector_beside_its_right_side():
    mat, x, b, _ = plate_system(*plate(6))
    x.setRandom()
    rest = b.duplicate()
    mat.mult(x, rest)
    rest.aypx(-1.0, b)
    assert true_residual(mat, b, x) == rest.norm() / b.norm()
    beside = b.query("restshape_beside")
    assert beside and true_residual(mat, b, x, 2.0) == rest.norm() / 2.0
    assert b.query("restshape_beside").handle == beside.handle


def test_steps_of_conjugate_gradients_are_those_of_their_definition():
    """With the diagonal as preconditioner, and no product where the last step is that of the preconditioner."""
    mat, _, b, _ = plate_system(*plate(8))
    pc = PETSc.PC().create(PETSc.COMM_SELF)
    pc.setType("jacobi")
    pc.setOperators(mat)
    pc.setUp()
    right, found = b.getArray().copy(), np.empty(b.getSize())
    assert _kernels.conjugate_steps(mat.handle, pc.handle, right, found, 0.0, 1, 1e-24, 1000)
    matrix = mat.getValuesCSR()
    dense = np.zeros((len(right), len(right)))
    for row in range(len(right)):
        part = slice(matrix[0][row], matrix[0][row + 1])
        dense[row, matrix[1][part]] = matrix[2][part]
    assert np.allclose(dense @ found, right, atol=1e-8)
    assert not _kernels.conjugate_steps(mat.handle, pc.handle, right, found, 0.0, 1, 1e-24, 2)
    # One step, and the preconditioned residual.
    assert _kernels.conjugate_steps(mat.handle, pc.handle, right, found, 0.0, 0, 1e9, 5)
    step = right / dense.diagonal()
    length = (right @ step) / (step @ dense @ step)
    assert np.allclose(found, length * step + (right - length * dense @ step) / dense.diagonal())


def test_terms_that_follow_one_another_are_summed_together():
    """Of a block on one X, in one loop over its cells; of some cells, or another X, in one of their own."""
    X, cells = plate(5)
    element, params = LINEAR_ELASTIC["tri3"], np.array(UNIT_STIFFNESS)
    operator = Operator(PETSc.COMM_SELF, 2, np.array([0, len(X)], dtype=np.int32))
    operator.set_topology([cells], np.zeros((len(X), 2), dtype=np.uint8))
    some = CellSubset(0, np.arange(4, dtype=np.int32))
    x = RANDOM.normal(size=X.shape)
    terms = [(0, element, X, x, params, 1.0), (0, element, X, x, params, 2.0), (some, element, X, x, params, 1.0, 3.0)]
    found, right = {}, np.zeros(X.shape)
    mat = operator.assemble(terms, right.ravel())
    found["all"] = mat.getValuesCSR()[2].copy()
    parts, wanted = np.zeros_like(found["all"]), np.zeros(X.shape)
    for term in terms:
        parts += operator.assemble([term], wanted.ravel()).getValuesCSR()[2]
    assert np.allclose(found["all"], parts) and np.allclose(right, wanted)
    with pytest.raises(ValueError, match="a term of a sum"):
        operator.core.assemble([(0, element)], None)


def test_stages_within_others_count_once():
    stages, begun = Stages(), perf_counter()
    with stages("krylov"), stages("factor"):
        sum(range(100_000))
    # Whatever else the machine does: time that counted twice would make more than there was.
    taken = perf_counter() - begun
    assert stages.seconds["factor"] > 0.0 and stages.seconds["krylov"] > 0.0
    assert stages.seconds["factor"] + stages.seconds["krylov"] < taken + 1e-6
    stages.reset()
    assert not any(stages.seconds.values())
    with pytest.raises(KeyError, match="failed"), stages("values"):
        raise KeyError("failed")
    assert stages.seconds["values"] > 0.0


def test_a_weighted_sum_takes_rows_in_any_order_and_of_any_numbers():
    fields = [np.asfortranarray(RANDOM.normal(size=(300, 2))) for _ in range(3)] + [np.arange(600).reshape(300, 2)]
    weights, found = [0.5, -2.0, 3.0, 0.25], np.empty((300, 2))
    _kernels.weighted_sum(weights, fields, found)
    np.testing.assert_allclose(found, sum(weight * field for weight, field in zip(weights, fields)), rtol=1e-14)
