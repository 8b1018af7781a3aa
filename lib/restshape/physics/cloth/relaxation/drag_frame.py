"""Frames of a drag: cloth goes from its last rest along the derivative of that, and then by few steps of Newton's."""

from __future__ import annotations

import logging
from dataclasses import dataclass, replace

import numpy as np

from restshape.physics.cloth.body_path import BodyPath
from restshape.physics.cloth.contact import FrictionHistory
from restshape.physics.cloth.layer_friction import LayerFriction
from restshape.physics.cloth.relaxation.follow_bodies import take_along
from restshape.physics.cloth.relaxation.mixed_newton import MixedNewton
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.scene import kernel_body
from restshape.scene.bodies import Body

log = logging.getLogger("restshape.physics")

QUOTIENT = 1e-6
"""Part of the bodies' way in the difference quotient of the forces."""
BEYOND = 4.0
"""Way of the cloth, over the farthest one of its derivative, from which on it has gone elsewhere."""


@dataclass(frozen=True, eq=False)
class LastRest:
    """Where cloth was at rest, in the material of the frame that begins.

    Args:
        x: (n, 3) unknowns, supports as they were [m].
        bodies: as they were.
    """

    x: np.ndarray
    bodies: tuple[Body, ...]


def drag_frame(state: RelaxationState, last: LastRest) -> RelaxationState | None:
    """The state at the equilibrium that a small edit has led the last rest to; None where it leads to none nearby.

    Nothing has changed then. Cloth goes along the derivative of the rest by supports and bodies, and then by Newton's
    method with tensions of its own. No step passes anything.

    Args:
        state: with problem, solver, bodies and friction of the frame, friction as at the last rest.
        last: the last rest.
    """
    problem, solver = state.problem, state.solver
    own = problem.self_contact
    known = _memory(state)
    if own and own.active and not problem.begin(last.x):
        _restore(state, known)
        return None
    report = ConvergenceReport()
    newton = MixedNewton(solver, report)
    x = _first_step(state, last, newton)
    if x is not None:
        farthest = BEYOND * float(np.abs(problem.corners(x - last.x)).max())
        x = newton.converge(x)
        if x is not None and float(np.abs(problem.corners(x - last.x)).max()) > farthest:
            x = None
    log.info(
        "Newton's method from the last rest %s: %d steps, %d factors",
        "converged" if x is not None else "leads nowhere near",
        report.newton,
        report.factors,
    )
    if x is None:
        _restore(state, known)
        return None
    return replace(state, x=x, report=report)


def _first_step(state: RelaxationState, last: LastRest, newton: MixedNewton) -> np.ndarray | None:
    """Unknowns (n, 3) after a step along the derivative of the last rest, with bodies where they are in the frame.

    None where there is no derivative, or a body would be deeper in the cloth than it may be.
    """
    problem, x = state.problem, last.x
    contact, given = problem.contact, problem.constrain(x) - x
    forces = np.empty_like(x)
    if contact is None:
        problem.residual(x, forces)
        d = newton.way(x, forces, given)
        return None if d is None else newton.go(x, d)
    path, history = BodyPath(last.bodies, state.bodies, contact), contact.history
    _place(state, last.bodies, history)
    problem.residual(x, forces)
    if path.moves:
        moved = np.empty_like(x)
        now = path.at(QUOTIENT)
        _place(state, now, take_along(history, last.bodies, now))
        problem.residual(x, moved)
        _place(state, last.bodies, history)
        forces += (moved - forces) / QUOTIENT
    d = newton.way(x, forces, given)
    corners = problem.corners(x)
    if d is None or path.farthest(0.0, corners, problem.corners(d)) < 1.0:
        return None
    _place(state, state.bodies, take_along(history, last.bodies, state.bodies))
    return newton.go(x, d)


def _place(state: RelaxationState, bodies: tuple[Body, ...], history: FrictionHistory) -> None:
    """Let bodies be at a part of their way, with friction that has gone along."""
    contact = state.problem.contact
    contact.bodies, contact.history = [kernel_body(body) for body in bodies], history


def _memory(state: RelaxationState) -> tuple[FrictionHistory | None, LayerFriction | None]:
    """What friction remembers now."""
    contact, own = state.problem.contact, state.problem.self_contact
    return contact.history if contact else None, own.history if own else None


def _restore(state: RelaxationState, known: tuple[FrictionHistory | None, LayerFriction | None]) -> None:
    """Let friction remember what it did, and bodies be where they are in the frame."""
    history, layers = known
    if history is not None:
        _place(state, state.bodies, history)
    if layers is not None:
        state.problem.self_contact.history = layers
