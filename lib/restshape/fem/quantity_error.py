"""How far quantities of interest are from those of a finer mesh: dual-weighted, with recovered fluxes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restshape.fem.derivative import Derivative
from restshape.fem.error_estimate import RecoveryEstimate, Sampled
from restshape.fem.problem import STIFFNESS, Problem
from restshape.fem.residuals import tangent_product, unconstrained_residual
from restshape.mesh.lagrange_space import LagrangeSpace

DualSolve = Callable[[np.ndarray], np.ndarray]
"""z (n, f) with K z = right side (n, f) at free unknowns, 0 at prescribed ones."""


@dataclass(frozen=True, eq=False)
class CurvedProblem:
    """The same problem on second-order nodes over a first-order mesh: with curved sides, and loads sampled better.

    Args:
        problem: on those nodes.
        residual: (n, f) of unknowns that were interpolated to them.
        unknowns: (n, f) these.
    """

    problem: Problem
    residual: np.ndarray
    unknowns: np.ndarray

    @classmethod
    def of(cls, problem: Problem, x: np.ndarray) -> "CurvedProblem":
        """With a problem on a `LagrangeSpace` over the mesh that unknowns x (n, f) live on."""
        unknowns = lifted(problem, x)
        unknowns = np.where(problem.boundary.mask, problem.boundary.values, unknowns)
        return cls(problem, unconstrained_residual(problem, unknowns), unknowns)


def lifted(problem: Problem, field: np.ndarray) -> np.ndarray:
    """A first-order field (n, f) at the nodes (m, f) of a problem of second order over its mesh."""
    space = problem.space
    if not isinstance(space, LagrangeSpace):
        raise TypeError("the problem is not of second order")
    out = np.empty((len(space.X), field.shape[1]))
    out[space.corner_number] = field
    out[space.side_number] = field[space.mesh.edge_nodes].mean(axis=1)
    return out


def quantity_error(
    problem: Problem,
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
    own energy is taken off, as z follows from u_h for u. What a first-order mesh does to sides and loads is the
    residual at second order, weighted by z_h.

    Args:
        problem: that the unknowns solve.
        estimate: on its space.
        primal: fluxes of the unknowns by `estimate.sampled`.
        x: (n, f) unknowns.
        derivative: of the quantity.
        solve: gives the dual.
        curved: of the unknowns; None where the space is of second order.

    Source: docs/theory/error-estimates.md; Becker and Rannacher, Acta Numerica 10 (2001) 1; Oden and Prudhomme, Comput.
    Math. Appl. 41 (2001) 735.
    """
    dual = dual_solution(problem, derivative, solve)
    error = estimate.error_product(primal, estimate.sampled(dual)) if np.any(dual) else 0.0
    if derivative.energy is not None:
        error -= 0.5 * estimate.error_energy(primal, derivative.energy)
    if curved is not None:
        error += _consistency(problem, x, derivative, dual, curved)
    return abs(error) + abs(derivative.own)


def dual_solution(problem: Problem, derivative: Derivative, solve: DualSolve) -> np.ndarray:
    """The dual (n, f) of a quantity; of reactions it is less their weights at prescribed unknowns."""
    lift = derivative.lift
    if lift is None:
        right = derivative.load.copy()
    else:
        right = derivative.load + tangent_product(problem, np.zeros_like(lift), lift)
    problem.boundary.zero(right)
    found = solve(right) if np.any(right) else np.zeros_like(right)
    return found if lift is None else found - lift


def _consistency(
    problem: Problem, x: np.ndarray, derivative: Derivative, dual: np.ndarray, curved: CurvedProblem
) -> float:
    """What straight sides and sampled loads do to a quantity; of energies and positions also to their evaluation."""
    error = -float((curved.residual * lifted(curved.problem, dual)).sum())
    if derivative.lift is not None:
        error -= float((unconstrained_residual(problem, x) * derivative.lift).sum())
    if derivative.energy is not None:
        both = ((curved.problem, curved.unknowns), (problem, x))
        energies = [one.integrals(STIFFNESS)[0].energies(at)[derivative.energy].sum() for one, at in both]
        error += float(energies[0] - energies[1])
    if derivative.value_on is not None:
        at = curved.problem.space, lifted(curved.problem, x)
        error += float(derivative.value_on(*at) - derivative.value_on(problem.space, x))
    return error
