"""How critical load factors follow the shape."""

import numpy as np

from restshape.analysis.buckling import BucklingAnalysis
from restshape.sensitivity.modal import parted
from restshape.sensitivity.static import design_derivative


def load_factor_rates(analysis: BucklingAnalysis, dX: np.ndarray, s: np.ndarray) -> np.ndarray:
    """The rate (k, k) of the matrix diag(mu) when nodes move with dX (n, 2) and the displacement changes with s (n, 2).

    mu_i mu_j phi_i . (G' - (lambda_i + lambda_j)/2 K') phi_j with lambda = -1/mu and phi K phi = 1. On its diagonal are
    the rates of load factors that stand alone, the eigenvalues of its blocks are those of load factors that coincide. G
    is linear in the displacement, so that s adds the geometric stiffness of s.

    Args:
        analysis: solved on the mesh as it lies.
        dX: rates of the nodes' places; s: those of the displacement, held unknowns included.

    Source: docs/theory.md, section 8.
    """
    physics, part, factors = analysis.physics, analysis.geometric, analysis.load_factors
    mesh, at_rest, moved = physics.mesh, part.params(analysis.x), part.params(s)
    stiff, loaded = np.zeros((2, *analysis.modes.shape))
    for mode, stiff_row, loaded_row in zip(analysis.modes, stiff, loaded):
        phi = np.ascontiguousarray(mode.reshape(-1, 2))
        out = np.zeros_like(phi)
        physics.element.design(mesh.X, dX, phi, mesh.cells, physics.stiffness_params, out)
        stiff_row[:] = out.ravel()
        loaded_row[:] = (part.design_product(at_rest, phi, dX) + part.product(moved, phi)).ravel()
    # Modes are 0 where the body is held, so that forces there do not count.
    loaded *= analysis.sign
    values = -1.0 / factors
    middle = 0.5 * (values[:, None] + values[None, :])
    rates = analysis.modes @ loaded.T - middle * (analysis.modes @ stiff.T)
    return factors[:, None] * factors[None, :] * 0.5 * (rates + rates.T)


def load_factor_derivatives(analysis: BucklingAnalysis, dX: np.ndarray, tolerance: float) -> np.ndarray:
    """Derivatives (k,) of the load factors where nodes move with dX (n, 2), those of coinciding ones ascending.

    Args:
        analysis: solved on the mesh as it lies.
        tolerance: of the solve for the rate of the displacement.

    Raises:
        ReplayProblem: that solve does not converge.
    """
    s = design_derivative(analysis, np.stack([dX, np.zeros_like(dX)]), tolerance)[0]
    return parted(analysis.load_factors, load_factor_rates(analysis, dX, s), analysis.critical.reach)


def buckling_derivative(analysis: BucklingAnalysis, Psi: np.ndarray, tolerance: float) -> np.ndarray:
    """Derivatives (2, 2 n + k k) of `BucklingAnalysis.state` along the two directions of the hand.

    All known load factors are one cluster to the subspace rule, so that a prediction knows of crossings among them.

    Args:
        analysis: solved on the mesh as it lies.
        Psi: (2, n, 2) node displacements a unit of each of the hand's coefficients.
        tolerance: of each solve, relative to its right side.

    Raises:
        ReplayProblem: a solve does not converge.
    """
    s = design_derivative(analysis, Psi, tolerance)
    rates = [load_factor_rates(analysis, np.ascontiguousarray(dX), rate) for dX, rate in zip(Psi, s)]
    return np.concatenate([s.reshape(2, -1), np.stack(rates).reshape(2, -1)], axis=1)
