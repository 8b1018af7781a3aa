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
from restshape.physics.cloth.scene import kernel_body
from restshape.scene.bodies import Body
from restshape.scene.model import Scene

log = logging.getLogger("restshape.physics")

EXACT = 1e-12
"""How much the ways of bodies may differ, over the size of the cloth."""


def taken_along(before: RelaxationState, scene: Scene, bodies: tuple[Body, ...]) -> RelaxationState | None:
    """The state where bodies have taken a rest along as it lay; None where that is no rest of the frame.

    Nothing holds the cloth but bodies, all of which go the same way without turning, and nothing else is edited. The
    weight's energy is linear, the others depend on relative places alone: forces and tangent are those of the last
    rest, and so is its stability. Nothing passes, for all goes together. So the problem stays as it is, but for bodies
    and what friction remembers; where it is no rest, these do, too.

    Args:
        before: the last equilibrium, on the same mesh as it lay then.
        scene: of the frame; bodies: of it, of numbers alone.
    """
    problem = before.problem
    contact, own = problem.contact, problem.self_contact
    if not (_rests_alone(before) and _bodies_alone(made(before.scene), scene)):
        return None
    shift = common_shift(before.bodies, bodies, problem.corners(before.x), EXACT * problem.size)
    if shift is None:
        return None
    x, known, report = before.x.copy(), contact.bodies, ConvergenceReport(converged=True)
    x[problem.corner_number] += shift
    contact.bodies = [kernel_body(body) for body in bodies]
    contact.history = take_along(before.friction, before.bodies, bodies)
    if own:
        own.history = before.layers.moved(shift)
    if not before.solver.rests(x, report):
        contact.bodies, contact.history = known, before.friction
        if own:
            own.history = before.layers
        return None
    log.info("Cloth is taken along by %s m, as it lay", shift)
    return replace(before, bodies=bodies, x=x, report=report, notes=(), doubts=(), expected=None, taken=True)


def _rests_alone(before: RelaxationState) -> bool:
    """Whether cloth is at a stable rest where nothing but bodies holds it, and nothing passes it."""
    problem, report = before.problem, before.report
    by_bodies = problem.contact is not None and not len(problem.boundary.constrained)
    apart = problem.self_contact is None or problem.self_contact.active
    return by_bodies and apart and problem.order is None and report.converged and report.stable is True


def _bodies_alone(old: Scene, new: Scene) -> bool:
    """Whether two scenes differ in the forms of their bodies at most."""
    if old.bodies.keys() != new.bodies.keys():
        return False
    alike = all(_same_but(body, new.bodies[name], body.kind) for name, body in old.bodies.items())
    return alike and _same_but(old, new, "bodies")


def _same_but(old: Scene | Body, new: Scene | Body, left_out: str) -> bool:
    """Whether all but one of the fields are the same."""
    keys = (key for key in type(new).model_fields if key != left_out)
    pairs = ((getattr(old, key), getattr(new, key)) for key in keys)
    return all(one is two or one == two for one, two in pairs)


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
