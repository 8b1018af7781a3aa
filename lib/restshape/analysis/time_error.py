"""The error that one step of Newmark's method makes."""

import numpy as np

from restshape.analysis.correction import Operation, conjugate_steps, tangent_product
from restshape.analysis.effective import State
from restshape.physics.elasticity.dynamics import Newmark
from restshape.physics.elasticity.moving_solid import VibratingSolid


def local_error(
    body: VibratingSolid,
    newmark: Newmark,
    states: tuple[State, State],
    shaken: tuple[np.ndarray, np.ndarray],
    precondition: Operation,
) -> np.ndarray:
    """The displacement (n, 2) [m] by which a step is wrong that began in the right state.

    (beta - 1/6) dt^2 (a' - a), the acceleration smoothed by (M + beta dt^2 K)^-1 M: what the step is too long for
    swings on for ever in Newmark's method, and the formula knows nothing of it.

    Args:
        body: at the shape of the step.
        newmark: the step.
        states: that it leads from and to.
        shaken: the ground's accelerations (2,) [m/s^2] at both.
        precondition: the kept preconditioner of the step's matrix K + a0 M + a1 C.

    Source: docs/theory.md, section 9; Zienkiewicz and Xie, Earthquake Engng Struct. Dyn. 20 (1991) 871; Shampine and
    Baca, J. Comput. Appl. Math. 11 (1984) 197.
    """
    before, now = states
    if before.a is not None and now.a is not None:
        change = body.inertia.apply(now.a - before.a)
    else:
        change = body.force(now.y) - body.force(before.y) - body.damping(now.v - before.v)
        ground = shaken[1] - shaken[0]
        if ground.any():
            change -= body.inertia.apply(np.zeros_like(change) + ground)
    change[body.held] = 0.0
    stiff = tangent_product(body.solid, now.y + body.solid.prescribed)
    of_stiffness = 1.0 + newmark.a1 * body.rayleigh.beta
    of_mass = newmark.a0 + newmark.a1 * body.rayleigh.alpha

    def product(d: np.ndarray) -> np.ndarray:
        heavy = body.inertia.apply(np.ascontiguousarray(d.reshape(change.shape)))
        heavy[body.held] = 0.0
        return of_stiffness * stiff(d) + of_mass * heavy.ravel()

    smoothed = conjugate_steps(product, precondition, newmark.a0 * change.ravel())
    return (newmark.beta - 1.0 / 6.0) * newmark.dt**2 * smoothed.reshape(change.shape)
