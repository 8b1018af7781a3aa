"""Positions after deformation as quantities: against closed forms of shapes and of loads, with their errors."""

import math

import numpy as np
import pytest
from cloths import PIN, write_cloth
from small_scenes import HEAD, block, make_replay, meshed, write_scene, write_script

from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.physics.elasticity.singular_places import singular_quantities
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

STEEL = '[material.m]\nE = "100 MPa"\nnu = 0.3\nthickness = 0.01\n'
ROLLERS = '[supports.a]\non = "left"\nfix = ["x"]\n[supports.b]\non = "a"\nfix = ["y"]\n'
PULL = '[loads.pull]\non = "right"\ntraction = ["10 MPa", 0]\n'
ASKED = """
[quantities]
tip = { position = "x", at = "right", error = true }
high = { position = "y", at = "c" }
lowest = { position = "y", reduce = "min" }
middle = { position = "x" }
stretch = { displacement = "x", at = "right" }
"""
DISK = """
[shape]
outline = ["lower", "upper"]
[shape.vertices]
west = [-1, 0]
east = [1, 0]
[shape.edges]
lower = { arc = ["west", "east"], bulge = 1 }
upper = { arc = ["east", "west"], bulge = 1 }
"""


@pytest.mark.parametrize("order", [1, 2])
def test_a_bar_under_tension(tmp_path, order):
    """Of a bar of 2 m x 1 m strained by 0.1: the tip at 2.2, its corner at 0.97, its middle at 1.1, exactly."""
    analysis = first_frame(
        write_scene(tmp_path, HEAD + block(2.0, 1.0) + STEEL + ROLLERS + PULL + ASKED + meshed(0.3, order))
    ).analysis
    found = analysis.observe()
    expected = {"tip": 2.2, "high": 0.97, "lowest": 0.0, "middle": 1.1, "stretch": 0.2}
    assert found == pytest.approx(expected, rel=1e-8, abs=1e-9)
    assert analysis.quantity_errors(["tip"])["tip"] <= 1e-8


def test_large_deformation_and_edits(tmp_path):
    """The position follows the shape, and the displacement under St. Venant and Kirchhoff's law, whatever it is."""
    text = HEAD + block(2.0, 1.0) + STEEL + ROLLERS + PULL + "[effects.large_deformation]\n" + meshed(0.4)
    text += '[quantities]\ntip = { position = "x", at = "c" }\nu = { displacement = "x", at = "c" }\n'
    drag = [{"do": "press", "on": "right", "at": [2, 0]}, {"do": "drag", "to": [2.5, 0]}, {"do": "release"}]
    script = write_script(tmp_path, [{"t": 0.1 * k, **event} for k, event in enumerate(drag)])
    rows = list(make_replay(write_scene(tmp_path, text), script).frames())
    assert [row["q_tip"] - row["q_u"] for row in rows] == pytest.approx([2.0, 2.0, 2.5, 2.5], abs=1e-12)
    assert rows[0]["q_u"] > 0.01


def test_the_error_of_a_mean_over_an_arc_is_that_of_its_chords(tmp_path):
    """Of half a circle of radius 1 the mean height is 2/pi, which chords of first order miss under any load."""
    text = HEAD + DISK + STEEL + '[supports.a]\non = ["west", "east"]\nfix = ["x", "y"]\n'
    text += '[loads.down]\non = "upper"\ntraction = [0, "-1 Pa"]\n'
    text += '[quantities]\nmean = { position = "y", at = "upper", error = true }\n'
    analysis = first_frame(write_scene(tmp_path, text + meshed(0.4))).analysis
    true = abs(analysis.observe()["mean"] - 2.0 / math.pi)
    assert true > 1e-4
    assert analysis.quantity_errors(["mean"])["mean"] == pytest.approx(true, rel=0.02)


def test_a_position_at_a_point_load_has_no_limit(tmp_path):
    text = HEAD + block(2.0, 1.0) + STEEL + '[supports.left]\non = "left"\nfix = ["x", "y"]\n'
    text += '[loads.poke]\non = "c"\nforce = [0, "-1 kN"]\n'
    text += '[quantities]\npoked = { position = "y", at = "c" }\nfree = { position = "y", at = "b" }\n'
    scene = load_scene(write_scene(tmp_path, text + meshed(0.3)))
    assert set(singular_quantities(scene, outline_from_spec(scene.shape, scene.folder))) == {"poked"}


@pytest.mark.parametrize("how", ["sum", "absmax", "peak"])
def test_sizes_and_sums_of_positions_are_refused(tmp_path, how):
    text = HEAD + block() + STEEL + f'[quantities]\ntip = {{ position = "x", reduce = "{how}" }}\n'
    with pytest.raises(UserError, match=f"is reduced by .* not by '{how}'"):
        load_scene(write_scene(tmp_path, text + meshed(0.3)))


def test_cloth_is_where_its_supports_and_its_start_put_it(tmp_path):
    """A clamped square turned by a quarter about x through the origin, moved up: y becomes height."""
    start = '[start]\nturn = ["90 deg", 0, 0]\nmove = [0.1, 0.2, 1]\n'
    text = '[supports.rim]\non = "outline"\nfix = { x = 0, y = 0, z = "5 cm" }\n' + start
    text += '[quantities]\nx = { position = "x", at = "c" }\ny = { position = "y", at = "c" }\n'
    text += 'z = { position = "z", at = "c" }\nside = { position = "z", at = "right" }\n'
    text += 'u = { displacement = "z", at = "c" }\nlow = { position = "z", at = "outline", reduce = "min" }\n'
    analysis = first_frame(write_cloth(tmp_path, text)).analysis
    expected = {"x": 1.1, "y": 0.2, "z": 2.05, "side": 1.55, "u": 2.05, "low": 1.05}
    assert analysis.observe() == pytest.approx(expected, abs=1e-12)


def test_cloth_hangs_at_positions_that_are_pattern_and_displacement(tmp_path):
    other = PIN.replace("supports.pin", "supports.other").replace('"a"', '"d"')
    text = '[quantities]\nplace = { position = "x", at = "c" }\nu = { displacement = "x", at = "c" }\n'
    text += 'most = { position = "x", reduce = "max" }\n'
    analysis = first_frame(write_cloth(tmp_path, PIN, other, text)).analysis
    found, x = analysis.observe(), analysis.problem.corners(analysis.x)
    assert found["place"] == pytest.approx(1.0 + found["u"], abs=1e-14) and found["most"] == np.max(x[:, 0])
