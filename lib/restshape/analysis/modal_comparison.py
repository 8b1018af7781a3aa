"""What the modes of a frame differ by from those of a solve with nothing kept."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gathering import gather_matrix, matrix_difference
from restshape.algebra.krylov_schur import krylov_schur
from restshape.algebra.pencil import Deflation, Pencil
from restshape.analysis.analysis import Comparison, Context
from restshape.analysis.modal_matrices import ModalMatrices
from restshape.analysis.modal_state import ModalState, frequencies
from restshape.fem.eigenproblem import Maker
from restshape.first_use import made

COLD = 1e-10
"""Residual that a cold solve for comparison goes down to."""


def compare_cold(state: ModalState, context: Context, make: Maker) -> Comparison:
    """Largest differences of the matrices' entries and of frequencies from a solve with nothing kept; relative."""
    body = make(state.scene, state.plan, made(state.space), context.policy.lumped_mass)
    cold = ModalMatrices(body, "coo").assemble()
    pairs = zip(state.matrices.gather(), (gather_matrix(mat, PETSc.COMM_SELF) for mat in cold))
    entries = max(matrix_difference(*pair) for pair in pairs)
    chosen = state.modes.chosen
    pencil = Pencil(context.stages)
    pencil.set_matrices(*cold, True)
    pencil.factor(-1e-2 * float(state.modes.values[0]))
    deflation = Deflation(body.free_rigid_motions(), pencil)
    found = krylov_schur(pencil, deflation, None, int(chosen[-1]) + 1, COLD)
    return Comparison(entries, float(np.max(np.abs(state.frequencies / frequencies(found.values[chosen]) - 1.0))))
