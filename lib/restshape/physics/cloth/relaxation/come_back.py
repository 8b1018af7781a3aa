"""Half-spaces that have left cloth at its cold start come back to their places, and the cloth makes way for them."""

from __future__ import annotations

import logging
import math

import numpy as np

from restshape.algebra.nonlinear.descent import MEMORY
from restshape.physics.cloth.relaxation.equilibrium import ROUGH, EquilibriumSolver
from restshape.physics.cloth.relaxation.follow_bodies import ROUNDS, take_along
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.physics.cloth.retreat import shifted
from restshape.physics.cloth.scene import kernel_body
from restshape.scene.bodies import Body

log = logging.getLogger("restshape.physics")

MOST_PARTS = 100
"""Parts of the way back at most."""
LAST_ROUNDS = 30
"""Tangents of the descent after the last part: a fall from there would take more steps, to higher energies."""


def come_back(
    solver: EquilibriumSolver,
    x: np.ndarray,
    forms: tuple[Body, ...],
    retreat: np.ndarray,
    most: int,
    report: ConvergenceReport,
) -> None:
    """Bring bodies to their places from where they have left cloth at x (n, 3), which is changed.

    In each part of the way they go as far as an edge of the mesh is long, and the cloth goes roughly to rest.

    Args:
        forms: of numbers, at their places; retreat: (k, 3) [m] how far each is from there.
        most: steps of each descent; report: counts them.
    """
    contact, mesh = solver.problem.contact, solver.problem.mesh
    length = float(np.linalg.norm(np.diff(mesh.X[mesh.edge_nodes], axis=1), axis=2).mean())
    parts = min(MOST_PARTS, math.ceil(float(np.linalg.norm(retreat, axis=1).max()) / length))
    last = None
    try:
        for part in range(parts + 1):
            left = 1.0 - part / parts
            now = tuple(shifted(body, left * way) for body, way in zip(forms, retreat)) if left else forms
            contact.history = take_along(contact.history, last or now, now)
            contact.bodies, last = [kernel_body(body) for body in now], now
            solver.descend(x, ROUGH, min(most, (ROUNDS if left else LAST_ROUNDS) * MEMORY), report)
    finally:
        contact.bodies = [kernel_body(body) for body in forms]
    log.info("Bodies came to their places in %d parts, %d steps", parts, report.steps)
