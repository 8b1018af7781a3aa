"""Answers on another mesh with the same nodes, from the answer on this one and its kept preconditioner."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.correction import conjugate_steps
from restshape.analysis.effective_system import StepWeights
from restshape.analysis.time_error import element_product
from restshape.fem.assembled import Assembled
from restshape.fem.problem import STIFFNESS
from restshape.fem.residuals import stiffness_product, unconstrained_residual

if TYPE_CHECKING:
    from restshape.fem.problem import SteadyProblem
    from restshape.fem.residuals import Operation
    from restshape.fem.semidiscrete import SemiDiscrete
    from restshape.fem.time_integration import Scheme, TimeState

ENOUGH, LEAST = {3: 1e-8}, 1e-12
"""Shares of the squared energy of a difference of two meshes that successive steps together add at the end: on cells of
so many nodes, and on all others, where most of it is of a poor guess: nodes in the middle of flipped edges have moved.
"""


def solution_beside(problem: SteadyProblem, x: np.ndarray, precondition: Operation) -> np.ndarray:
    """The solution (n, f) of a symmetric linear problem; not numbers where too many steps do not suffice.

    Args:
        problem: on the other mesh.
        x: (n, f) the solution on this one.
        precondition: about the inverse of the other matrix.
    """
    problem.update()
    guess = np.where(problem.boundary.mask, problem.boundary.values, x)
    rest = -unconstrained_residual(problem, guess).ravel()
    rest[problem.boundary.constrained] = 0.0
    enough = ENOUGH.get(problem.space.cells.shape[1], LEAST)
    found = conjugate_steps(stiffness_product(problem, guess), precondition, rest, enough=enough)
    return guess + found.reshape(x.shape)


def step_beside(
    body: SemiDiscrete,
    scheme: Scheme,
    state: TimeState,
    y: np.ndarray,
    base_acceleration: np.ndarray,
    precondition: Operation,
) -> np.ndarray:
    """The unknowns (n, f) after a time step of a linear motion; not numbers where too many steps do not suffice.

    Args:
        body: on the other mesh.
        scheme: of the step, with a5 = 0.
        state: that it leads from, at rest where prescribed.
        y: (n, f) after the same step on this mesh.
        base_acceleration: (f,) as in `EffectiveSystem.assemble`.
        precondition: about the inverse of the other step's matrix.
    """
    weights = StepWeights(scheme, body.damping_of.alpha, body.damping_of.beta)
    stiff, inert = np.empty_like(y), np.empty_like(y)
    weights.apply(state, stiff, inert)
    stiff -= weights.of_stiffness * y
    inert -= weights.of_mass * y + base_acceleration
    rest = weights.load * body.static + body.mass.apply(inert)
    Assembled(body.problem.integrals(STIFFNESS)).residual(stiff, rest)
    rest[body.constrained] = 0.0
    enough = ENOUGH.get(body.problem.space.cells.shape[1], LEAST)
    found = conjugate_steps(element_product(body, scheme, y), precondition, rest.ravel(), enough=enough)
    return y + found.reshape(y.shape)
