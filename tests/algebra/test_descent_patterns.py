"""Descents whose tangent gets another pattern, and so is another matrix, in the midst of a run."""

import numpy as np
import pytest
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.nonlinear.descent import Descent


class Quartic:
    """The energy sum of (x - 1)^4 / 4 + (x - 1)^2 / 2, whose tangent is another matrix each time it is asked for."""

    constrained = np.empty(0, dtype=np.int64)

    def __init__(self) -> None:
        self.matrices: list[PETSc.Mat] = []

    def residual(self, x, out):
        out[:] = (x - 1.0) ** 3 + (x - 1.0)

    def energy(self, x):
        return float((0.25 * (x - 1.0) ** 4 + 0.5 * (x - 1.0) ** 2).sum())

    def tangent(self, x):
        n = x.size
        matrix = PETSc.Mat().createAIJ((n, n), nnz=1 + len(self.matrices) % 2, comm=PETSc.COMM_SELF)
        for i, value in enumerate(3.0 * (x.ravel() - 1.0) ** 2 + 1.0):
            matrix[i, i] = value
        matrix.assemble()
        self.matrices.append(matrix)
        return matrix


@pytest.mark.parametrize("kind", ["newton", "quasi"])
def test_a_new_matrix_within_a_run_is_solved_with(kind):
    energy, x = Quartic(), np.full((4, 3), 3.0)
    descent = Descent(PETSc.COMM_SELF, f"patterns_{kind}_", energy, x.shape, slice(0, 12), kind)
    norm = descent.run(x, 1e-10, 50)
    assert norm <= 1e-10 and x == pytest.approx(np.ones((4, 3)), abs=1e-9)
    # Newton's method takes one in each step, and converges by squares.
    assert len(energy.matrices) == (descent.steps if kind == "newton" else 1) and descent.steps < 15
    # A factor that serves many steps substitutes by panels.
    factor = descent.ksp.getPC().getFactorMatrix()
    assert _kernels.panel_value_bytes(factor.handle) == (8 if kind == "quasi" else 0)
    descent.destroy()
