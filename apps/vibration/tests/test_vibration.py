"""The application `vibration`: what its scenes may say, and its shipped scenes, shortened."""

import json
from pathlib import Path

import numpy as np
import pytest
from restshape_verification.vibration.thesis import MESH
from small_scenes import across, drag, make_replay, rows_of, write_script
from vibrating import dynamics, textbook_newmark, tower

from restshape.application import application
from restshape.errors import UserError
from restshape.fem.time_integration import Rayleigh
from restshape.physics.elasticity.base_excitation import HarmonicExcitation
from restshape.scene.load import load_scene

FOLDER = application("vibration").folder
BUILDING = FOLDER / "scenes" / "building.toml"


def settings(folder: Path, name: str, text: str):
    """The settings of an effect from the text of its table."""
    scene = load_scene(tower(folder, f"\n[effects.{name}]\n{text}\n", dynamics()))
    return application("vibration").effects[name].model.model_validate(scene.effects[name])


def test_ratio_is_met_at_both_frequencies(tmp_path):
    damping = Rayleigh.of(settings(tmp_path, "damping", 'ratio = "3 %"\nfrequencies = ["2 Hz", 11]'))
    for frequency in (2.0, 11.0):
        omega = 2 * np.pi * frequency
        assert damping.alpha / (2 * omega) + damping.beta * omega / 2 == pytest.approx(0.03)


def test_ground_accelerates_as_its_displacement_says(tmp_path):
    """The acceleration is the second derivative of -+ d sin(w t), here by central differences of d sin(w t)."""
    ground = HarmonicExcitation(
        settings(tmp_path, "ground", 'displacement = "2 mm"\nfrequency = 3\ndirection = [0, 5]')
    )
    omega, h, t = 6 * np.pi, 1e-4, 0.07
    place = [2e-3 * np.sin(omega * (t + k * h)) for k in (-1, 0, 1)]
    assert ground.acceleration(t) == pytest.approx([0, (place[0] - 2 * place[1] + place[2]) / h**2], rel=1e-5)


@pytest.mark.parametrize(
    ("name", "text", "says"),
    [
        ("damping", "ratio = 0.02", "ratio with two frequencies"),
        ("damping", "ratio = 0.02\nfrequencies = [1, 2]\nalpha = 1", "ratio with two frequencies"),
        ("ground", "frequency = 2", "exactly one of displacement, acceleration"),
        ("ground", 'frequency = "2 s"\ndisplacement = 1', "frequency"),
        ("ground", "frequency = 2\ndisplacement = 1\ndirection = [0, 0]", "direction"),
        ("damping", "ratio = -0.1\nfrequencies = [1, 2]", "ratio"),
    ],
)
def test_effects_that_make_no_sense_are_refused(tmp_path, name, text, says):
    with pytest.raises(UserError, match=says):
        load_scene(tower(tmp_path, f"\n[effects.{name}]\n{text}\n", dynamics()))


def test_a_body_without_density_is_refused(tmp_path):
    with pytest.raises(UserError, match="without density"):
        rows_of(make_replay(tower(tmp_path, dynamics()), overrides=["material.rubber.rho=0"]))


def test_a_solid_at_rest_has_no_kinetic_energy(tmp_path):
    scene = tower(tmp_path, "\n[solve]\n")
    scene.write_text(scene.read_text().replace('app = "moving"', 'app = "plane"'))
    with pytest.raises(UserError, match="static equilibrium"):
        rows_of(make_replay(scene))


def test_building_is_the_size_of_the_thesis():
    (row,) = rows_of(make_replay(BUILDING, overrides=MESH))
    assert abs(row["elements"] - 1960) < 60


def test_building_shakes_as_the_textbook_says(tmp_path):
    """The roof after two periods of the ground, from the form of Newmark's method with the acceleration as unknown."""
    events = [{"do": "idle", "frames": 2}, *drag("right_top", (5.7, 16.6), across((5.7, 16.6), (5.7, 15.6), 10))]
    replay = make_replay(BUILDING, write_script(tmp_path, events), overrides=["mesh.order=1", "mesh.size=0.8"])
    rows = []
    for row in replay.frames():
        rows.append(dict(row))
        if row["index"] != 2:
            continue
        analysis, node = replay.analysis, replay.moving.mesh.nodes_of("d")[0]
        free = ~analysis.body.constrained.ravel()
        uniform = analysis.body.mass.apply(np.tile([1.0, 0.0], (len(free) // 2, 1))).ravel()[free]
        omega = 2 * np.pi * 2.5

        def force(t: float, uniform: np.ndarray = uniform, omega: float = omega) -> np.ndarray:
            return 1e-3 * omega**2 * np.sin(omega * t) * uniform

        motion = np.zeros(free.size)
        motion[free] = textbook_newmark(analysis.matrices(), force, 0.01, 0.25, 0.5, 80)[0]
        assert row["q_sway"] == pytest.approx(motion[2 * node], rel=1e-4)
    assert {row["level"] for row in rows} >= {1}
    assert all(row["q_amplitude"] >= abs(row["q_sway"]) for row in rows)
    assert not any(row["refused"] for row in rows)


@pytest.mark.slow
def test_the_template_runs(command, tmp_path):
    assert command("new", "vibration", "mast").returncode == 0
    cheap = ("--set", "mesh.size=0.3", "--set", "effects.dynamics.steps=6")
    words = ("--edits", "mast/edits.jsonl", "--parity", "--json", "a.json")
    done = command("replay", "mast/scene.toml", *words, *cheap)
    assert done.returncode == 0, done.stderr
    summary = json.loads((tmp_path / "a.json").read_text())
    assert summary["refused"] == 0 and summary["levels"]["1"] > 20
    assert max(summary["quantities"]["amplitude"]) < 0.1
