"""Guesses of a frame's positions that would take cloth through itself: they are gone to as far as nothing passes."""

from __future__ import annotations

import numpy as np

from restshape.algebra.descent import MEMORY
from restshape.physics.cloth.relaxation.equilibrium import ROUGH
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.relaxation.state import RelaxationState

PARTS = 30
"""Parts of the way of supports, with a rough descent after each; what is left then is gone at once."""


def kept_apart(state: RelaxationState, last: np.ndarray) -> np.ndarray:
    """Positions (n, 3) on the way from the last ones (n, 3) to those of a state, where the cloth does not cross itself.

    What is free goes as far as nothing passes, and the relaxation does the rest. Supports get where they are in the
    frame, in parts, unless bodies are there too, with which they go (`follow_bodies`).
    """
    problem = state.problem
    if not problem.begin(last) or not problem.surface.crosses(problem.corners(state.x)):
        return state.x
    x, free = last.copy(), problem.boundary.free
    way = (state.x - x) * free
    x += problem.step_share(x, way) * way
    if problem.contact:
        return problem.constrain(x)
    report = ConvergenceReport()
    for _ in range(PARTS):
        way = (state.x - x) * (1.0 - free)
        share = problem.step_share(x, way)
        x += share * way
        if share == 1.0:
            break
        state.solver.descend(x, ROUGH, MEMORY, report)
    return problem.constrain(x)
