"""Seams that are wide open at first, pulled together softly: their full stiffness would tear at the cloth."""

from __future__ import annotations

import logging

import numpy as np

from restshape.physics.cloth.relaxation.equilibrium import ROUGH, EquilibriumSolver
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.seams import Seams

log = logging.getLogger("restshape.physics")

WIDE = 0.5
"""Distance across a seam, over the mean length of its edges, from which on it is pulled together."""
TENSION = 0.02
"""What the widest seam pulls with by length, over the membrane's stiffness."""
STEPS, ROUNDS = 4, 200
"""Steps of a fall before seams have another stiffness, and such rounds at most."""
STILL, PATIENCE = 0.95, 3
"""A round in which the widest seam closes by less does not get on; after so many of them in a row seams pull harder."""
LIGHT = 0.05
"""Part of the weight while seams close."""


def close_seams(solver: EquilibriumSolver, x: np.ndarray, most: int, report: ConvergenceReport) -> None:
    """Let seams that are wide open at x (n, 3), which is changed, pull the cloth together, in falls.

    Their springs are so soft that the widest one pulls with a small strain of the membrane, and stiffen as it closes.
    Nothing passes bodies or the cloth itself on the way, as on any other. Cloth is light meanwhile: panels would
    fall past what they are to be closed around. Without any weight flat cloth would stay in its plane.
    """
    seams = solver.problem.seams
    if seams and seams.gap(solver.problem.corners(x)) > WIDE * seams.edge_length:
        # A strip whose own ends are sewn together gets out of its plane by its weight.
        panels = solver.problem.mesh.cell_piece.any()
        with solver.problem.lightened(LIGHT if panels else 1.0):
            _close(solver, seams, x, most, report)


def _close(solver: EquilibriumSolver, seams: Seams, x: np.ndarray, most: int, report: ConvergenceReport) -> None:
    problem = solver.problem
    wide, gap, still, tension = WIDE * seams.edge_length, seams.gap(problem.corners(x)), 0, TENSION
    stiffest = float(seams.stiffness.max())
    for _ in range(ROUNDS):
        if gap <= wide:
            break
        problem.pull_seams(min(1.0, tension * problem.stiffest / (stiffest * gap)))
        log.info("Seams open by %.3e m: pulled with %.1e of their stiffness", gap, seams.pull)
        solver.fall(x, ROUGH, min(most, STEPS), report)
        before, gap = gap, seams.gap(problem.corners(x))
        still = still + 1 if gap > STILL * before else 0
        if still >= PATIENCE:
            tension, still = 2.0 * tension, 0
    problem.pull_seams(1.0)
