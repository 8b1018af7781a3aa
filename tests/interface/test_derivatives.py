"""Derivatives of quantities of a frame, beside differences of frames; and nothing of the edit changes by them."""

from pathlib import Path

import numpy as np
import pytest

import restshape

BRACKET = Path(__file__).parents[2] / "docs" / "examples" / "bracket.toml"
COARSE = ("mesh.size='30 mm'", "mesh.near.window='15 mm'", "solve.tolerance=1e-11")


@pytest.mark.parametrize("order", [1, 2])
def test_derivatives_are_those_that_frames_on_the_mesh_have(order):
    scene = restshape.load(BRACKET, *COARSE, f"mesh.order={order}")
    step, ends = 2e-5, []
    with restshape.open(scene) as sim, sim.press("window", at=[0.0, 0.0]) as hand:
        wanted = hand.to(0.0, 0.0).derivative("window")
        for place in ((step, 0), (-step, 0), (0, step), (0, -step)):
            frame = hand.to(*place)
            assert frame.row["level"] == 1
            ends.append(frame.quantities)
    assert wanted.keys() == scene.quantities.keys()
    for name, found in wanted.items():
        differences = [(ends[k][name] - ends[k + 1][name]) / (2 * step) for k in (0, 2)]
        scale = max(abs(np.array(differences)).max(), abs(ends[0][name]))
        np.testing.assert_allclose(found, differences, rtol=2e-4, atol=2e-5 * scale)
    assert abs(wanted["stress_at_window"]).max() > 1e6


def test_areas_follow_the_outline():
    scene = restshape.load(BRACKET, *COARSE, "quantities.area={area=true}", "parameters={r=0.022}")
    scene = restshape.changed(scene, "shape.holes.window.circle.radius", "r")
    with restshape.open(scene) as sim:
        by_radius, by_tip = sim.frame.derivative("parameters.r"), sim.frame.derivative("tip")
    assert by_radius["area"] == pytest.approx(-2.0 * np.pi * 0.022, rel=1e-6)
    np.testing.assert_allclose(by_tip["area"], [0.09, 0.0], atol=1e-9)


def test_derivatives_by_numbers_are_those_of_closed_forms():
    with restshape.open(restshape.load(BRACKET, *COARSE, "effects.gravity.g=[0, 0]")) as sim:
        sag = sim.frame.quantities["sag"]
        by_thickness = sim.frame.derivative("material.steel.thickness")
        by_load = sim.frame.derivative("loads.weight.force.1")
    assert by_thickness["sag"] == pytest.approx(-sag / 8e-3, rel=1e-5)
    assert by_load["sag"] == pytest.approx(sag / -2e3, rel=1e-5)
    assert by_load["wall_force"] == pytest.approx(-1.0, rel=1e-6)


def test_an_edit_goes_on_as_if_no_derivative_had_been_asked_for():
    rows = []
    for asks in (False, True):
        with restshape.open(restshape.load(BRACKET, *COARSE)) as sim, sim.press("window") as hand:
            for x in (0.0, 0.002, 0.004, 0.02):
                row = dict(hand.to(0.09 + x, 0.062).row)
                rows.append({name: repr(value) for name, value in row.items() if not name.startswith("ms")})
                if asks:
                    hand.frame.derivative("window")
    assert rows[:4] == rows[4:]


def test_what_has_no_derivative_says_so():
    names = ("door", "material.steel.name", "mesh.size", "solve.tolerance")
    whats = ("no entity named 'door'", "no number of the scene", *2 * ["the error of the mesh and the solver alone"])
    with restshape.open(restshape.load(BRACKET, *COARSE)) as sim:
        for of, what in zip(names, whats, strict=True):
            with pytest.raises(restshape.UserError, match=what):
                sim.frame.derivative(of)
