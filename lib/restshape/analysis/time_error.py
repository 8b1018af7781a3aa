"""The error that one implicit step makes."""

import numpy as np

from restshape.analysis.correction import conjugate_steps
from restshape.fem.residuals import Operation, stiffness_product
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.time_integration import Scheme, TimeState


def local_error(
    body: SemiDiscrete,
    scheme: Scheme,
    states: tuple[TimeState, TimeState],
    accelerations: tuple[np.ndarray, np.ndarray],
    precondition: Operation,
) -> np.ndarray:
    """The unknowns (n, f) by which a step is wrong that began in the right state.

    In second order (beta - 1/6) dt^2 (a' - a), the acceleration smoothed by (M + beta dt^2 K)^-1 M: what the step is
    too long for swings on for ever in Newmark's method, and the formula knows nothing of it. In first order
    (theta - 1/2) dt (v' - v), likewise, and for theta = 1/2 dt^2/12 times the same of the second rates, -M^-1 K v.

    Args:
        body: at the shape of the step.
        scheme: of the step.
        states: that it leads from and to.
        accelerations: the base's accelerations (f,) at both.
        precondition: the kept preconditioner of the step's matrix K + a0 M + a1 C.

    Source: docs/theory/error-estimates.md; Zienkiewicz and Xie, Earthquake Engng Struct. Dyn. 20 (1991) 871; Shampine
    and Baca, J. Comput. Appl. Math. 11 (1984) 197.
    """
    before, now = states
    if before.a is not None and now.a is not None:
        change = body.mass.apply(now.a - before.a)
    else:
        change = body.force(now.y) - body.force(before.y) - body.damping(now.v - before.v)
        ground = accelerations[1] - accelerations[0]
        if ground.any():
            change -= body.mass.apply(np.zeros_like(change) + ground)
    change[body.constrained] = 0.0
    stiff = stiffness_product(body.problem, body.unknowns(now.y))
    of_stiffness = 1.0 + scheme.a1 * body.damping_of.beta
    of_mass = scheme.a0 + scheme.a1 * body.damping_of.alpha

    def product(d: np.ndarray) -> np.ndarray:
        mass_products = body.mass.apply(np.ascontiguousarray(d.reshape(change.shape)))
        mass_products[body.constrained] = 0.0
        return of_stiffness * stiff(d) + of_mass * mass_products.ravel()

    smoothed = conjugate_steps(product, precondition, scheme.a0 * change.ravel())
    if scheme.order == 1 and scheme.error_factor == 0.0:
        second = np.where(body.constrained.ravel(), 0.0, stiff(smoothed))
        smoothed = conjugate_steps(product, precondition, scheme.a0 * second)
        return scheme.dt**2 / 12.0 * smoothed.reshape(change.shape)
    return scheme.error_factor * scheme.dt**scheme.order * smoothed.reshape(change.shape)
