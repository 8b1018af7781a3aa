"""Cloth that follows bodies through a frame: their way is cut where they would pass it."""

from __future__ import annotations

import logging
import math
from dataclasses import replace

import numpy as np

from restshape.algebra.nonlinear.descent import MEMORY
from restshape.physics.cloth.body_path import BodyPath, goes_on
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.body_motion import (
    body_axes,
    is_remade,
    moved_with,
    turn_of,
    turned_share,
    turning_of,
)
from restshape.physics.cloth.contact.contact import FrictionHistory
from restshape.physics.cloth.contact.mesh_bodies import distance_of
from restshape.physics.cloth.relaxation.equilibrium import ROUGH
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.scene import kernel_body
from restshape.scene.bodies import Body, Plane

log = logging.getLogger("restshape.physics")

ROUNDS = 2
"""Tangents of the rough descent after each part of the way."""
PATIENCE = 6
"""Descents in a row after which a body that has not got any farther goes on all the same; the frame is doubted then."""
MOST_PARTS = 1_000
"""Parts of a frame's way at most; the rest is gone at once, and the frame is doubted."""
TURNED = 1.1
"""Angle by which a body turns in a part, at most [rad], with cloth that goes with it."""
FAR = 12.0
"""Way of a half-space, over the thickness of contact, from which on held cloth is guessed to go along: from less than
that it gets out by itself in few steps."""
SQUEEZED = 0.5
"""Part of the cloth's height above a half-space by which this may rise with the cloth guessed to go along."""
STILL = 0.1
"""A body has not got any farther where it went less than this part of the way that it may be in the cloth."""


def follow_bodies(state: RelaxationState, before: tuple[Body, ...], begin: np.ndarray) -> RelaxationState:
    """Cloth that bodies, and what holds it, have taken along to where they are in a frame.

    Where they get there without being deeper in the cloth than a quarter of a body's size, positions are guessed at
    once. Elsewhere they go as far as that, the cloth goes roughly to rest, and so on.

    Args:
        state: with problem, solver and bodies of the frame.
        before: the bodies of the last frame.
        begin: (n, 3) unknowns with the places of supports in the last frame [m]; those of the state are the frame's.
    """
    problem, contact = state.problem, state.problem.contact
    path, pulled = BodyPath(before, state.bodies, contact, problem.corners(begin)), state.x - begin
    if not (path.moves or pulled.any()):
        return state
    x, share, parts, still, report = begin.copy(), 0.0, 1, 0, ConvergenceReport()
    now, doubts = before, set()
    while True:
        part = turned_part(problem, now, state.bodies)
        aim = 1.0 if part == 1.0 else share + part * (1.0 - share)
        # What goes so far in a part would go on as far.
        way = body_guess(problem, x, now, path.at(aim)) * problem.boundary.free / part + (1.0 - share) * pulled
        corners, ways = problem.corners(x), problem.corners(way)
        reached = min(aim, path.farthest(share, corners, ways))
        if problem.self_contact:
            reached = min(reached, share + (aim - share) * problem.self_contact.step_share(corners, part * ways))
        least = path.least(share, corners, ways)
        still = still + 1 if reached < 1.0 and reached - share < STILL * least else 0
        if still > PATIENCE:
            reached, still = min(1.0, share + least), 0
            doubts.add("a body went on before the cloth could follow: give it more frames")
        if parts == MOST_PARTS:
            reached = 1.0
            doubts.add("a body went the rest of its way before the cloth could follow: give it more frames")
        x = x + (reached - share) / (1.0 - share) * way
        share, last, now = reached, now, path.at(reached)
        contact.history = take_along(contact.history, last, now)
        contact.bodies = [kernel_body(body) for body in now]
        if share == 1.0:
            break
        parts += 1
        # A body that leaves would pull along what its friction holds until the end of a part.
        contact.end_frame(problem.corners(x))
        state.solver.descend(x, ROUGH, ROUNDS * MEMORY, report)
        problem.next_part(x)
    spent = ConvergenceReport()
    spent.count(state.report)
    spent.count(report)
    notes = (*state.notes, *_remade_notes(state, before))
    notes = notes if parts == 1 else (*notes, f"the way of the bodies was gone in {parts} parts")
    if parts > 1:
        log.info("Bodies went their way in %d parts, %d steps", parts, report.steps)
    return replace(state, x=problem.constrain(x), report=spent, notes=notes, doubts=tuple(sorted(doubts)))


def _remade_notes(state: RelaxationState, before: tuple[Body, ...]) -> list[str]:
    """What there is to say of mannequins whose sizes are others than in the last frame."""
    changed = [(name, new) for name, old, new in zip(state.scene.bodies, before, state.bodies) if is_remade(old, new)]
    facts = {name: (body.form.scale, distance_of(body.form).facts) for name, body in changed}
    return [
        f"the distance from bodies.{name} is that of its new sizes, on {1e3 * scale * own.spacing:.3g} mm, wrong by "
        f"{1e3 * scale * own.error:.2g} mm at most"
        for name, (scale, own) in facts.items()
    ]


