"""Cloth that bodies take along as it lies: where all of them go the same way, so does the rest."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np

from restshape.first_use import made
from restshape.physics.cloth.body_path import same_kind, speed_of
from restshape.physics.cloth.relaxation.follow_bodies import take_along
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.scene.bodies import Body
from restshape.scene.model import Scene

log = logging.getLogger("restshape.physics")

EXACT = 1e-12
"""How much the ways of bodies may differ, over the size of the cloth."""


def taken_along(state: RelaxationState, before: RelaxationState, scene: Scene) -> RelaxationState | None:
    """The state where bodies have taken a rest along as it lay; None where that is no rest of the frame.

    Nothing holds the cloth but bodies, all of which go the same way without turning, and nothing else is edited. The
    weight's energy is linear, the others depend on relative places alone: forces and tangent are those of the last
    rest, and so is its stability. Nothing passes, for all goes together.

    Args:
        state: of the frame, in which nothing has moved yet but the bodies, with the friction of the last rest.
        before: the last equilibrium, of the same problem.
        scene: of the frame.
    """
    problem, own = state.problem, state.problem.self_contact
    if not (_rests_alone(before) and _bodies_alone(made(before.scene), scene)):
        return None
    shift = common_shift(before.bodies, state.bodies, problem.corners(before.x), EXACT * problem.size)
    if shift is None or before.place.farthest(problem.place) > 0.0:
        return None
    x, known = before.x.copy(), (problem.contact.history, own.history if own else None)
    x[problem.corner_number] += shift
    problem.contact.history = take_along(known[0], before.bodies, state.bodies)
    if own:
        own.history = known[1].moved(shift)
    if not state.solver.rests(x, ConvergenceReport()):
        problem.contact.history = known[0]
        if own:
            own.history = known[1]
        return None
    log.info("Cloth is taken along by %s m, as it lay", shift)
    return replace(state, x=x, taken=True)


def _rests_alone(before: RelaxationState) -> bool:
    """Whether cloth is at a stable rest where nothing but bodies holds it, and nothing passes it."""
    problem, report = before.problem, before.report
    by_bodies = problem.contact is not None and not len(problem.boundary.constrained)
    apart = problem.self_contact is None or problem.self_contact.active
    return by_bodies and apart and report.converged and report.stable is True


def _bodies_alone(old: Scene, new: Scene) -> bool:
    """Whether two scenes differ in the forms of their bodies at most."""
    if old.bodies.keys() != new.bodies.keys():
        return False
    alike = all(_same_but(body, new.bodies[name], body.kind) for name, body in old.bodies.items())
    return alike and _same_but(old, new, "bodies")


def _same_but(old: Scene | Body, new: Scene | Body, left_out: str) -> bool:
    """Whether all but one of the fields are the same."""
    return all(getattr(old, key) == getattr(new, key) for key in type(new).model_fields if key != left_out)


def common_shift(before: tuple[Body, ...], after: tuple[Body, ...], x: np.ndarray, exact: float) -> np.ndarray | None:
    """The way (3,) [m] that all bodies of numbers go, but for so much [m]; None where they do not go the same one.

    Args:
        before, after: bodies.
        x: (n, 3) where the cloth is [m].
        exact: difference of ways [m].
    """
    if len(before) != len(after) or not all(map(same_kind, before, after)):
        return None
    speeds = [speed_of(old, new, x) for old, new in zip(before, after)]
    if not speeds or max(speed.rest for speed in speeds) > exact:
        return None
    shift = speeds[0].shift
    alike = all(np.abs(speed.shift - shift).max() <= exact for speed in speeds)
    return shift if alike and shift.any() else None
