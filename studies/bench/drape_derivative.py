"""Both derivatives of a drape along a hand on its pattern: their time, their residuals, and their Taylor remainders."""

from __future__ import annotations

from dataclasses import replace
from time import perf_counter
from typing import Any

import numpy as np
from petsc4py import PETSc

from restshape.analysis.frame import Frame
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.relocate import BoundaryNodes, motion
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.load import revise
from restshape.scene.model import Scene

REST, TOLERANCE = 1e-9, 1e-6
"""Tolerance of the drapes whose remainders are looked at, and of derivatives."""
STEPS = (1e-5, 5e-6, 2.5e-6)
"""Of the hand, in sizes of the cloth: below the way at which friction is all there."""
TIMES = 9


def is_drape(scene: Scene) -> bool:
    """Whether a scene's answers are drapes."""
    return "drape" in scene.effects or "cloth" in scene.effects


def measure_drape(request: Request) -> dict[str, Any]:
    """What is found of the scene's first rest, when the second edge of its outline is taken hold of.

    Args:
        request: of cloth.

    Raises:
        UserError: its first shape has no derivative.

    Returns: nodes, unknowns; ms: least and median time of both derivatives, with their factor at hand; residuals (2,)
        by the elements, iterations, places that stick and slide, note; edge; steps (of the size of the cloth);
        remainders (2, steps) over the way of the nodes that the derivative tells, None where there is no rest.
    """
    own = request.scene.raw.get("effects", {}).get("drape", {})
    scene = revise(request.scene, "effects.drape.tolerance" if "tolerance" in own else "solve.tolerance", REST)
    replay = Replay(replace(request, scene=scene), PETSc.COMM_WORLD)
    next(replay.frames())
    analysis, mesh = replay.analysis, replay.analysis.space
    edge = scene.shape.outline[1]
    motions = _motions(mesh, edge)
    try:
        found, times = analysis.derivative(motions, TOLERANCE), []
        for _ in range(TIMES):
            start = perf_counter()
            analysis.derivative(motions, TOLERANCE)
            times.append(1e3 * (perf_counter() - start))
        exact = analysis.derivative(motions, 1e-3 * TOLERANCE)
    except ReplayProblem as problem:
        raise UserError(str(problem), str(request.scene.path), "let it come to rest") from problem
    size = analysis.problem.size
    return {
        "drape": True,
        "nodes": len(mesh.X),
        "unknowns": int(analysis.x.size),
        "ms": {"least": min(times), "median": float(np.median(times))},
        "residuals": found.residuals.tolist(),
        "iterations": found.iterations,
        "sticking": found.sticking,
        "sliding": found.sliding,
        "note": found.note,
        "edge": edge,
        "steps": list(STEPS),
        "remainders": _remainders(analysis, scene, motions, exact.s, size),
    }


def _motions(mesh: Mesh, edge: str) -> np.ndarray:
    """Velocities (2, n, 2) of the nodes when an edge of the outline moves along x, and along y."""
    outline = mesh.outline
    ends = next(one for one in outline.edges if one.name == edge)
    basis = np.zeros((2, len(outline.points), 2))
    for axis in range(2):
        basis[axis, [ends.start, *ends.inner, ends.end], axis] = 1.0
    return motion(mesh, BoundaryNodes(mesh).basis(outline, basis), "harmonic")


def _remainders(
    analysis: RelaxationAnalysis, scene: Scene, motions: np.ndarray, derivatives: np.ndarray, size: float
) -> list[list[float | None]]:
    """Remainders (2, steps) of steps of the hand, each from the same rest and anchors."""
    mesh, kept = analysis.space, analysis.kept_answer()
    X, x = mesh.X.copy(), analysis.x.copy()
    frame = Frame(mesh, np.empty(0, dtype=np.int32), None, scene, (None, (0.0, 0.0)))
    found: list[list[float | None]] = []
    for way, s in zip(motions, derivatives):
        found.append([])
        for step in STEPS:
            h = step * size
            mesh.X[...], mesh.geometry = X + h * way, mesh.geometry + 1
            analysis.solve(frame)
            rests = analysis.state.report.converged
            left = np.linalg.norm(analysis.x - x - h * s) / np.linalg.norm(h * s)
            found[-1].append(float(left) if rests else None)
            mesh.X[...], mesh.geometry = X, mesh.geometry + 1
            analysis.restore(kept, frame)
    return found
