"""Answers on another mesh with the same nodes, from the answer on this one and its kept preconditioner."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.correction import DELAY, conjugate_steps
from restshape.analysis.effective_system import StepWeights
from restshape.fem.assembled import Assembled
from restshape.fem.problem import STIFFNESS
from restshape.fem.residuals import unconstrained_residual
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.transfer import Transfer

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

ENOUGH, LEAST = 1e-8, 1e-12
"""Shares of the squared energy of a difference of two meshes that successive steps together add at the end, with an old
complete factor, whose gains fall by ten a step, a single one. The second is that of second order, where most of it is
of a poor guess, as nodes in the middle of flipped edges have moved, and reactions must balance loads; of a time step
only where nothing says what lies there."""


def solution_beside(problem: SteadyProblem, known: SteadyProblem, x: np.ndarray, matrix: StepMatrix) -> np.ndarray:
    """The solution (n, f) of a symmetric linear problem; not numbers where too many steps do not suffice.

    Args:
        problem: on the other mesh.
        known: on this one; x: (n, f) its solution.
        matrix: of this mesh.
    """
    problem.update()
    guess, _ = _guess(known.space, problem.space, x)
    enough = ENOUGH if guess is x else LEAST
    guess = np.where(problem.boundary.mask, problem.boundary.values, guess)
    rest = -unconstrained_residual(problem, guess).ravel()
    rest[problem.boundary.constrained] = 0.0
    stiffness = (1.0, problem.integrals(STIFFNESS), known.integrals(STIFFNESS))
    changed = changed_cells(known.space, problem.space)
    other = product_beside(matrix.product, changed, (stiffness,), problem.boundary.mask)
    return guess + _steps(other, matrix, rest, enough).reshape(x.shape)


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
    y, enough = _guess(known.problem.space, body.problem.space, y)
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
    return y + _steps(other, matrix, rest.ravel(), enough).reshape(y.shape)


def _guess(one: Space, other: Space, x: np.ndarray) -> tuple[np.ndarray, float]:
    """Unknowns x (n, f) of a space at the nodes of another one, and the share of energy that ends steps from there."""
    moved = np.flatnonzero((one.X != other.X).any(axis=1))
    if not len(moved):
        return x, ENOUGH
    if one.cell_type != LagrangeSpace.cell_type:
        return x, LEAST
    guess = x.copy()
    guess[moved] = Transfer(one, other.X[moved])(x)
    return guess, ENOUGH


def _steps(product: Operation, matrix: StepMatrix, rest: np.ndarray, enough: float) -> np.ndarray:
    """About the solution (n f,) of product(d) = rest, with the preconditioner of a matrix near it."""
    delay = 1 if matrix.complete and enough == ENOUGH else DELAY
    return conjugate_steps(product, matrix.precondition, rest, delay=delay, enough=enough)


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
