"""Seams that are wide open at first, pulled together softly: their full stiffness would tear at the cloth."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from contextlib import nullcontext

import numpy as np

from restshape.physics.cloth.relaxation.equilibrium import ROUGH, EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.seams.seams import Seams
from restshape.scene.model import Scene
from restshape.scene.seam_keys import Seam

log = logging.getLogger("restshape.physics")

WIDE = 0.5
"""Distance across a seam, over the mean length of its edges, from which on it is pulled together."""
TENSION = 0.02
"""What the widest seam pulls with by length, over the membrane's stiffness."""
STEPS, ROUNDS = 4, 200
"""Steps of a fall before seams have another stiffness, and such rounds at most."""
STILL, PATIENCE = 0.95, 3
"""A round in which the widest seam closes by less does not get on; after so many of them in a row seams pull harder."""
STUCK = 1e-5
"""A round that moves nothing farther, over the cloth's size, though it is far from rest, leads nowhere."""
LIGHT = 0.05
"""Part of the weight while seams close."""
FAR, THICK = 0.25, 0.03
"""A sheet whose own edges are farther apart than that share of its size bends meanwhile like a plate whose thickness is
such a share of it: limp cloth would crumple in its plane, and catch on itself, before it bends to a tube."""


Gaps = Mapping[str, tuple[Seam, float]]
"""Seams as a scene has them, by name, each with the largest distance across it [m]."""


def gaps_at(seams: Seams | None, corners: np.ndarray, scene: Scene) -> Gaps:
    """The seams of a scene, each with its gap at positions (n, 3) [m] of the mesh's nodes."""
    if not seams:
        return {}
    gaps = seams.gaps(corners)
    return {name: (scene.seams[name], float(gaps[own].max())) for name, own in seams.springs_by_name()}


def has_opened(solver: EquilibriumSolver, x: np.ndarray, scene: Scene, known: Gaps) -> bool:
    """Whether a seam is wide open at x (n, 3) that was not, or not so wide, or another one, at the last rest."""
    seams = solver.problem.seams
    if not seams:
        return False
    wide = WIDE * seams.edge_length
    for name, (seam, gap) in gaps_at(seams, solver.problem.corners(x), scene).items():
        before, width = known.get(name, (None, 0.0))
        if gap > wide and (seam != before or STILL * gap > width):
            return True
    return False


def close_seams(solver: EquilibriumSolver, x: np.ndarray, most: int, report: ConvergenceReport) -> None:
    """Let seams that are wide open at x (n, 3), which is changed, pull the cloth together, in falls.

    Their springs are so soft that the widest one pulls with a small strain of the membrane, and stiffen as it closes.
    Nothing passes bodies or the cloth itself on the way, as on any other. Cloth is light meanwhile: panels would
    fall past what they are to be closed around. Without any weight flat cloth would stay in its plane.
    Seams that something holds open are given up once they pull with all of their stiffness; cloth that goes nowhere,
    though it is far from rest, after `PATIENCE` rounds.
    """
    seams = solver.problem.seams
    gap = seams.gap(solver.problem.corners(x)) if seams else 0.0
    if seams and gap > WIDE * seams.edge_length:
        # A strip whose own ends are sewn together gets out of its plane by its weight.
        problem, panels = solver.problem, solver.problem.mesh.cell_piece.any()
        rolled = not panels and gap > FAR * problem.size
        stiff = problem.stiffened(THICK) if rolled else nullcontext()
        with problem.lightened(LIGHT if panels else 1.0), stiff:
            _close(solver, seams, x, most, report)


def _close(solver: EquilibriumSolver, seams: Seams, x: np.ndarray, most: int, report: ConvergenceReport) -> None:
    problem = solver.problem
    wide, gap, tension = WIDE * seams.edge_length, seams.gap(problem.corners(x)), TENSION
    still = caught = 0
    stiffest = float(seams.stiffness.max())
    try:
        for _ in range(ROUNDS):
            if gap <= wide or report.falls or (still >= PATIENCE and seams.pull == 1.0):
                break
            if still >= PATIENCE:
                tension, still = 2.0 * tension, 0
            problem.pull_seams(min(1.0, tension * problem.stiffest / (stiffest * gap)))
            log.info("Seams open by %.3e m: pulled with %.1e of their stiffness", gap, seams.pull)
            places = x.copy()
            solver.fall(x, ROUGH, min(most, STEPS), report)
            stuck = report.residual > ROUGH and np.abs(x - places).max() <= STUCK * problem.size
            caught = caught + 1 if stuck else 0
            if caught >= PATIENCE:
                break
            before, gap = gap, seams.gap(problem.corners(x))
            still = still + 1 if gap > STILL * before else 0
    finally:
        problem.pull_seams(1.0)
