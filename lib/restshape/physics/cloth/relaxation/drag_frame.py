"""Frames of a drag: cloth goes from its last rest along the derivative of that, and then by few steps of Newton's."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from restshape.physics.cloth.body_path import BodyPath, same_kind, speed_of
from restshape.physics.cloth.contact.contact import FrictionHistory
from restshape.physics.cloth.contact.tunnelling import deepened, penetrations
from restshape.physics.cloth.relaxation.follow_bodies import take_along
from restshape.physics.cloth.relaxation.frame_way import FrameWay
from restshape.physics.cloth.relaxation.jumps import Expected, farthest
from restshape.physics.cloth.relaxation.mixed_newton import FEW, MOST, MixedNewton
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.scene import kernel_body
from restshape.physics.cloth.self_contact.layer_friction import LayerFriction
from restshape.scene.bodies import Body

log = logging.getLogger("restshape.physics")

QUOTIENT = 1e-6
"""Part of the bodies' way in the difference quotient of the forces."""
CURVED = 1e-3
"""Part of the way along the derivative on which energies are taken, for their first and second derivatives."""
BEYOND = 4.0
"""Way of the cloth, over the farthest one of its derivative, from which on it has gone elsewhere."""


@dataclass(frozen=True, eq=False)
class LastRest:
    """Where cloth was at rest, in the material of the frame that begins.

    Args:
        x: (n, 3) unknowns, supports as they were [m].
        bodies: as they were.
        material: the farthest way of a node in the material since [m].
        energy: of the cloth there [J], in the material as it was.
        still: (n, 3) unknowns whose nodes of the mesh are where they were in space, not in the material [m].
        tensions: (ne, 3) of the membrane as it was [N/m].
    """

    x: np.ndarray
    bodies: tuple[Body, ...]
    material: float
    energy: float
    still: np.ndarray
    tensions: np.ndarray


def drag_frame(state: RelaxationState, last: LastRest) -> tuple[RelaxationState, bool]:
    """The state at the equilibrium that a small edit has led the last rest to, or on the way there, and whether it is.

    Cloth goes along the derivative of the rest by supports and bodies, and then by Newton's method with tensions of its
    own. No step passes anything. Where that does not converge soon, a descent goes on from the positions with the least
    energy. Where it leads nowhere the state is as it was, with what was expected of it.

    Args:
        state: with problem, solver, bodies and friction of the frame, friction as at the last rest.
        last: the last rest.
    """
    problem, solver = state.problem, state.solver
    left_out = solver.tries.left_out()
    known = _memory(state)
    begun, way = _uncrossed(state, last, known)
    if begun is None:
        return replace(state, expected=_first_order(state, last)), False
    report, begins = ConvergenceReport(), _energy_begun(state, last, known)
    newton = MixedNewton(solver, report, begun.tensions if way.slides else None)
    x, expected = _first_step(state, begun, way, newton)
    state = replace(state, expected=expected or _first_order(state, last))
    rests = False
    if x is not None:
        most = BEYOND * farthest(problem, x - begun.x)
        x, rests = newton.converge(x, FEW if left_out else MOST, begins)
        if x is not None and farthest(problem, x - begun.x) > most:
            x = None
    log.info(
        "Newton's method from the last rest %s: %d steps, %d factors",
        "leads nowhere near" if x is None else "converged" if rests else "has not converged",
        report.newton,
        report.factors,
    )
    if rests or not left_out:
        solver.tries.count(rests)
    if x is None:
        _restore(state, known)
        return replace(state, expected=replace(state.expected, work=_first_order(state, last).work)), False
    return replace(state, x=x, report=report), True


def _energy_begun(
    state: RelaxationState, last: LastRest, known: tuple[FrictionHistory | None, LayerFriction | None]
) -> float:
    """The energy [J] of the cloth at the last rest with supports, bodies and friction where the frame begins."""
    ended = _memory(state)
    _restore(state, known)
    energy = state.problem.energy(state.problem.constrain(last.x))
    _restore(state, ended)
    return energy


def _uncrossed(
    state: RelaxationState, last: LastRest, known: tuple[FrictionHistory | None, LayerFriction | None]
) -> tuple[LastRest | None, FrameWay]:
    """The last rest where its derivative begins, and the way from there; None where the cloth crosses itself.

    Nodes that go through the cloth with their material may cross it at sharp folds, which their triangles' mean
    gradients do not follow. The derivative begins where they were then, and leads them there.
    """
    problem, own = state.problem, state.problem.self_contact
    if not (own and own.active) or problem.begin(last.x):
        return last, FrameWay(problem, last.bodies, state.bodies)
    begins = last.material > 0.0 and problem.begin(last.still)
    _restore(state, known)
    way = FrameWay(problem, last.bodies, state.bodies, last.x - last.still)
    return (replace(last, x=last.still) if begins else None), way


