"""How critical load factors follow the shape."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape.algebra.eigenproblems.buckling_solver import BucklingSolver
from restshape.fem.assembled import Assembled
from restshape.fem.problem import STIFFNESS
from restshape.sensitivity.mode_change import change_beyond
from restshape.sensitivity.steady_derivative import SolvedSteady, design_derivative

if TYPE_CHECKING:
    from restshape.analysis.buckling.buckling_state import BucklingState


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
    modes, factors = state.modes.vectors, state.modes.load_factors
    stiff, loaded = design_products(state, dX, s)
    values = -1.0 / factors
    middle = 0.5 * (values[:, None] + values[None, :])
    rates = modes @ loaded.T - middle * (modes @ stiff.T)
    return factors[:, None] * factors[None, :] * 0.5 * (rates + rates.T)


def design_products(state: BucklingState, dX: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """K' phi and G' phi (k, 2 n) of the modes; arguments as in `load_factor_rates`. Forces at supports are in them."""
    problem, modes = state.prebuckling.problem, state.modes.vectors
    stiffness = Assembled(problem.integrals(STIFFNESS))
    at_solution, moved = (Assembled([problem.geometric_stiffness(u)]) for u in (state.prebuckling.x, s))
    stiff, loaded = np.zeros((2, *modes.shape))
    for mode, stiff_row, loaded_row in zip(modes, stiff, loaded):
        phi = np.ascontiguousarray(mode.reshape(state.prebuckling.x.shape))
        stiff_row[:] = stiffness.design_product(phi, dX).ravel()
        loaded_row[:] = (at_solution.design_product(phi, dX) + moved.residual(phi)).ravel()
    # Modes are 0 where the body is constrained, so that forces there do not count.
    loaded *= state.sign
    return stiff, loaded


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


def mixed_derivative(analysis: SolvedBuckling, Psi: np.ndarray, tolerance: float) -> np.ndarray:
    """Derivatives (2, 2 n + k k + k 2 n) of `MixedBuckling.values` along the two directions of the hand.

    Those of `buckling_derivative`, and those of modes, whose turning among each other is left to the eigenvectors of
    the matrix, as in `frequency_derivative.modal_derivative`. A mode changes by -1/2 Phi^T K' Phi, which keeps them
    orthonormal in K, and by what is beyond: (G - lambda K) v = -(G' - lambda K') phi there.

    Args:
        analysis: solved on the mesh as it lies.
        Psi: (2, n, 2) node displacements a unit of each of the hand's coefficients.
        tolerance: of each solve, relative to its right side.

    Raises:
        ReplayProblem: a solve does not converge.
    """
    state, modes = analysis.state, analysis.state.modes
    known = buckling_derivative(analysis, Psi, tolerance)
    s = known[:, : state.prebuckling.x.size].reshape(len(Psi), *state.prebuckling.x.shape)
    changes = np.zeros((len(Psi), *modes.vectors.shape))
    free = state.prebuckling.problem.boundary.mask.ravel() == 0
    for dX, rate, change in zip(Psi, s, changes):
        if not len(change) or not np.any(dX):
            continue
        stiff, loaded = (np.where(free, one, 0.0) for one in design_products(state, np.ascontiguousarray(dX), rate))
        change[:] = -0.5 * (modes.vectors @ stiff.T) @ modes.vectors
        for k, (row, value) in enumerate(zip(change, -1.0 / modes.load_factors)):
            right = value * stiff[k] - loaded[k]
            row += change_beyond(analysis.solver, modes.vectors, modes.mass_products, float(value), right, tolerance)
    return np.concatenate([known, changes.reshape(2, -1)], axis=1)
