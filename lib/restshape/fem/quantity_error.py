"""How far quantities of interest are from those of a finer mesh: dual-weighted, with recovered fluxes."""

from collections.abc import Callable

import numpy as np

from restshape.fem.derivative import Derivative
from restshape.fem.error_estimate import RecoveryEstimate, Sampled
from restshape.fem.problem import Problem
from restshape.fem.residuals import tangent_product

DualSolve = Callable[[np.ndarray], np.ndarray]
"""z (n, f) with K z = right side (n, f) at free unknowns, 0 at prescribed ones."""


def quantity_error(
    problem: Problem, estimate: RecoveryEstimate, primal: Sampled, derivative: Derivative, solve: DualSolve
) -> float:
    """The estimated size of the error of a quantity J at the unknowns of a linear, symmetric problem.

    With the dual z, a(v, z) = J'(v), the error is a(u - u_h, z - z_h) by Galerkin's orthogonality: the residual
    weighted by the dual. Both errors are those of the fluxes against recovered ones. Of an energy half of the error's
    own energy is taken off, as z follows from u_h for u.

    Args:
        problem: that the unknowns solve.
        estimate: on its space.
        primal: fluxes of the unknowns by `estimate.sampled`.
        derivative: of the quantity.
        solve: gives the dual.

    Source: docs/theory.md, section 9; Becker and Rannacher, Acta Numerica 10 (2001) 1; Oden and Prudhomme, Comput.
    Math. Appl. 41 (2001) 735.
    """
    dual = dual_solution(problem, derivative, solve)
    error = estimate.error_product(primal, estimate.sampled(dual)) if np.any(dual) else 0.0
    if derivative.energy is not None:
        error -= 0.5 * estimate.error_energy(primal, derivative.energy)
    return abs(error) + abs(derivative.own)


def dual_solution(problem: Problem, derivative: Derivative, solve: DualSolve) -> np.ndarray:
    """The dual (n, f) of a quantity; the weights of reactions are its values at prescribed unknowns."""
    lift = derivative.lift
    if lift is None:
        right = derivative.load.copy()
    else:
        right = derivative.load - tangent_product(problem, np.zeros_like(lift), lift)
    problem.boundary.zero(right)
    found = solve(right) if np.any(right) else np.zeros_like(right)
    return found if lift is None else found + lift
