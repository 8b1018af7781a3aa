"""The derivative of a drape: how positions at an equilibrium follow what is changed about the cloth."""

from __future__ import annotations

import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from restshape.errors import ReplayProblem
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.sensitivity.agreed_contact import FREE, SLIDES
from restshape.physics.cloth.sensitivity.hand_rates import hand_rates
from restshape.physics.cloth.sensitivity.rest_tangent import RestTangent
from restshape.physics.cloth.sensitivity.scene_rates import scene_rates

log = logging.getLogger("restshape.physics")

SLACK = 100.0
"""A derivative whose residual is so many times what was asked for has been lost to rounding."""

THICK = 0.01
"""Thickness over length of the plate that cloth with a singular tangent bends like. Source: the thesis, 5.3.3."""
STIFFENED = "the derivative is that of cloth which bends like a plate of 1/100 of its length: its tangent is singular"

Rates = tuple[np.ndarray, np.ndarray]
"""Rates (n, 3) of the residual at constant unknowns, and of the prescribed unknowns."""


@dataclass(frozen=True, eq=False)
class DrapeDerivative:
    """Derivatives of the unknowns of a drape, each by one number.

    Args:
        s: (k, n, 3) of positions, and with Morley's triangles of slopes, a unit of each number.
        residuals: (k,) of each, by the elements, over its right side.
        iterations: of the linear solver, of all together.
        sticking, sliding: places that friction holds, and places along which it slips.
        states: (corners,) what friction does to each corner: 0 it sticks, 1 it slides, 2 it is free.
        note: what there is to say of how they were had; empty: nothing.
    """

    s: np.ndarray
    residuals: np.ndarray
    iterations: int
    sticking: int
    sliding: int
    states: np.ndarray
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
    return solved(
        state,
        [lambda tangent, dX=dX: hand_rates(state, tangent, dX) for dX in motion],
        tolerance,
    )


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
    return solved(state, [lambda tangent, key=key: scene_rates(state, tangent, key) for key in keys], tolerance)


def solved(
    state: RelaxationState, rates: Sequence[Callable[[RestTangent], Rates]], tolerance: float
) -> DrapeDerivative:
    """Derivatives by numbers whose rates functions of the tangent give; all else as of `hand_derivative`."""
    if state.problem is None or not state.report.converged:
        raise ReplayProblem("the cloth is not at rest: there is no derivative of its drape")
    tangent = RestTangent(state)
    changes = [one(tangent) for one in rates]
    s, residuals = _solutions(tangent, changes, tolerance)
    note, lost = "", SLACK * tolerance
    if not (residuals <= lost).all() and state.problem.bending:
        log.info("Tangent of the drape is nearly singular: its derivative once more with stiffened bending")
        note = STIFFENED
        with state.problem.stiffened(THICK):
            s, residuals = _solutions(RestTangent(state, own=True), changes, tolerance)
    if not (residuals <= lost).all():
        raise ReplayProblem(
            "the tangent is nearly singular: no derivative of the drape "
            f"(its residual is {residuals.max():.1e} of the right side)"
        )
    corners = len(state.problem.corner_number)
    found = [part for part in (tangent.contact, tangent.layers) if part]
    sticking, sliding = (sum(part.counts[k] for part in found) for k in range(2))
    states = np.full(corners, FREE)
    for part in found:
        own = part.states[:corners]
        states = np.where(own == FREE, states, np.where(states == SLIDES, states, own))
    return DrapeDerivative(s, residuals, tangent.iterations, sticking, sliding, states, note)


def _solutions(tangent: RestTangent, rates: Sequence[Rates], tolerance: float) -> tuple[np.ndarray, np.ndarray]:
    """The derivatives (k, n, 3) with a tangent, and their residuals (k,) by the elements over their right sides."""
    free = tangent.problem.boundary.free
    right = np.stack([-forces - (tangent.product(moved) if moved.any() else 0.0) for forces, moved in rates]) * free
    s = tangent.solve(right, tolerance)
    found = np.array([_residual(tangent, *pair) for pair in zip(s, right)])
    return s + np.stack([moved for _, moved in rates]), np.where(np.isfinite(found), found, np.inf)


def _residual(tangent: RestTangent, s: np.ndarray, right: np.ndarray) -> float:
    """The residual of a derivative s (n, 3), by the elements, over its right side (n, 3)."""
    size = float(np.linalg.norm(right))
    left = tangent.product(s) * tangent.problem.boundary.free - right
    return float(np.linalg.norm(left)) / size if size else 0.0
