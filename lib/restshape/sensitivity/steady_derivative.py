"""The design derivative of a steady solution: how its unknowns follow the hand."""

from typing import Protocol

import numpy as np

from restshape.errors import ReplayProblem
from restshape.fem.problem import SteadyProblem
from restshape.fem.residuals import design_rates, tangent_product

SLACK = 100.0
"""A derivative whose true residual is so many times what was asked for has been lost to rounding."""


class SolvedSteady(Protocol):
    """What a derivative needs of an analysis that has just been solved."""

    @property
    def problem(self) -> SteadyProblem:
        """On its space."""

    @property
    def x(self) -> np.ndarray:
        """(n, f) unknowns."""

    def linear_solve(self, rhs: np.ndarray, tolerance: float) -> np.ndarray:
        """s (n, f) with (dR/dx) s = rhs (n, f) at free unknowns, 0 at prescribed ones, by the kept preconditioner."""


def design_derivative(analysis: SolvedSteady, Psi: np.ndarray, tolerance: float) -> np.ndarray:
    """Derivatives s (2, n, f) of the unknowns along the two directions of the hand.

    (dR/dx) s_i = -(dR/dX) Psi_i, with the tangent of the answer and whatever factor there is.

    Args:
        analysis: solved on the mesh as it lies.
        Psi: (2, n, d) node displacements a unit of each of the hand's coefficients.
        tolerance: of each solve, relative to its right side.

    Raises:
        ReplayProblem: the tangent is singular, or so nearly that rounding decides, or a value has no derivative.

    Source: docs/theory/design-derivative.md; (5.10) to (5.15) of the thesis.
    """
    s = np.zeros((len(Psi), *analysis.x.shape))
    for direction, motion in zip(s, Psi):
        if np.any(motion):
            rates, prescribed = design_rates(analysis.problem, analysis.x, motion)
            direction[...] = _response(analysis, rates, tolerance) + prescribed
    return s


def _response(analysis: SolvedSteady, rates: np.ndarray, tolerance: float) -> np.ndarray:
    """The rates (n, f) of free unknowns that make up for rates of the residual (n, f)."""
    problem = analysis.problem
    rhs = -rates
    problem.boundary.zero(rhs)
    s = analysis.linear_solve(rhs, tolerance)
    left = tangent_product(problem, analysis.x, s) - rhs
    problem.boundary.zero(left)
    error, scale = float(np.linalg.norm(left)), float(np.linalg.norm(rhs))
    if not error <= SLACK * tolerance * scale:
        raise ReplayProblem(
            "the tangent is nearly singular: no derivative with respect to the design "
            f"(its residual is {error / scale:.1e} of the right side)"
        )
    return s
