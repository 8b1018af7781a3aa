"""The thesis's own eigensolver: inverse iteration with projection, one mode after the other, started from the last."""

import numpy as np

from restshape.algebra.eigenproblems.davidson import Found
from restshape.algebra.eigenproblems.pencil import Deflation, Pencil
from restshape.arrays import Reals
from restshape.errors import ReplayProblem

MOST = 2000
"""Inverse iterations of one mode; it converges like the ratio of neighbouring eigenvalues."""

EPSILON = 1e-3
"""Diagonal added to A, as a share of the eigenvalue that is looked for: the thesis's small number."""


def inverse_iteration(pencil: Pencil, deflation: Deflation, starts: Reals, count: int, tolerance: float) -> Found:
    """The lowest eigenpairs, ascending, by inverse iteration on K + eps M, a new factor each time it is called.

    In the thesis A = L^-1 K L^-T with the Cholesky factor L of the lumped mass; psi = L^T phi makes its iteration the
    one here: phi <- (K + eps M)^-1 M phi, made orthogonal to rigid motions and to the modes before, in the mass.

    Args:
        pencil: K, and the lumped M, as they stand; factored by the caller at a shift of -eps.
        deflation: the rigid motions.
        starts: (count, n) modes of the last frame, or anything; this rank's columns.
        count: wanted.
        tolerance: of the residual |K phi - lambda M phi| relative to |lambda M phi|.

    Raises:
        ReplayProblem: a mode does not converge.

    Source: the thesis's appendix A; its epsilon is taken off again by the Rayleigh quotient.
    """
    n, share = pencil.share.count, pencil.share

    def product(a: Reals, b: Reals) -> float:
        return float(share.summed(np.vdot(a, b)))

    modes, mass_products = np.empty((count, n)), np.empty((count, n))
    values, residuals, total = np.empty(count), np.empty(count), 0
    for k in range(count):
        phi, weight, force = starts[k : k + 1].copy(), np.empty((1, n)), np.empty((1, n))
        for step in range(MOST + 1):
            deflation.clean(phi)
            phi -= share.summed(phi @ mass_products[:k].T) @ modes[:k]
            pencil.apply(pencil.mass, phi, weight)
            size = np.sqrt(product(phi, weight))
            phi, weight = phi / size, weight / size
            pencil.apply(pencil.stiffness, phi, force)
            values[k] = product(phi, force)
            rest = force - values[k] * weight
            residuals[k] = np.sqrt(product(rest, rest)) / (abs(values[k]) * np.sqrt(product(weight, weight)))
            if residuals[k] <= tolerance:
                break
            if step == MOST or not np.isfinite(residuals[k]):
                raise ReplayProblem(
                    f"inverse iteration for mode {k + 1} did not converge in {step} steps, as where frequencies lie "
                    "close together (take another policy, such as auto, or fewer modes)"
                )
            phi = pencil.solve(weight)
            total += 1
        modes[k], mass_products[k] = phi[0], weight[0]
    order = np.argsort(values, kind="stable")
    return Found(values[order], modes[order], residuals[order], total, True)
