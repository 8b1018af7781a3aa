"""The error that one implicit step makes."""

from dataclasses import dataclass

import numpy as np

from restshape import _kernels
from restshape.analysis.correction import DELAY, conjugate_steps
from restshape.analysis.effective_system import StepWeights
from restshape.fem.residuals import Operation, stiffness_product
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.time_integration import Scheme, TimeState

ENOUGH = 1e-2
"""Share of the squared energy that the last step with an old complete factor adds: a tenth of the error at most."""


@dataclass(frozen=True)
class StepMatrix:
    """The matrix K + a0 M + a1 C of a step, for arrays (n,) of all unknowns.

    Args:
        product: with the matrix.
        precondition: the kept preconditioner.
        exact: it is a complete factor of this very matrix, or as good as one.
        complete: it is a complete factor of one that was like it.
    """

    product: Operation
    precondition: Operation
    exact: bool
    complete: bool

    def solve(self, rest: np.ndarray) -> np.ndarray:
        """About the solution (n,) with a right side (n,)."""
        if self.exact:
            return self.precondition(rest)
        if self.complete:
            return conjugate_steps(self.product, self.precondition, rest, delay=0, enough=ENOUGH)
        return conjugate_steps(self.product, self.precondition, rest, delay=DELAY)


def local_error(
    body: SemiDiscrete,
    scheme: Scheme,
    states: tuple[TimeState, TimeState],
    accelerations: tuple[np.ndarray, np.ndarray],
    matrix: StepMatrix,
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
        matrix: of the step.

    Source: docs/theory/error-estimates.md; Zienkiewicz and Xie, Earthquake Engng Struct. Dyn. 20 (1991) 871; Shampine
    and Baca, J. Comput. Appl. Math. 11 (1984) 197.
    """
    before, now = states
    if before.a is not None and now.a is not None:
        change = body.mass.apply(now.a - before.a)
    elif body.problem.linear:
        change = _change_of_force(body, scheme, states, accelerations[1] - accelerations[0], matrix.product)
    else:
        change = body.change_of_force((before.y, before.v), (now.y, now.v), accelerations[1] - accelerations[0])
    change[body.constrained] = 0.0
    smoothed = matrix.solve(scheme.a0 * change.ravel())
    if scheme.order == 1 and scheme.error_factor == 0.0:
        stiff = stiffness_product(body.problem, body.unknowns(now.y))
        second = np.where(body.constrained.ravel(), 0.0, stiff(smoothed))
        smoothed = matrix.solve(scheme.a0 * second)
        return scheme.dt**2 / 12.0 * smoothed.reshape(change.shape)
    return scheme.error_factor * scheme.dt**scheme.order * smoothed.reshape(change.shape)


def _change_of_force(
    body: SemiDiscrete, scheme: Scheme, states: tuple[TimeState, TimeState], base: np.ndarray, product: Operation
) -> np.ndarray:
    """What `SemiDiscrete.change_of_force` gives at free unknowns, with the step's matrix in place of K's elements."""
    before, now = states
    weights = StepWeights(scheme, body.damping_of.alpha, body.damping_of.beta)
    strain, inert = np.empty(now.y.shape), np.empty(now.y.shape)
    share, damped = weights.of_mass / weights.of_stiffness, weights.beta
    of_changes = (1.0, damped, 0.0, share, share * damped - weights.alpha, 0.0)
    _kernels.weigh_state(now.y - before.y, now.v - before.v, None, of_changes, base, strain, inert)
    change = body.mass.apply(inert)
    change -= product(strain.ravel()).reshape(strain.shape) / weights.of_stiffness
    return change


def element_product(body: SemiDiscrete, scheme: Scheme, y: np.ndarray) -> Operation:
    """The product of K + a0 M + a1 C at y (n, f) with (n,), by loops over the elements; 0 where prescribed."""
    stiff = stiffness_product(body.problem, body.unknowns(y))
    of_stiffness = 1.0 + scheme.a1 * body.damping_of.beta
    of_mass = scheme.a0 + scheme.a1 * body.damping_of.alpha

    def product(d: np.ndarray) -> np.ndarray:
        mass_products = body.mass.apply(np.ascontiguousarray(d.reshape(y.shape)))
        mass_products[body.constrained] = 0.0
        return of_stiffness * stiff(d) + of_mass * mass_products.ravel()

    return product