def _first_step(
    state: RelaxationState, last: LastRest, way: FrameWay, newton: MixedNewton
) -> tuple[np.ndarray | None, Expected | None]:
    """Unknowns (n, 3) after a step along the derivative of the last rest, and what it leads to expect of the frame.

    Bodies are where they are in the frame then. None in place of unknowns where there is no derivative, or one that
    knows nothing of a body: it would be deeper in the cloth than the distance at which contact begins, or pass through
    cloth on its way.
    """
    problem, x, path = state.problem, last.x, way.path
    given = problem.constrain(x) - x
    way.place(0.0)
    forces = np.empty_like(x)
    problem.residual(x, forces)
    hand = _hand(state, last, given)
    if way.moves:
        pushed = np.empty_like(x)
        way.place(QUOTIENT)
        problem.residual(x, pushed)
        way.place(0.0)
        forces += (pushed - forces) / QUOTIENT
    rests = not given.any() and float(np.linalg.norm(forces)) <= state.solver.goal * state.solver.scale(x)
    # Cloth that nothing has touched stays where it is, to the last bit.
    d = given if rests else newton.way(x, forces, given)
    if d is None:
        return None, None
    energy = last.energy if way.slides else _energy_along(state, x, d, way)
    expected = Expected(x, hand, farthest(problem, d), energy, energy)
    way.place(1.0)
    begin = problem.corners(x)
    x = x if rests else newton.go(x, d)
    if path and path.moves and path.farthest(0.0, begin, problem.corners(x) - begin) < 1.0:
        return None, expected
    return (None if path and _comes_deep(state, last, x) else x), expected


def _energy_along(state: RelaxationState, x: np.ndarray, d: np.ndarray, way: FrameWay) -> float:
    """The energy [J] after a step d (n, 3) from x (n, 3) [m], by its first two derivatives along the way."""
    energies = []
    for share in (0.0, CURVED, 2.0 * CURVED):
        if way.moves:
            way.place(share)
        energies.append(state.problem.energy(x + share * d))
    return _continued(energies, CURVED)


def _comes_deep(state: RelaxationState, last: LastRest, x: np.ndarray) -> bool:
    """Whether a body is deeper in cloth at x (n, 3) [m] than contact is thick, and than it was at the last rest."""
    problem, contact = state.problem, state.problem.contact
    depths = penetrations(contact, problem.corners(x))
    if max(depths, default=0.0) <= contact.thickness:
        return False
    bodies = [kernel_body(body) for body in last.bodies]
    return deepened(penetrations(contact, problem.corners(last.x), bodies), depths, contact.thickness)


def _first_order(state: RelaxationState, last: LastRest) -> Expected:
    """What to expect of a frame without the derivative of the last rest, which is made where the cloth goes far.

    Energies are taken on by the work of the forces at supports and bodies: what is free rests. Where material has moved
    the energy is that of the last rest: in the new material the old places would stretch it.
    """
    problem, contact, x = state.problem, state.problem.contact, last.x
    given, known, energies = problem.constrain(x) - x, _memory(state), []
    path = BodyPath(last.bodies, state.bodies, contact) if contact else None
    for share in (-QUOTIENT, QUOTIENT):
        if path:
            now = path.at(share)
            _place(state, now, take_along(known[0], last.bodies, now))
        energies.append(problem.energy(x + share * given))
    _restore(state, known)
    energy = 0.5 * sum(energies) + (energies[1] - energies[0]) / (2.0 * QUOTIENT)

    def derive(end: np.ndarray) -> Expected | None:
        """With the derivative, once the frame has ended at unknowns (n, 3)."""
        return _derived(state, last, known, end)

    energy = last.energy if last.material > 0.0 else energy
    return Expected(x, _hand(state, last, given), 0.0, energy, energy, derive)


def _derived(
    state: RelaxationState, last: LastRest, known: tuple[FrictionHistory | None, LayerFriction | None], end: np.ndarray
) -> Expected | None:
    """What the derivative of the last rest leads to expect of a frame that has ended at unknowns (n, 3).

    Args:
        state: of the frame as it began; last: the last rest.
        known: what friction remembered then.
    """
    problem, ended = state.problem, _memory(state)
    own = problem.self_contact
    if own and not own.active:
        return None
    expected = None
    if not own or problem.begin(last.x):
        _restore(state, known)
        way = FrameWay(problem, last.bodies, state.bodies)
        expected = _first_step(state, last, way, MixedNewton(state.solver, ConvergenceReport()))[1]
    if own:
        problem.begin(end)
    _restore(state, ended)
    return expected


def _hand(state: RelaxationState, last: LastRest, given: np.ndarray) -> float:
    """The farthest way [m] of supports, which is given (n, 3) [m], bodies and material in an edit."""
    corners = state.problem.corners(last.x)
    ways = [_way(old, new, corners) for old, new in zip(last.bodies, state.bodies)] if state.problem.contact else []
    return max(last.material, farthest(state.problem, given), *ways)


def _continued(values: Sequence[float], step: float) -> float:
    """The value at 1 of the parabola through three at 0, a step and two."""
    first, middle, last = values
    return first + (middle - first) / step + 0.5 * (1.0 / step - 1.0) * (last - 2.0 * middle + first) / step


def _way(old: Body, new: Body, x: np.ndarray) -> float:
    """How far [m] the surface of a body goes, at most, where cloth is at x (n, 3) [m]; 0 of one of another kind."""
    if not same_kind(old, new):
        return 0.0
    speed = speed_of(old, new, x)
    return float(np.linalg.norm(speed.shift)) + speed.rest


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
