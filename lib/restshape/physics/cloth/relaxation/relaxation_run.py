"""One relaxation of cloth: from a cold start or the last positions to an equilibrium that is stable."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np

from restshape.errors import ReplayProblem
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.out_of_bodies import Bodies
from restshape.physics.cloth.relaxation.binding import friction_of, layers_of
from restshape.physics.cloth.relaxation.close_seams import close_seams, gaps_at, has_opened
from restshape.physics.cloth.relaxation.cold_start import ColdStart
from restshape.physics.cloth.relaxation.equilibrium import EquilibriumSolver
from restshape.physics.cloth.relaxation.jumps import jump_note
from restshape.physics.cloth.relaxation.relaxation_options import RelaxationOptions
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.saddle_escape import SaddleEscape
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.relaxation.strategies import STRATEGIES
from restshape.physics.cloth.self_contact.untangling import Untangling

log = logging.getLogger("restshape.physics")

ESCAPES = 5
"""Saddles of the energy that are left in one frame before the cloth is said to rest on one."""
ONE_MESH = "nested meshes led to no equilibrium: the cold start was made on one"
SHORT = 60
"""Steps from a saddle after which the cloth falls for the rest of the way."""


def relax(state: RelaxationState, cold: bool, options: RelaxationOptions) -> RelaxationState:
    """The state at the equilibrium that a frame's problem has near the state's positions.

    Args:
        state: with problem and solver of the frame; it stays as it is.
        cold: the cloth starts from its initial placement.
        options: of the frame's scene.

    Raises:
        ReplayProblem: positions are no numbers.
    """
    problem = state.problem
    x, report, abandoned = _equilibrium(state, cold, options)
    if not np.isfinite(x).all():
        raise ReplayProblem("the cloth's positions are no numbers")
    dragged = problem.end_frame(x)
    if report.converged:
        _come_apart(state, x, options, report)
        _stabilise(state, x, options, report)
    report.slip = max(report.slip, dragged)
    notes = [ONE_MESH] if abandoned and report.converged else []
    if abandoned:
        report.count(abandoned)
    report.count(state.report)
    if report.converged and state.expected:
        notes += jump_note(problem, state.expected, x, report.saddles > 0)
    log.info("Relaxation %s: %d steps, residual over load %.3e", _outcome(report), report.steps, report.residual)
    # Without contact nothing remembers how cloth came to where it rests.
    kept = state.softness if (problem.contact or problem.self_contact) and not cold else 1.0
    softness = min(kept, report.softness)
    found = replace(state, x=x, report=report, place=problem.place, softness=softness, notes=(*state.notes, *notes))
    gaps = gaps_at(problem.seams, problem.corners(x), options.scene) if report.converged else {}
    found = replace(found, energy=problem.energy(x), gaps=gaps, taken=False)
    found = replace(found, lasting=state.lasting.at(x, state.taken and not report.steps))
    return replace(found, expected=None, friction=friction_of(problem), layers=layers_of(problem))


def _equilibrium(
    state: RelaxationState, cold: bool, options: RelaxationOptions
) -> tuple[np.ndarray, ConvergenceReport, ConvergenceReport | None]:
    """Positions (n, 3), how they were reached, and how a cold start ended that was given up.

    Where nested meshes lead a cold start to no equilibrium, such as limp cloth past a body that a coarse mesh hardly
    sees, it starts again on the finest mesh alone.
    """
    solver, most, strategy = state.solver, options.settings.steps, options.strategy
    report, x = ConvergenceReport(), state.x.copy()
    if state.taken:
        return x, replace(state.report), None
    opened = not cold and strategy == "auto" and has_opened(solver, x, options.scene, state.gaps)
    if opened and not solver.rests(x, report):
        # An edit has sewn what lay apart, or has torn it apart.
        close_seams(solver, x, most, report)
    if not (cold and strategy == "auto"):
        return x, STRATEGIES[strategy](solver, x, most, report), None
    friction, layers = friction_of(state.problem), layers_of(state.problem)
    start = _cold_start(solver, options, options.settings.levels)
    x = start.find(most, report)
    state.problem.begin(x)
    STRATEGIES[strategy](solver, x, most, report)
    if report.converged or len(start.meshes) == 1:
        return x, report, None
    log.info("Cold start on %d nested meshes: not converged (%s); again on one", len(start.meshes), report.why)
    if friction is not None:
        state.problem.contact.history = friction
    if layers is not None:
        state.problem.self_contact.history = layers
    again = ConvergenceReport()
    x = _cold_start(solver, options, 1).find(most, again)
    STRATEGIES[strategy](solver, x, most, again)
    return x, again, report


def _come_apart(state: RelaxationState, x: np.ndarray, options: RelaxationOptions, report: ConvergenceReport) -> None:
    """Go on from x (n, 3), which is changed, with contact of the cloth with itself where it crosses itself no more.

    Cloth that still crosses itself in few places is moved apart there first, where that is possible.
    """
    problem = state.problem
    own = problem.self_contact
    if not own or own.active:
        return
    if not own.begin(problem.corners(x)):
        _untangle(problem, x)
    if own.begin(problem.corners(x)):
        log.info("Cloth has come apart: it touches itself from now on")
        report.converged = False
        STRATEGIES[options.strategy](state.solver, x, options.settings.steps, report)


def _untangle(problem: ClothProblem, x: np.ndarray) -> None:
    """Move cloth at x (n, 3), which is changed, apart where it crosses itself; where that fails it stays."""
    corners, contact = problem.corners(x), problem.contact
    bodies, clear = (Bodies(contact.bodies), contact.thickness) if contact else (None, 0.0)
    movable = ~problem.boundary.mask[problem.corner_number].any(axis=1)
    apart = Untangling(problem.surface, bodies, clear).apart(corners, movable)
    if apart is not None:
        log.info("Cloth was moved apart where it crossed itself, by %.3e m", np.abs(apart - corners).max())
        x[:] = problem.constrain(x + problem.flat(apart) - problem.flat(corners))


def _cold_start(solver: EquilibriumSolver, options: RelaxationOptions, levels: int) -> ColdStart:
    """What lets the cloth of a scene fall, on so many nested meshes at most."""
    start = options.scene.start
    scattered = start is not None and start.scatter > 0.0
    return ColdStart(solver, levels, options.arguments, options.make_solver, scattered)


def _outcome(report: ConvergenceReport) -> str:
    """How a relaxation has ended, for the log."""
    if not report.converged:
        return f"not converged ({report.why})"
    return "converged" if report.stable else "converged, stability not proven"


def _stabilise(state: RelaxationState, x: np.ndarray, options: RelaxationOptions, report: ConvergenceReport) -> None:
    """Leave saddles of the energy from x (n, 3), which is changed, until the equilibrium is stable."""
    if state.taken and not report.steps:
        report.stable = True
        return
    solver, most, strategy = state.solver, options.settings.steps, options.strategy
    saddle, converge = SaddleEscape(solver), STRATEGIES[strategy]
    for _ in range(ESCAPES):
        report.stable = saddle.is_stable(x)
        if report.stable or strategy != "auto" or report.steps >= most:
            return
        log.info("Tangent is not positive definite: the equilibrium is a saddle of the energy")
        if not saddle.escape(x):
            log.info("Saddle kept: no mode leads off it")
            # Nothing but a motion that hardly anything resists, such as turning about a pin.
            return
        log.info("Saddle escape along the lowest mode")
        report.saddles += 1
        report.converged = False
        converge(solver, x, min(most, SHORT), report)
        if not report.converged:
            _cold_start(solver, options, 1).go_on(x, most, report)
            converge(solver, x, most, report)
    report.stable = saddle.is_stable(x) if report.converged else None
