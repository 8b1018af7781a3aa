"""Supports that go far in a frame: cloth follows them in parts of their way, by Newton's method of the mixed form."""

from __future__ import annotations

import logging
import math
from dataclasses import replace

import numpy as np

from restshape.physics.cloth.relaxation.equilibrium import ROUGH
from restshape.physics.cloth.relaxation.jumps import farthest
from restshape.physics.cloth.relaxation.mixed_newton import MixedNewton
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.scene.bodies import Body

log = logging.getLogger("restshape.physics")

STEPS, LAST_STEPS = 2, 30
"""Steps of Newton's method in a part of the way, at most, and in the last one, until supports are there."""
LEAST = 0.02
"""Length of a part, at least, over the cloth's size; it is as long as an edge of a coarser mesh."""
ROUNDING = 1e-9
"""Of the cloth's size: a support that is so near is there."""


def pull_supports(
    state: RelaxationState, bodies: tuple[Body, ...], last: np.ndarray
) -> tuple[RelaxationState, np.ndarray]:
    """The state whose supports have taken the cloth along, and the positions (n, 3) [m] from which they are to go on.

    Nodes that were set alone to where an edit leads would stretch the triangles beside them without measure, and
    contact would let them go there by small steps only. Supports that go no farther than a part, or together with
    bodies, are left to what comes after.

    Args:
        state: supports are where they are in the frame.
        bodies: of the last frame.
        last: (n, 3) the last positions [m].
    """
    problem, solver = state.problem, state.solver
    free, X = problem.boundary.free, problem.mesh.X
    way = (state.x - last) * (1.0 - free)
    edge = float(np.linalg.norm(np.diff(X[problem.mesh.edge_nodes], axis=1), axis=2).mean())
    parts = math.ceil(farthest(problem, way) / max(edge, LEAST * problem.size))
    if parts < 2 or bodies != state.bodies or solver.newton is None or not problem.begin(last):
        return state, last
    freely = (state.x - last) * free
    x = last + problem.step_share(last, freely) * freely
    newton = MixedNewton(solver, state.report)
    for part in range(1, parts + 1):
        x = _pulled(newton, x, last + part / parts * way, part == parts)
        problem.update_friction(x)
    left = farthest(problem, (state.x - x) * (1.0 - free))
    log.info(
        "Supports took the cloth along in %d parts, %d factors; %.3g m are left", parts, state.report.factors, left
    )
    if left <= ROUNDING * problem.size:
        x = problem.constrain(x)
        state = replace(state, x=x)
    return state, x


def _pulled(newton: MixedNewton, x: np.ndarray, aim: np.ndarray, ends: bool) -> np.ndarray:
    """Positions (n, 3) [m] once supports have gone to an aim (n, 3) [m], as far as nothing passes.

    Args:
        newton: steps from x (n, 3) [m].
        ends: it is the last part of the way.
    """
    problem, solver, forces = newton.problem, newton.solver, np.empty_like(x)
    for _ in range(LAST_STEPS if ends else STEPS):
        given = (aim - x) * (1.0 - problem.boundary.free)
        problem.residual(x, forces)
        norm = float(np.linalg.norm(forces)) / solver.scale(x)
        there = farthest(problem, given) <= ROUNDING * problem.size
        if there and (ends or norm <= ROUGH):
            break
        d = newton.way(x, forces, given, norm)
        if d is None:
            break
        x = newton.go(x, d)
    return x
