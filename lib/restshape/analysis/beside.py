"""Answers on another mesh with the same nodes, from the answer on this one and its kept preconditioner."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.correction import DELAY, conjugate_steps
from restshape.analysis.effective_system import StepWeights
from restshape.fem.assembled import Assembled
from restshape.fem.problem import STIFFNESS
from restshape.fem.residuals import unconstrained_residual

if TYPE_CHECKING:
    from collections.abc import Sequence

    from restshape.analysis.time_error import StepMatrix
    from restshape.fem.integral import Integral
    from restshape.fem.problem import SteadyProblem
    from restshape.fem.residuals import Operation
    from restshape.fem.semidiscrete import SemiDiscrete
    from restshape.fem.space import Space
    from restshape.fem.time_integration import Scheme, TimeState

    Difference = tuple[float, Sequence[Integral], Sequence[Integral]]

ENOUGH, LEAST, COMPLETE = {3: 1e-8}, 1e-12, 1e-8
"""Shares of the squared energy of a difference of two meshes that successive steps together add at the end: on cells of
so many nodes, and on all others, where most of it is of a poor guess: nodes in the middle of flipped edges have moved.
The last one is that of a single step on the former with an old complete factor, whose gains fall by ten a step."""


def solution_beside(problem: SteadyProblem, known: SteadyProblem, x: np.ndarray, matrix: StepMatrix) -> np.ndarray:
    """The solution (n, f) of a symmetric linear problem; not numbers where too many steps do not suffice.

    Args:
        problem: on the other mesh.
        known: on this one; x: (n, f) its solution.
        matrix: of this mesh.
    """
    problem.update()
    guess = np.where(problem.boundary.mask, problem.boundary.values, x)
    rest = -unconstrained_residual(problem, guess).ravel()
    rest[problem.boundary.constrained] = 0.0
    stiffness = (1.0, problem.integrals(STIFFNESS), known.integrals(STIFFNESS))
    changed = changed_cells(known.space, problem.space)
    other = product_beside(matrix.product, changed, (stiffness,), problem.boundary.mask)
    return guess + _steps(other, matrix, rest, problem.space).reshape(x.shape)


def step_beside(
    body: SemiDiscrete,
    known: SemiDiscrete,
    scheme: Scheme,
    state: TimeState,
    y: np.ndarray,
    base_acceleration: np.ndarray,
    matrix: StepMatrix,
) -> np.ndarray:
    """The unknowns (n, f) after a time step of a linear motion; not numbers where too many steps do not suffice.

    Args:
        body: on the other mesh.
        known: on this one; y: (n, f) after the same step on it.
        scheme: of the step, with a5 = 0.
        state: that it leads from, at rest where prescribed.
        base_acceleration: (f,) as in `EffectiveSystem.assemble`.
        matrix: of the step on this mesh.
    """
    weights = StepWeights(scheme, body.damping_of.alpha, body.damping_of.beta)
    stiff, inert = np.empty_like(y), np.empty_like(y)
    weights.apply(state, stiff, inert)
    stiff -= weights.of_stiffness * y
    inert -= weights.of_mass * y + base_acceleration
    rest = weights.load * body.static + body.mass.apply(inert)
    Assembled(body.problem.integrals(STIFFNESS)).residual(stiff, rest)
    rest[body.constrained] = 0.0
    stiffness = (weights.of_stiffness, body.problem.integrals(STIFFNESS), known.problem.integrals(STIFFNESS))
    mass = (weights.of_mass, body.mass.integrals, known.mass.integrals)
    changed = changed_cells(known.problem.space, body.problem.space)
    other = product_beside(matrix.product, changed, (stiffness, mass), body.constrained)
    return y + _steps(other, matrix, rest.ravel(), body.problem.space).reshape(y.shape)


def _steps(product: Operation, matrix: StepMatrix, rest: np.ndarray, space: Space) -> np.ndarray:
    """About the solution (n f,) of product(d) = rest on a space, with the preconditioner of a matrix near it."""
    first_order = space.cells.shape[1] in ENOUGH
    if matrix.complete and first_order:
        return conjugate_steps(product, matrix.precondition, rest, delay=1, enough=COMPLETE)
    enough = ENOUGH[space.cells.shape[1]] if first_order else LEAST
    return conjugate_steps(product, matrix.precondition, rest, delay=DELAY, enough=enough)


def changed_cells(one: Space, other: Space) -> np.ndarray:
    """Cells (k,) int32 that are not the same in two spaces with as many of them: by nodes, their places, or region."""
    differ = one.cells != other.cells
    if not np.array_equal(one.X, other.X):
        differ |= (one.X != other.X).any(axis=1)[other.cells]
    cells = [np.flatnonzero(differ) // differ.shape[1], np.flatnonzero(one.cell_region != other.cell_region)]
    return np.unique(np.concatenate(cells)).astype(np.int32)


def product_beside(
    product: Operation, changed: np.ndarray, differences: Sequence[Difference], constrained: np.ndarray
) -> Operation:
    """The product of another mesh's matrix with (n f,): that of this one, corrected in the cells that are others.

    Args:
        product: of this mesh's matrix.
        changed: (k,) int32 cells.
        differences: factor, integrals of the other mesh and of this one, whose tangents the matrices are sums of.
        constrained: (n, f) unknowns that are prescribed, where the product is 0.
    """
    fixed = constrained.astype(bool)

    def other(d: np.ndarray) -> np.ndarray:
        out = product(d).reshape(fixed.shape)
        for factor, there, here in differences:
            scaled = factor * d.reshape(fixed.shape)
            Assembled(there).residual(scaled, out, changed)
            Assembled(here).residual(-scaled, out, changed)
        out[fixed] = 0.0
        return out.ravel()

    return other
