"""Cloth that falls from a cold start keeps all of its stiffness: it hangs flat, and rests on what it cannot pass."""

import numpy as np

from restshape.application import application
from restshape.interface.first_frame import first_frame

SCENES = application("couture").folder / "scenes"


def test_a_strip_that_hangs_from_its_top_is_flat():
    analysis = first_frame(SCENES / "hanging.toml").analysis
    report = analysis.state.report
    assert report.converged and report.stable and report.softness == 1.0
    assert np.abs(analysis.problem.corners(analysis.x)[:, 2]).max() < 1e-9
    assert report.steps < 20


def test_cloth_on_a_body_falls_without_being_softened():
    coarse = ['mesh.size="60 mm"', "mesh.levels=1", "effects.cloth.bending=hinge"]
    analysis = first_frame(SCENES / "sphere.toml", coarse).analysis
    assert analysis.state.report.converged
    assert analysis.state.softness == 1.0
    assert analysis.row()["max_strain"] < 0.05