def take_along(history: FrictionHistory, before: tuple[Body, ...], after: tuple[Body, ...]) -> FrictionHistory:
    """What friction remembers when its anchors have gone where their bodies have."""
    begin, moves = history.begin, list(zip(before, after))

    def along(places: np.ndarray) -> np.ndarray:
        return np.array([moved_with(old, new, own) for (old, new), own in zip(moves, places)])

    if begin:
        begin = replace(begin, anchors=along(begin.anchors), corners=along(begin.corners))
    return replace(history, anchors=along(history.anchors), begin=begin)


def turned_part(problem: ClothProblem, before: tuple[Body, ...], after: tuple[Body, ...]) -> float:
    """The share of its way that the body which cloth goes with goes at once: the cloth would shrink about a turn."""
    number = _carrier(problem, before, after)
    if number is None:
        return 1.0
    old, new = before[number], after[number]
    return turned_share(old, new, max(1, math.ceil(turning_of(old, new) / TURNED)))


def _carrier(problem: ClothProblem, before: tuple[Body, ...], after: tuple[Body, ...]) -> int | None:
    """The number of the body that the cloth goes with: it alone presses it, nothing else holds it, and it moves."""
    pressed = [k for k in range(len(after)) if problem.contact.history.pressed(k)]
    if len(pressed) != 1 or len(problem.boundary.constrained):
        return None
    old, new = before[pressed[0]], after[pressed[0]]
    return pressed[0] if goes_on(old, new) and old.form != new.form else None


def body_guess(problem: ClothProblem, x: np.ndarray, before: tuple[Body, ...], after: tuple[Body, ...]) -> np.ndarray:
    """How far (n, 3) cloth at x (n, 3) is guessed to go with bodies.

    Cloth that lies on one body alone, and hangs nowhere, goes where this goes; where supports hold it, see `lifted`.
    """
    contact, number = problem.contact, _carrier(problem, before, after)
    if number is None:
        return lifted(problem, x, before, after)
    old, new = before[number], after[number]
    corners = problem.corners(x)
    # Slopes turn with the cloth.
    way = x @ turn_of(old, new).T - x
    found = surface_motion(old, new, contact.place(corners), contact.history, number)
    way[problem.corner_number] = found[: len(corners)]
    return way


def lifted(problem: ClothProblem, x: np.ndarray, before: tuple[Body, ...], after: tuple[Body, ...]) -> np.ndarray:
    """How far (n, 3) held cloth at x (n, 3) is guessed to go with a half-space that alone presses it, and rises.

    All of space goes, evenly less with the distance, so that the farthest place stays: layers that lie on the surface
    go along as they lie, and nothing can cross. Left behind, they would have to get out of it one after the other.
    """
    pressed = [k for k in range(len(after)) if problem.contact.history.pressed(k)]
    old, new = (bodies[pressed[0]].form if len(pressed) == 1 else None for bodies in (before, after))
    if not (isinstance(old, Plane) and isinstance(new, Plane)) or old.normal != new.normal:
        return np.zeros_like(x)
    normal = np.asarray(new.normal, float) / np.linalg.norm(new.normal)
    rise = float(np.subtract(new.point, old.point) @ normal)
    height = float(((problem.corners(x) - old.point) @ normal).max())
    if not FAR * problem.contact.thickness < rise < SQUEEZED * height:
        return np.zeros_like(x)
    # Slopes change with the gradient of the map.
    way = -rise / height * x @ normal
    way[problem.corner_number] += rise * (1.0 + np.asarray(old.point) @ normal / height)
    return way[:, None] * normal


def surface_motion(old: Body, new: Body, places: np.ndarray, history: FrictionHistory, number: int) -> np.ndarray:
    """How far (n, 3) [m] cloth at places (n, 3) [m] goes with the only body that presses it.

    All of it goes with the body's centre, and turns with it. Where the body also grows or shrinks, what touches follows
    the surface along its normal, and the rest the mean of this: cloth that a shrinking body leaves for one step would
    land again without the friction that kept it, and slide off little by little.
    """
    turn, (centre, _) = turn_of(old, new), body_axes(old)
    rigid = (places - centre) @ turn.T + body_axes(new)[0] - places
    touching, normals = history.limits[number] > 0.0, history.normals[number] @ turn.T
    own = moved_with(old, new, places) - places - rigid
    normal = np.einsum("na,na->n", own, normals)[:, None] * normals
    return rigid + np.where(touching[:, None], normal, normal[touching].mean(axis=0))
