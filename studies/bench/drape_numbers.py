"""How a drape follows each number of its scene: the derivative, and its Taylor remainder in each state of friction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from restshape.analysis.frame import Frame
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.sensitivity.drape_derivative import DrapeDerivative
from restshape.physics.cloth.sensitivity.pattern_numbers import pattern_motion
from restshape.physics.cloth.sensitivity.scene_numbers import ChangingNumber, number_keys

MOTION = 1e-5
"""Of the node that moves farthest, by the derivative, over the size of the cloth: the first of two steps."""
LARGEST = 1e-3
"""Of a step, over the number."""
SEEN = 1e-6
"""Of what a step does, over the size of the cloth and the step in parts of the number, or 1: less is nothing."""
EXACT = 5e-6
"""Remainder over the derivative times the step below which it is that of rests and solves."""
STATES = ("sticks", "slides", "free")


def number_remainders(analysis: RelaxationAnalysis, asked: Sequence[str], tolerance: float) -> dict[str, Any]:
    """What is found of numbers of a scene at a rest.

    Args:
        analysis: at rest.
        asked: keys; none: all numbers of the scene that drapes have derivatives by.
        tolerance: of derivatives.

    Raises:
        UserError: a number that was asked for has no derivative.

    Returns: rows: by key value; motion: of the corner that moves farthest [m a SI unit]; step; remainders (2,) of a
        step and of half of it over the derivative times the step, None where there is no rest; order, and orders by
        state of the corners: None where there is no remainder to be seen; idle: numbers that nothing follows;
        left_out: why, by key.
    """
    state = analysis.state
    rows, idle, left_out = [], [], {}
    for key in asked or number_keys(state.scene, state.plan):
        try:
            found = analysis.number_derivatives([key], tolerance)
            number = ChangingNumber(state.scene, state.plan, key)
            row = _row(analysis, number, found)
        except (UserError, ReplayProblem) as problem:
            if asked:
                raise
            left_out[key] = problem.what if isinstance(problem, UserError) else str(problem)
            continue
        if row:
            rows.append(row)
        else:
            idle.append(key)
    return {"rows": rows, "idle": idle, "left_out": left_out}


def _row(analysis: RelaxationAnalysis, number: ChangingNumber, found: DrapeDerivative) -> dict[str, Any]:
    """What is found of one number; nothing where the drape does not follow it."""
    problem, s = analysis.problem, found.s[0]
    motion = float(np.linalg.norm(problem.corners(s), axis=1).max())
    if motion * (abs(number.value) or 1.0) < SEEN * problem.size:
        return {}
    step = MOTION * problem.size / motion
    step = min(step, LARGEST * abs(number.value)) if number.value else step
    kept, x, lost = analysis.kept_answer(), analysis.x.copy(), []
    for h in (step, 0.5 * step):
        rest = _rest(analysis, kept, number, h)
        lost.append(None if rest is None else problem.corners(rest - x - h * s))
    size, everywhere = np.linalg.norm(problem.corners(s)), np.ones(len(found.states), dtype=bool)
    return {
        "key": number.key,
        "value": number.value,
        "motion": motion,
        "step": step,
        "remainders": [
            None if one is None else float(np.linalg.norm(one) / (h * size)) for one, h in zip(lost, (step, 0.5 * step))
        ],
        "order": _order(lost, everywhere, EXACT * step * size),
        "orders": {name: _order(lost, found.states == k, EXACT * step * size) for k, name in enumerate(STATES)},
    }


def _rest(analysis: RelaxationAnalysis, kept: Any, number: ChangingNumber, step: float) -> np.ndarray | None:
    """The unknowns (n, 3) at rest with a number larger by a step, from the same anchors; None: it does not rest."""
    mesh, scene = analysis.space, number.scene
    none, X = np.empty(0, dtype=np.int32), mesh.X.copy()
    moved = pattern_motion(mesh, number)
    _lie(mesh, X if moved is None else X + step * moved)
    analysis.solve(Frame(mesh, none, None, number.scene_with(number.value + step), (None, (0.0, 0.0))))
    found = analysis.x.copy() if analysis.state.report.converged else None
    _lie(mesh, X)
    analysis.restore(kept, Frame(mesh, none, None, scene, (None, (0.0, 0.0))))
    return found


def _lie(mesh: Mesh, X: np.ndarray) -> None:
    """Let the nodes of a mesh lie at X (n, 2) in the material [m]."""
    if not np.array_equal(mesh.X, X):
        mesh.X[...] = X
        mesh.geometry += 1


def _order(lost: Sequence[np.ndarray | None], there: np.ndarray, least: float) -> float | None:
    """The order of a remainder in some corners, from a step and half of it; None where it cannot be seen.

    Args:
        lost: (corners, 3) of each [m]; None: there is no rest.
        there: (corners,) which of them; least: norm of the remainder that can be seen [m].
    """
    if any(one is None for one in lost) or not there.any():
        return None
    first, second = (float(np.linalg.norm(one[there])) for one in lost)
    return float(np.log2(first / second)) if second > 0.25 * least else None
