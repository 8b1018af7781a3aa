"""Folded cloth whose material moves: nodes that would cross it along with their material begin where they were."""

import json

import numpy as np
import pytest
from petsc4py import PETSc
from small_scenes import head

from restshape.application import application
from restshape.calibration import Calibration
from restshape.physics.cloth.relaxation import binding
from restshape.physics.cloth.relaxation.frame_way import FrameWay
from restshape.physics.cloth.relaxation.mixed_newton import MixedNewton
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

SKIRT = f"""
{head("cloth")}[shape]
outline = ["lower", "upper"]
[shape.vertices]
west = [-0.61, 0]
east = [0.61, 0]
[shape.edges]
lower = {{ arc = ["west", "east"], bulge = 1 }}
upper = {{ arc = ["east", "west"], bulge = 1 }}
[shape.holes]
waist = {{ circle = {{ center = [0, 0], radius = 0.111 }} }}
[material.viscose]
E = "0.5 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.3 mm"
bending = "5e-6 N m"
[supports.band]
on = "waist"
fix = ["x", "y", "z"]
[effects.gravity]
[mesh]
size = "90 mm"
"""
"""A skirt that hangs from its waist in some ten folds."""
HIPS = """
[bodies.hips]
sphere = { center = [0, 0, -0.18], radius = 0.16 }
friction = 0.3
[effects.contact]
self_friction = 0.2
"""
LARGER = {"t": 0.1, "do": "scale", "on": "outline", "factor": 1.06, "frames": 2}


def rests(folder, edits, text=SKIRT):
    """The state and its energy after the first frame and after each of the edits."""
    path, found = folder / "skirt.toml", []
    path.write_text(text)
    scene = load_scene(path)
    first = {"format": "restshape-edits", "version": 1, "scene": "skirt.toml", "units": "m"}
    script = folder / "edits.jsonl"
    script.write_text("\n".join(json.dumps(line) for line in (first, *edits)))
    request = Request(scene, load_script(script, scene), application("cloth"), policy("auto"), Calibration.load())
    replay = Replay(request, PETSc.COMM_SELF)
    for _ in replay.frames():
        state = replay.analysis.state
        found.append((state, state.problem.energy(state.x)))
    return found


@pytest.mark.slow
def test_a_skirt_that_gets_larger_rests_in_few_steps_where_descents_rest_too(tmp_path, monkeypatch):
    found, usual = rests(tmp_path, [LARGER]), binding.drag_frame
    monkeypatch.setattr(binding, "drag_frame", lambda state, _: (state, False))
    others = rests(tmp_path, [LARGER])
    monkeypatch.setattr(binding, "drag_frame", usual)
    for (state, energy), (other, expected) in zip(found[1:], others[1:], strict=True):
        report = state.report
        assert report.converged and report.stable
        assert report.steps == report.newton <= 8 and report.factors <= 8
        assert other.report.steps > 40
        assert energy == pytest.approx(expected, rel=1e-7)
        assert state.x == pytest.approx(other.x, abs=1e-4)
        assert not len(state.problem.surface.crossed(state.problem.corners(state.x)))


@pytest.mark.slow
def test_friction_begins_as_it_was_at_the_rest_and_follows_the_material(tmp_path):
    ((state, _),) = rests(tmp_path, [], SKIRT + HIPS)
    problem = state.problem
    contact, own = problem.contact, problem.self_contact
    history, layers = contact.history, own.history
    slid = np.random.default_rng(3).uniform(-1e-2, 1e-2, state.x.shape)
    way = FrameWay(problem, state.bodies, state.bodies, slid)
    assert way.moves and way.slides
    for share in (0.0, 0.25):
        way.place(share)
        left = (1.0 - share) * problem.corners(slid)
        for anchors, before in zip(contact.history.anchors, history.anchors, strict=True):
            assert anchors == pytest.approx(before - contact.place(left), abs=1e-15)
        assert own.history.places == pytest.approx(layers.places - left, abs=1e-15)
    way.place(1.0)
    assert contact.history.anchors == pytest.approx(history.anchors, abs=1e-15)
    assert own.history.places == pytest.approx(layers.places, abs=1e-15)


@pytest.mark.slow
def test_descents_go_on_from_the_least_energy_of_newtons_steps(tmp_path):
    ((state, _),) = rests(tmp_path, [])
    problem, solver = state.problem, state.solver
    seen = []
    solver.on_iterate = lambda _, x, norm: seen.append((problem.energy(x), norm))
    apart = 0
    for seed in range(8):
        seen.clear()
        x = state.x + np.random.default_rng(seed).normal(0.0, 1e-3, state.x.shape) * problem.boundary.free
        found, _ = MixedNewton(solver, ConvergenceReport()).converge(x, 12)
        energies, norms = np.array(seen).T
        assert problem.energy(found) == energies.min()
        apart += int(energies.argmin() != norms.argmin())
    assert apart
