"""One relaxation of cloth: from a cold start or the last positions to an equilibrium that is stable."""

from __future__ import annotations

import logging
from dataclasses import replace

import numpy as np

from restshape.errors import ReplayProblem
from restshape.physics.cloth.relaxation.binding import friction_of
from restshape.physics.cloth.relaxation.cold_start import ColdStart, restart_soft
from restshape.physics.cloth.relaxation.relaxation_options import RelaxationOptions
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.saddle_escape import SaddleEscape
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.relaxation.strategies import STRATEGIES

log = logging.getLogger("restshape.physics")

ESCAPES = 5
"""Saddles of the energy that are left in one frame before the cloth is said to rest on one."""
SHORT = 300
"""Steps from a saddle after which the membrane is softened for the rest of the way."""


def relax(state: RelaxationState, cold: bool, options: RelaxationOptions) -> RelaxationState:
    """The state at the equilibrium that a frame's problem has near the state's positions.

    Args:
        state: with problem and solver of the frame; it stays as it is.
        cold: the cloth starts from its initial placement.
        options: of the frame's scene.

    Raises:
        ReplayProblem: positions are no numbers.
    """
    solver, most, strategy = state.solver, options.settings.steps, options.strategy
    report, x = ConvergenceReport(), state.x.copy()
    if cold and strategy == "auto":
        start = ColdStart(solver, options.settings.levels, options.arguments, options.make_solver)
        x = start.find(most, report)
    STRATEGIES[strategy](solver, x, most, report)
    if not np.isfinite(x).all():
        raise ReplayProblem("the cloth's positions are no numbers")
    if report.converged:
        _stabilise(state, x, options, report)
    log.info("Relaxation %s: %d steps, residual over load %.3e", _outcome(report), report.steps, report.residual)
    problem = state.problem
    return replace(state, x=x, report=report, place=problem.place, friction=friction_of(problem))


def _outcome(report: ConvergenceReport) -> str:
    """How a relaxation has ended, for the log."""
    if not report.converged:
        return f"not converged ({report.why})"
    return "converged" if report.stable else "converged, stability not proven"


def _stabilise(state: RelaxationState, x: np.ndarray, options: RelaxationOptions, report: ConvergenceReport) -> None:
    """Leave saddles of the energy from x (n, 3), which is changed, until the equilibrium is stable."""
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
        report.converged = False
        converge(solver, x, min(most, SHORT), report)
        if not report.converged:
            restart_soft(solver, x, most, report)
            converge(solver, x, most, report)
    report.stable = saddle.is_stable(x) if report.converged else None
