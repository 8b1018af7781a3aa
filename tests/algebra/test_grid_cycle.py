"""Cycles of multigrid in single precision against the same cycles in dense linear algebra, and what they solve."""

import json

import numpy as np
import pytest
from petsc4py import PETSc
from small_scenes import across, drag, plate, write_scene, write_script

from restshape import _kernels
from restshape.algebra.preconditioner import cycle_in_single, set_preconditioner, set_rigid_motions
from restshape.measurement import plate as grid

EVENTS = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.7, 0.5), 8))


def stiffness(side: int) -> tuple[_kernels.Operator, PETSc.Mat, np.ndarray]:
    """Plane stress of a square plate that is held on the left; its operator, which owns the matrix, and its nodes."""
    X, cells = grid(side)
    element = _kernels.Element("linear_elastic_tri3")
    values = {"lambda": 1.2, "mu": 0.8, "thickness": 1.0}
    parameters = np.array([values.get(name, 0.0) for name in element.parameters])
    operator = _kernels.Operator(False, 2, np.array([0, len(X)], dtype=np.int32), 0, "csr")
    operator.set_topology([cells])
    operator.set_constraints(np.repeat(X[:, 0] == 0.0, 2).astype(np.uint8))
    operator.begin()
    operator.add(0, X, [(element, np.zeros_like(X), parameters, 1.0)], None)
    operator.end()
    mat = operator.mat
    mat.setOption(PETSc.Mat.Option.SPD, True)
    return operator, mat, X


@pytest.fixture
def made():
    """Multigrid of a plate, set up, and its matrix."""
    operator, mat, X = stiffness(16)
    ksp = PETSc.KSP().create(PETSc.COMM_SELF)
    ksp.setOptionsPrefix("cycle_")
    given = set_preconditioner(ksp, "gamg", 0)
    set_rigid_motions(mat, X)
    ksp.setOperators(mat)
    ksp.setUp()
    yield operator, mat, ksp.getPC()
    for key in given:
        PETSc.Options("cycle_").delValue(key)
    ksp.destroy()


def dense(mat: PETSc.Mat) -> np.ndarray:
    """A matrix of PETSc's, whole; it stays what it is."""
    return mat.convert("dense", PETSc.Mat()).getDenseArray().copy()


def swept(A: np.ndarray, size: int) -> np.ndarray:
    """The inverse of the lower half with the diagonal in blocks of a node; what has no stiffness does not move."""
    block = np.arange(len(A)) // size
    lower, inverse = np.where(block[:, None] > block, A, 0.0), np.zeros_like(A)
    for k in range(0, len(A), size):
        inverse[k : k + size, k : k + size] = np.linalg.pinv(A[k : k + size, k : k + size], rcond=1e-10)
    return np.linalg.solve(np.eye(len(A)) + inverse @ lower, inverse)


def reference(pc: PETSc.PC, level: int, b: np.ndarray) -> np.ndarray:
    """A V-cycle from a grid downwards."""
    matrix = pc.getMGSmoother(level).getOperators()[0]
    A = dense(matrix)
    if level == 0:
        return np.linalg.lstsq(A, b, rcond=1e-12)[0]
    P, sweep = dense(pc.getMGInterpolation(level)), swept(A, matrix.getBlockSize())
    x = sweep @ b
    x += P @ reference(pc, level - 1, P.T @ (b - A @ x))
    return x + sweep.T @ (b - A @ x)


def test_a_cycle_is_one_sweep_down_and_one_up_on_each_grid(made):
    _, mat, pc = made
    assert cycle_in_single(pc) and pc.getMGLevels() >= 2
    b, x = mat.createVecs()
    b.setArray(np.random.default_rng(1).normal(size=b.getSize()))
    pc.apply(b, x)
    expected = reference(pc, pc.getMGLevels() - 1, b.getArray().copy())
    # Numbers of single precision.
    assert np.linalg.norm(x.getArray() - expected) < 1e-5 * np.linalg.norm(expected)


def test_a_cycle_is_symmetric_and_positive(made):
    """As conjugate gradients need it, but for rounding."""
    _, mat, pc = made
    assert cycle_in_single(pc)
    u, v = mat.createVecs()
    rng = np.random.default_rng(2)
    pairs = []
    for vector in (u, v):
        vector.setArray(rng.normal(size=vector.getSize()))
    for one, other in ((u, v), (v, u)):
        applied = one.duplicate()
        pc.apply(one, applied)
        pairs.append(applied.dot(other))
        assert applied.dot(one) > 0.0
    assert pairs[0] == pytest.approx(pairs[1], rel=1e-4)


def test_what_options_say_of_smoothing_stays_petscs(made):
    _, mat, pc = made
    b, x = mat.createVecs()
    b.set(1.0)
    pc.apply(b, x)
    own = x.getArray().copy()
    assert cycle_in_single(pc)
    pc.apply(b, x)
    assert not np.allclose(x.getArray(), own, rtol=1e-3, atol=0.0)
    PETSc.Options()["cycle_mg_levels_ksp_max_it"] = 2
    try:
        assert not cycle_in_single(pc)
    finally:
        PETSc.Options().delValue("cycle_mg_levels_ksp_max_it")
    pc.apply(b, x)
    np.testing.assert_array_equal(x.getArray(), own)


def test_matrices_that_may_be_indefinite_keep_petscs_cycles(made):
    _, mat, pc = made
    mat.setOption(PETSc.Mat.Option.SPD, False)
    assert not cycle_in_single(pc)


def test_iterations_on_ranks_are_those_of_one(tmp_path, on_ranks, command):
    """Multigrid, with parity; the bound is what two more ranks' borders may cost."""
    scene, script = write_scene(tmp_path, plate(0.05)), write_script(tmp_path, EVENTS)
    words = ("replay", scene, "--edits", script, "--set", "solve.factor_memory=1e4", "--parity", "--json")
    found = {}
    for ranks in (1, 2):
        done = command(*words, "1.json") if ranks == 1 else on_ranks(2, *words, "2.json")
        assert done.returncode == 0, done.stdout + done.stderr
        found[ranks] = json.loads((tmp_path / f"{ranks}.json").read_text())
        assert list(found[ranks]["preconditioners"]) == ["gamg"] and found[ranks]["parity"]["holds"]
    one, two = (found[ranks]["iterations"] for ranks in (1, 2))
    assert 0 < two <= 1.25 * one + 2


def test_forgotten_products_are_found_again(made):
    """A set-up for another matrix gives the same coarse grids with what is kept for it, and without."""
    _, mat, pc = made
    b, x = mat.createVecs()
    b.setArray(np.sin(np.arange(b.getSize())))

    def again():
        mat.scale(3.0)
        pc.setUp()
        pc.apply(b, x)
        return pc.getMGSmoother(0).getOperators()[0], 3.0 * x.getArray()

    first = pc.getMGSmoother(0).getOperators()[0]
    kept, expected = again()
    _kernels.forget_products(pc.handle)
    new, found = again()
    assert kept.handle == first.handle != new.handle
    np.testing.assert_allclose(3.0 * found, expected, rtol=1e-10)
