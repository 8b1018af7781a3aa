"""The derivative of a drape: how positions at an equilibrium follow what is changed about the cloth."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from restshape.errors import ReplayProblem
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.sensitivity.hand_rates import hand_rates
from restshape.physics.cloth.sensitivity.rest_tangent import RestTangent
from restshape.physics.cloth.sensitivity.scene_rates import scene_rates

SLACK = 100.0
"""A derivative whose residual is so many times what was asked for has been lost to rounding."""

Rates = tuple[np.ndarray, np.ndarray]
"""Rates (n, 3) of the residual at constant free unknowns, and of the prescribed unknowns."""


@dataclass(frozen=True, eq=False)
class DrapeDerivative:
    """Derivatives of the unknowns of a drape, each by one number.

    Args:
        s: (k, n, 3) of positions, and with Morley's triangles of slopes, a unit of each number.
        residuals: (k,) of each, by the elements, over its right side.
        iterations: of the linear solver, of all together.
        sticking, sliding: places that friction holds, and places along which it slips.
        note: what there is to say of how they were had; empty: nothing.
    """

    s: np.ndarray
    residuals: np.ndarray
    iterations: int
    sticking: int = 0
    sliding: int = 0
    note: str = ""


def hand_derivative(state: RelaxationState, motion: np.ndarray, tolerance: float) -> DrapeDerivative:
    """Derivatives of a drape along the directions of a hand on its pattern.

    K s_i = -f_i, with the true tangent K of membrane, bending, contact and friction, on the factor at hand.

    Args:
        state: an equilibrium.
        motion: (k, corners, 2) places of the mesh's nodes in the material [m] a unit of each of the hand's numbers.
        tolerance: of each solve, relative to its right side.

    Raises:
        ReplayProblem: the cloth is not at rest, or its tangent is singular.

    Source: docs/theory/design-derivative.md; (5.10) to (5.15) of the thesis.
    """
    return solved(state, [lambda tangent, dX=dX: hand_rates(state, tangent.contact, dX) for dX in motion], tolerance)


def number_derivatives(state: RelaxationState, keys: Sequence[str], tolerance: float) -> DrapeDerivative:
    """Derivatives of a drape by numbers of its scene, a SI unit of each; see `scene_rates`.

    Args:
        state: an equilibrium.
        keys: dotted, such as "bodies.ball.sphere.radius".
        tolerance: of each solve, relative to its right side.

    Raises:
        UserError: there is no such number.
        ReplayProblem: the cloth is not at rest, or its tangent is singular.

    Source: docs/theory/design-derivative.md.
    """
    return solved(state, [lambda tangent, key=key: scene_rates(state, tangent.contact, key) for key in keys], tolerance)


def solved(
    state: RelaxationState, rates: Sequence[Callable[[RestTangent], Rates]], tolerance: float
) -> DrapeDerivative:
    """Derivatives by numbers whose rates functions of the tangent give; all else as of `hand_derivative`."""
    if state.problem is None or not state.report.converged:
        raise ReplayProblem("the cloth is not at rest: there is no derivative of its drape")
    tangent = RestTangent(state)
    found = [one(tangent) for one in rates]
    right = -np.stack([forces for forces, _ in found]) * state.problem.boundary.free
    s = tangent.solve(right, tolerance)
    residuals = np.array([_residual(tangent, *pair) for pair in zip(s, right)])
    if not (residuals <= SLACK * tolerance).all():
        raise ReplayProblem(
            "the tangent is nearly singular: no derivative of the drape "
            f"(its residual is {residuals.max():.1e} of the right side)"
        )
    s += np.stack([prescribed for _, prescribed in found])
    sticking, sliding = tangent.contact.counts if tangent.contact else (0, 0)
    return DrapeDerivative(s, residuals, tangent.iterations, sticking, sliding)


def _residual(tangent: RestTangent, s: np.ndarray, right: np.ndarray) -> float:
    """The residual of a derivative s (n, 3), by the elements, over its right side (n, 3)."""
    size = float(np.linalg.norm(right))
    left = tangent.product(s) * tangent.problem.boundary.free - right
    return float(np.linalg.norm(left)) / size if size else 0.0
