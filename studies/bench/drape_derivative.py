"""Both derivatives of a drape along a hand on its pattern: their time, their residuals, and their Taylor remainders."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import perf_counter, process_time
from typing import Any

import numpy as np
from restshape_studies.bench.drape_numbers import number_remainders

from restshape.analysis.frame import Frame
from restshape.application import application_of
from restshape.errors import ReplayProblem, UserError
from restshape.interface.run import Run
from restshape.mesh.mesh import Mesh
from restshape.mesh.relocate import BoundaryNodes, motion
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis
from restshape.physics.cloth.sensitivity.agreed_contact import FREE
from restshape.replay.request import Request
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.plan import plan

REST, TOLERANCE = 1e-9, 1e-6
"""Tolerance of the drapes whose remainders are looked at, and of derivatives."""
STEPS = (1e-5, 5e-6, 2.5e-6)
"""Of the hand, in sizes of the cloth: below the way at which friction is all there."""
TIMES = 9
HAND = "hand"
"""Among numbers, the one that edits the pattern."""


def is_drape(scene: Scene) -> bool:
    """Whether a scene's answers are drapes."""
    return plan(scene, application_of(scene)).on("drape")


def measure_drape(request: Request, by: Sequence[str] = (), only_times: bool = False) -> dict[str, Any]:
    """What is found of the scene's first rest, by numbers, and when the second edge of its (first) outline is grabbed.

    Args:
        request: of cloth.
        by: keys of numbers, or "hand"; none: the hand and all numbers that drapes have derivatives by.
        only_times: without remainders, at the tolerance of the scene.

    Raises:
        UserError: its first shape has no derivative, or none by a number that was asked for.

    Returns: nodes, unknowns, size [m]; ms: least and median time of both derivatives, with their factor at hand, and
        the least of the processor; residuals (2,) by the elements, iterations, places that stick and slide, nodes that
        are free, note; edge; steps (of the size of the cloth); remainders (2, steps) over the derivative times a step,
        None where there is no rest; empty where they were not asked for; numbers: as of `number_remainders`.
    """
    scene = request.scene if only_times else _resting(request.scene)
    run = Run(replace(request, scene=scene), summed=False)
    next(run)
    analysis = run.replay.analysis
    mesh = analysis.space
    edge = mesh.outline.edges[mesh.outline.loops[0].edges[1][0]].name
    motions = _motions(mesh, edge)
    try:
        found, times, used = analysis.derivative(motions, TOLERANCE), [], []
        for _ in range(TIMES):
            start, begun = perf_counter(), process_time()
            analysis.derivative(motions, TOLERANCE)
            times.append(1e3 * (perf_counter() - start))
            used.append(1e3 * (process_time() - begun))
    except ReplayProblem as problem:
        raise UserError(str(problem), str(request.scene.path), "let it come to rest") from problem
    hand, keys = not only_times and (not by or HAND in by), [key for key in by if key != HAND]
    numbers = None
    if not only_times and (keys or not by):
        numbers = number_remainders(analysis, keys, 1e-3 * TOLERANCE)
    return {
        "drape": True,
        "size": analysis.problem.size,
        "nodes": len(mesh.X),
        "unknowns": int(analysis.x.size),
        "ms": {"least": min(times), "median": float(np.median(times)), "processor": min(used)},
        "residuals": found.residuals.tolist(),
        "iterations": found.iterations,
        "sticking": found.sticking,
        "sliding": found.sliding,
        "free": int((found.states == FREE).sum()),
        "note": found.note,
        "edge": edge,
        "steps": list(STEPS),
        "remainders": _remainders(analysis, scene, motions) if hand else [],
        "numbers": numbers,
    }


def _resting(scene: Scene) -> Scene:
    """The scene at rest as exactly as remainders ask for."""
    own = scene.raw.get("effects", {}).get("drape", {})
    return revise(scene, "effects.drape.tolerance" if "tolerance" in own else "solve.tolerance", REST)


def _motions(mesh: Mesh, edge: str) -> np.ndarray:
    """Velocities (2, n, 2) of the nodes when an edge of the outline moves along x, and along y."""
    outline = mesh.outline
    ends = next(one for one in outline.edges if one.name == edge)
    basis = np.zeros((2, len(outline.points), 2))
    for axis in range(2):
        basis[axis, [ends.start, *ends.inner, ends.end], axis] = 1.0
    return motion(mesh, BoundaryNodes(mesh).basis(outline, basis), "harmonic")


def _remainders(analysis: RelaxationAnalysis, scene: Scene, motions: np.ndarray) -> list[list[float | None]]:
    """Remainders (2, steps) of steps of the hand, each from the same rest and anchors."""
    mesh, kept, size = analysis.space, analysis.kept_answer(), analysis.problem.size
    derivatives = analysis.derivative(motions, 1e-3 * TOLERANCE).s
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
