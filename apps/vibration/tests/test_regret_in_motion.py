"""Counted work of a motion with new meshes, beside the best schedule of refreshes."""

import json

import pytest
from petsc4py import PETSc
from small_scenes import across, drag, write_scene, write_script

pytestmark = pytest.mark.skipif(PETSc.COMM_WORLD.size > 1, reason="one rank")
MAST = """
format = "restshape-scene"
version = 1
app = "vibration"
[shape]
outline = ["foot", "right", "tip", "left"]
vertices = { a = [0, 0], b = [0.06, 0], c = [0.05, 0.4], d = [0.01, 0.4] }
holes = { bore = { circle = { center = [0.03, 0.15], radius = 0.01 } } }
[shape.edges]
foot = { line = ["a", "b"] }
right = { line = ["b", "c"] }
tip = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[material.polymer]
E = "3 GPa"
nu = 0.35
rho = 1150
thickness = 0.01
[effects]
solid = { model = "plane_stress" }
dynamics = { time_step = 5e-4, steps = 5 }
ground = { frequency = 50, acceleration = 5 }
[supports.foot]
on = "foot"
fix = ["x", "y"]
[mesh]
size = 0.02
"""
MODES = """[effects.modal]
modes = 2
[quantities]
first = { frequency = 1 }
"""


def test_new_meshes_in_motion_begin_a_schedule(tmp_path, command):
    """The first step on a new mesh applies a factor that was made for all steps of the frame."""
    scene = write_scene(tmp_path, MAST)
    script = write_script(tmp_path, drag("bore", (0.03, 0.15), across((0.03, 0.15), (0.03, 0.32), 6)))
    done = command("replay", scene, script, "--regret", "--json", "a.json")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())["regret"]
    schedule, refactor = found["hindsight"], found["policies"]["refactor"]
    # A factor a matrix, and five steps a frame, of which each applies it once: the first frame has none.
    assert refactor["factors"] == schedule["matrices"] and refactor["iterations"] % 5 == 0
    assert schedule["run"] >= schedule["best"] * (1 - 1e-9)


@pytest.mark.slow
def test_modes_beside_a_motion_are_none_of_its_work(tmp_path, command):
    """The same motion with its modes and without: factors, iterations and seconds of its steps are the same."""
    found = []
    script = write_script(tmp_path, drag("bore", (0.03, 0.15), across((0.03, 0.15), (0.03, 0.2), 3)))
    for text in (MAST, MAST + MODES):
        scene = write_scene(tmp_path, text)
        done = command("replay", scene, script, "--regret", "--json", "a.json")
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / "a.json").read_text())["regret"])
    alone, beside = found
    assert beside["policies"] == alone["policies"] and beside["hindsight"] == alone["hindsight"]
