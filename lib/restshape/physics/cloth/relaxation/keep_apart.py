"""Guesses of positions that would take cloth through itself: they are gone to as far as nothing passes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from restshape.algebra.nonlinear.descent import MEMORY
from restshape.physics.cloth.relaxation.equilibrium import ROUGH
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState

PARTS = 60
"""Parts of the way of supports, with a rough descent after each, at most."""
STILL, PATIENCE = 0.01, 6
"""Supports do not get any farther that go less than this part of what is left of their way, so many times in a row."""
LEFT = "a support went on before the cloth could follow: give it more frames"


def kept_apart(state: RelaxationState, last: np.ndarray) -> RelaxationState:
    """A state whose cloth does not cross itself, at positions on the way from the last ones (n, 3) to the state's own.

    What is free goes as far as nothing passes, and the relaxation does the rest. Supports get where they are in the
    frame, in parts, unless bodies are there too, with which they go (`follow_bodies`). Where the cloth stops them they
    go on all the same, and the frame is not to be trusted.
    """
    problem = state.problem
    if not problem.begin(last) or not problem.surface.crosses(problem.corners(state.x)):
        return state
    x, free = last.copy(), problem.boundary.free
    way = (state.x - x) * free
    x += problem.step_share(x, way) * way
    if problem.contact:
        return replace(state, x=problem.constrain(x))
    report, still, doubts = ConvergenceReport(), 0, (*state.doubts, LEFT)
    for _ in range(PARTS):
        way = (state.x - x) * (1.0 - free)
        share = problem.step_share(x, way)
        x += share * way
        if share == 1.0:
            doubts = state.doubts
            break
        still = still + 1 if share < STILL else 0
        if still > PATIENCE:
            break
        state.solver.descend(x, ROUGH, MEMORY, report)
        problem.next_part(x)
    return replace(state, x=problem.constrain(x), doubts=doubts)
