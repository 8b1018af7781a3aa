"""How far quantities of interest are from those of a finer mesh: dual-weighted, with recovered fluxes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restshape.fem.derivative import Derivative
from restshape.fem.enrichment import Enrichment
from restshape.fem.error_estimate import RecoveryEstimate, Sampled
from restshape.fem.problem import STIFFNESS, SteadyProblem
from restshape.fem.residuals import tangent_product, unconstrained_residual

DualSolve = Callable[[np.ndarray], np.ndarray]
"""z (n, f) with K z = right side (n, f) at free unknowns, 0 at prescribed ones."""


@dataclass(frozen=True, eq=False)
class CurvedProblem:
    """A problem on the next richer space: with curved sides met closer, and loads sampled better.

    Args:
        enrichment: of the problem.
        residual: (m, f) of unknowns that were brought to its nodes, of what is nested of both problems.
        unknowns: (m, f) these.
        own_residual: (n, f) of the problem itself, likewise: what the solver has left, and the reactions.
    """

    enrichment: Enrichment
    residual: np.ndarray
    unknowns: np.ndarray
    own_residual: np.ndarray

    @classmethod
    def of(cls, enrichment: Enrichment, problem: SteadyProblem, x: np.ndarray) -> "CurvedProblem":
        """With an enrichment of the space of the problem that unknowns x (n, f) solve."""
        unknowns = enrichment.unknowns(x)
        residual = unconstrained_residual(enrichment.problem.nested, unknowns)
        return cls(enrichment, residual, unknowns, unconstrained_residual(problem.nested, x))


def quantity_error(
    problem: SteadyProblem,
    estimate: RecoveryEstimate,
    primal: Sampled,
    x: np.ndarray,
    derivative: Derivative,
    solve: DualSolve,
    curved: CurvedProblem | None = None,
) -> float:
    """The estimated size of the error of a quantity J at the unknowns of a linear, symmetric problem.

    With the dual z, a(v, z) = J'(v), the error is a(u - u_h, z - z_h) by Galerkin's orthogonality: the residual
    weighted by the dual. Both errors are those of the fluxes against recovered ones. Of an energy half of the error's
    own energy is taken off, as z follows from u_h for u. What a mesh does to sides and loads is the
    residual on the next richer space, weighted by z_h.

    Args:
        problem: that the unknowns solve.
        estimate: on its space.
        primal: fluxes of the unknowns by `estimate.sampled`.
        x: (n, f) unknowns.
        derivative: of the quantity.
        solve: gives the dual.
        curved: of the unknowns; None where nothing varies on a space of second order.

    Source: docs/theory/error-estimates.md; Becker and Rannacher, Acta Numerica 10 (2001) 1; Oden and Prudhomme, Comput.
    Math. Appl. 41 (2001) 735.
    """
    dual = dual_solution(problem, derivative, solve)
    error = estimate.error_product(primal, estimate.sampled(dual)) if np.any(dual) else 0.0
    if derivative.energy is not None:
        error -= 0.5 * estimate.error_energy(primal, derivative.energy)
    if curved is not None:
        error += _consistency(problem, x, derivative, dual, curved)
    return abs(error)


def dual_solution(problem: SteadyProblem, derivative: Derivative, solve: DualSolve) -> np.ndarray:
    """The dual (n, f) of a quantity; of reactions it is less their weights at prescribed unknowns."""
    lift = derivative.lift
    if lift is None:
        right = derivative.load.copy()
    else:
        right = derivative.load + tangent_product(problem, np.zeros_like(lift), lift)
    problem.boundary.zero(right)
    found = solve(right) if np.any(right) else np.zeros_like(right)
    # Steps that have not converged leave something there, where the reactions are.
    problem.boundary.zero(found)
    return found if lift is None else found - lift


def _consistency(
    problem: SteadyProblem, x: np.ndarray, derivative: Derivative, dual: np.ndarray, curved: CurvedProblem
) -> float:
    """What straight sides and sampled loads do to a quantity; of an energy also what they do to its integral.

    What the solver has left of the residual is taken off: it is no error of the mesh.
    """
    residual, own = curved.residual, curved.own_residual
    error = float((own * dual).sum()) - float((residual * curved.enrichment.over.prolonged(dual)).sum())
    if derivative.energy is not None:
        richer, cells_of = curved.enrichment, derivative.energy
        there = richer.problem.nested, curved.unknowns, richer.over.cells_in(cells_of)
        both = (there, (problem.nested, x, cells_of))
        energies = [one.integrals(STIFFNESS)[0].energies(at)[cells].sum() for one, at, cells in both]
        error += float(energies[0] - energies[1])
    return error
