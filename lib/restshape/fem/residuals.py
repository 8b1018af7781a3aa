"""What a problem's integrals say together: loads, residuals, their rates, and how large all that is."""

from collections.abc import Callable, Sequence

import numpy as np

from restshape.fem.assembled import Assembled
from restshape.fem.problem import FOLLOWERS, INTERNAL, LOADS, STIFFNESS, SteadyProblem

Operation = Callable[[np.ndarray], np.ndarray]


def dead_loads(problem: SteadyProblem, out: np.ndarray) -> None:
    """Set `out` (n, f) to the loads on points and facets that do not follow; 0 at prescribed unknowns."""
    out[:] = 0.0
    Assembled(problem.integrals(LOADS)).residual(problem.boundary.values, out)
    np.negative(out, out=out)
    problem.add_nodal_loads(out, 1.0)
    problem.boundary.zero(out)


ALL_FORCES = (INTERNAL, LOADS, FOLLOWERS)
"""Kinds of integrals of which residuals consist."""


def unconstrained_residual(
    problem: SteadyProblem,
    x: np.ndarray,
    cells: np.ndarray | None = None,
    out: np.ndarray | None = None,
    kinds: Sequence[str] = ALL_FORCES,
) -> np.ndarray:
    """Internal less all applied forces or fluxes (n, f) at x (n, f), reactions not taken out.

    Args:
        cells: (k,) int32 that alone count; None: all.
        out: (n, f) that they are added to.
        kinds: of integrals; others have nothing where the residual is looked at.
    """
    out = Assembled(integral for kind in kinds for integral in problem.integrals(kind)).residual(x, out, cells)
    problem.add_nodal_loads(out, -1.0, cells)
    return out


def residual_norm(problem: SteadyProblem, x: np.ndarray) -> float:
    """The norm of the residual at free unknowns at x (n, f)."""
    rest = unconstrained_residual(problem, x)
    problem.boundary.zero(rest)
    return float(np.linalg.norm(rest))


def internal_norm(problem: SteadyProblem, x: np.ndarray) -> float:
    """Half the norm of the internal forces or fluxes at all nodes, prescribed ones too, at x (n, f).

    Half, for loads and the reactions that balance them are both in it.
    """
    return 0.5 * float(np.linalg.norm(Assembled(problem.integrals(STIFFNESS)).residual(x)))


def energy(problem: SteadyProblem, x: np.ndarray) -> float:
    """The energy of the unknowns x (n, f) without that of loads; of linear problems half of x . K x."""
    return Assembled(problem.integrals(STIFFNESS)).energy(x)


def stiffness_product(problem: SteadyProblem, x: np.ndarray) -> Operation:
    """The function from rates (n f,) of unknowns to those of internal forces at x (n, f), 0 where prescribed."""
    assembled = Assembled(problem.integrals(STIFFNESS))

    def product(d: np.ndarray) -> np.ndarray:
        d = np.ascontiguousarray(d.reshape(x.shape))
        out = assembled.residual(d) if problem.linear else assembled.tangent_product(x, d)
        problem.boundary.zero(out)
        return out.ravel()

    return product


def tangent_product(problem: SteadyProblem, x: np.ndarray, d: np.ndarray) -> np.ndarray:
    """The rates (n, f) of the residual when the unknowns x (n, f) change with d (n, f), prescribed ones too."""
    integrals = [*problem.integrals(INTERNAL), *problem.integrals(FOLLOWERS)]
    return Assembled(integrals).tangent_product(x, d)


def design_rates(problem: SteadyProblem, x: np.ndarray, dX: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The rates (n, f) of the residual, and those (n, f) of the prescribed unknowns, when nodes move.

    The unknowns are constant where free and follow their supports where prescribed. Elements carry dual numbers; loads
    enter them linearly, so that the rate of one whose value varies with the place is its element's residual.

    Args:
        problem: on the space as it lies.
        x: (n, f) unknowns.
        dX: (n, d) rates of the nodes' places.

    Raises:
        ReplayProblem: a value of the scene has no derivative somewhere.

    Source: docs/theory/design-derivative.md: f_i of the thesis's (5.11).
    """
    space = problem.space
    prescribed = problem.boundary.rate(space.dof_X, space.at_dofs(dX))
    if sliding := problem.boundary.sliding:
        prescribed += sliding.across(x, dX)
    moved = prescribed if np.any(prescribed) else None
    out = np.zeros_like(x)
    for kind in (INTERNAL, LOADS, FOLLOWERS):
        for integral in problem.integrals(kind):
            integral.add_design_product(x, dX, out, None if kind == LOADS else moved)
    problem.add_nodal_load_rates(dX, out)
    if sliding:
        out += sliding.turned(unconstrained_residual(problem, x), dX)
    return out, prescribed
