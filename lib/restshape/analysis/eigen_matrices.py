"""Stiffness and mass matrices of a vibrating body, and what a cold solve of their eigenproblem differs by."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from petsc4py import PETSc

from restshape.algebra.gather import matrix_difference, whole_matrix
from restshape.algebra.krylov_schur import krylov_schur
from restshape.algebra.operator import Operator
from restshape.algebra.pencil import Deflation, Pencil
from restshape.physics.vibrating_bodies import oscillator
from restshape.physics.elasticity.vibrating_body import Oscillator

if TYPE_CHECKING:
    from restshape.analysis.modal import ModalAnalysis

COLD = 1e-10
"""Residual that a cold solve for comparison goes down to."""


def operators_of(body: Oscillator, backend: str | None = None) -> list[Operator]:
    """What assembles the stiffness and the mass of a body, of one pattern each."""
    offsets = np.array([0, len(body.mesh.X)], dtype=np.int32)
    operators = [Operator(PETSc.COMM_SELF, body.fields, offsets, backend) for _ in range(2)]
    for operator in operators:
        operator.set_topology([body.mesh.cells], body.mask)
    return operators


def assembled(operators: Sequence[Operator], body: Oscillator, held: np.ndarray) -> tuple[PETSc.Mat, PETSc.Mat]:
    """K and M of a body as its nodes lie; they belong to the operators. `held` are the unknowns (k,) that rest."""
    rest = np.zeros(body.mask.shape)
    stiffness, mass = (
        operator.assemble([(0, element, body.mesh.X, rest, params, 1.0)], None)
        for operator, element, params in zip(
            operators, (body.stiffness, body.mass), (body.stiffness_params, body.mass_params)
        )
    )
    if len(held):
        # Alone on their rows, with a mass they would be modes of their own.
        diagonal = mass.getDiagonal()
        diagonal.getArray()[held] = 0.0
        mass.setDiagonal(diagonal)
        diagonal.destroy()
    return stiffness, mass


def cold_differences(analysis: ModalAnalysis) -> tuple[float, float]:
    """Largest differences of the matrices' entries and of frequencies from a solve with nothing kept; relative."""
    body = oscillator(analysis.scene, analysis.plan, analysis.mesh, analysis.policy.lumped_mass)
    fresh = operators_of(body, "coo")
    cold = assembled(fresh, body, np.flatnonzero(body.mask))
    pairs = [(hot, whole_matrix(mat, PETSc.COMM_SELF)) for hot, mat in zip(analysis.matrices(), cold)]
    entries = max(matrix_difference(*pair) for pair in pairs)
    pencil = Pencil(analysis.stages)
    pencil.take(*cold, True)
    pencil.factor(-1e-2 * float(analysis.values[0]))
    found = krylov_schur(pencil, Deflation(body.rigid(), pencil), None, int(analysis.chosen[-1]) + 1, COLD)
    reference = np.sqrt(found.values[analysis.chosen]) / (2.0 * np.pi)
    return entries, float(np.max(np.abs(analysis.frequencies / reference - 1.0)))
