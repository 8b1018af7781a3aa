"""How critical load factors follow the shape."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.algebra.buckling_solver import BucklingSolver
from restshape.fem.assembled import Assembled
from restshape.fem.problem import STIFFNESS
from restshape.sensitivity.steady_derivative import SolvedSteady, design_derivative

if TYPE_CHECKING:
    from restshape.analysis.buckling_state import BucklingState


class SolvedBuckling(Protocol):
    """What a derivative needs of an analysis of buckling that has been solved on the mesh as it lies."""

    state: BucklingState
    solver: BucklingSolver

    @property
    def prebuckling(self) -> SolvedSteady: ...


def load_factor_rates(state: BucklingState, dX: np.ndarray, s: np.ndarray) -> np.ndarray:
    """The rate (k, k) of the matrix diag(mu) when nodes move with dX (n, 2) and the displacement changes with s (n, 2).

    mu_i mu_j phi_i . (G' - (lambda_i + lambda_j)/2 K') phi_j with lambda = -1/mu and phi K phi = 1. On its diagonal are
    the rates of load factors that stand alone, the eigenvalues of its blocks are those of load factors that coincide. G
    is linear in the displacement, so that s adds the geometric stiffness of s.

    Args:
        state: solved on the mesh as it lies.
        dX: rates of the nodes' places; s: those of the displacement, prescribed unknowns included.

    Source: docs/theory/buckling.md.
    """
    problem, modes, factors = state.prebuckling.problem, state.modes.vectors, state.modes.load_factors
    stiffness = Assembled(problem.integrals(STIFFNESS))
    at_solution, moved = (Assembled([problem.geometric_stiffness(u)]) for u in (state.prebuckling.x, s))
    stiff, loaded = np.zeros((2, *modes.shape))
    for mode, stiff_row, loaded_row in zip(modes, stiff, loaded):
        phi = np.ascontiguousarray(mode.reshape(state.prebuckling.x.shape))
        stiff_row[:] = stiffness.design_product(phi, dX).ravel()
        loaded_row[:] = (at_solution.design_product(phi, dX) + moved.residual(phi)).ravel()
    # Modes are 0 where the body is constrained, so that forces there do not count.
    loaded *= state.sign
    values = -1.0 / factors
    middle = 0.5 * (values[:, None] + values[None, :])
    rates = modes @ loaded.T - middle * (modes @ stiff.T)
    return factors[:, None] * factors[None, :] * 0.5 * (rates + rates.T)


def buckling_derivative(analysis: SolvedBuckling, Psi: np.ndarray, tolerance: float) -> np.ndarray:
    """Derivatives (2, 2 n + k k) of `BucklingPrediction.values` along the two directions of the hand.

    All known load factors are one cluster to the subspace rule, so that a prediction knows of crossings among them.

    Args:
        analysis: solved on the mesh as it lies.
        Psi: (2, n, 2) node displacements a unit of each of the hand's coefficients.
        tolerance: of each solve, relative to its right side.

    Raises:
        ReplayProblem: a solve does not converge.
    """
    s = design_derivative(analysis.prebuckling, Psi, tolerance)
    rates = [load_factor_rates(analysis.state, np.ascontiguousarray(dX), rate) for dX, rate in zip(Psi, s)]
    return np.concatenate([s.reshape(2, -1), np.stack(rates).reshape(2, -1)], axis=1)
