"""Corners and balls that bear much stay out of the cloth, measured over triangles by samples of their own."""

import numpy as np
import pytest
from restshape_studies.stability.case import Trial
from restshape_verification.couture.drapes import ball, box, fabric, scene, sheet, start
from restshape_verification.couture.hard_scenes import SAMPLES, played

from restshape.physics.cloth.contact.contact_points import lattice

THICKNESS = 2e-3
"""Of contact, by default."""
CORNER = box("table", (-0.4, -0.3, -0.372), (0.4, 0.3, 0.37), rounded=0.005)
OVER = start(("0 deg", "0 deg", "45 deg"), (-0.05, -0.05, 0))


@pytest.mark.slow
@pytest.mark.parametrize(
    "parts",
    [
        (sheet(-0.35, -0.35, 0.35, 0.35), CORNER, OVER),
        (sheet(-0.35, -0.35, 0.35, 0.35), ball("ball", (0, 0, -0.142), 0.14)),
    ],
    ids=["corner", "ball"],
)
def test_bodies_stay_out_of_triangles_by_a_margin(tmp_path, parts):
    """Half of the thickness is what counts as inside: a fifth of that is left."""
    made, (row,) = played(Trial(tmp_path), scene("silk", 0.03, fabric("silk"), *parts))
    problem, (body,) = made.analysis.problem, made.analysis.problem.contact.bodies
    x = problem.corners(made.analysis.x)
    samples = np.einsum("pk,eka->epa", lattice(SAMPLES)[0], x[problem.mesh.cells]).reshape(-1, 3)
    depth = -min(body.distances(samples).min(), body.distances(x).min())
    assert row["converged"] and not row["untrusted"]
    assert depth == pytest.approx(row["max_penetration"], abs=0.05 * THICKNESS)
    assert depth < 0.4 * THICKNESS
