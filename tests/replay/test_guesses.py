"""Initial guesses: an option of their own, which changes what a solve costs and not what it finds."""

import json

import numpy as np
import pytest
from cloths import PIN, write_cloth
from modal import replay
from restshape_studies.bench.job import Job
from restshape_studies.bench.process import request
from small_scenes import across, drag, make_replay, plate, rows_of, write_scene, write_script
from vibrating import DAMPED, SHAKEN, dynamics, tower

from restshape.errors import UserError
from restshape.policy import GUESSES, POLICIES, policy

EVENTS = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.7, 0.5), 12))
TIGHT = ["solve.tolerance=1e-10"]
LARGE = plate(0.15).replace("200e9", "4e9") + "[effects.large_deformation]\n"
BAR = """{"format": "restshape-edits", "version": 1, "scene": "bar_100.toml", "units": "m"}
{"t": 0.0, "do": "press", "on": "right"}
{"t": 0.1, "do": "drag", "path": [[0.101, 0.015], [0.102, 0.015], [0.103, 0.015]]}
"""


def rows(folder, text, name, guess, events=EVENTS):
    """The rows of a scene under a policy with a guess."""
    scene, script = write_scene(folder, text), write_script(folder, events)
    return rows_of(make_replay(scene, script, name, TIGHT, guess=guess))


def spent(found, key="iterations"):
    """What the frames of the drag have cost together."""
    return sum(row[key] for row in found if row["event"] == "drag")


def test_every_policy_has_the_best_guess_that_its_mesh_allows():
    own = {name: chosen.guess for name, chosen in POLICIES.items()}
    assert own == {"rebuild": "last", "refactor": "extrapolated", "thesis": "same-mesh", "auto": "projected"}
    assert policy("refactor", "last").guess == "last" and policy("refactor").guess == "extrapolated"
    assert policy("refactor", "last").solver == "direct"


def test_a_guess_that_there_is_not():
    with pytest.raises(UserError, match="'best'") as raised:
        policy("auto", "best")
    assert all(name in str(raised.value) for name in GUESSES)


@pytest.mark.parametrize("text", [plate(0.15), LARGE], ids=["linear", "large"])
def test_better_guesses_cost_less_and_find_the_same(tmp_path, text):
    found = {guess: rows(tmp_path, text, "thesis", guess) for guess in ("zero", "last", "extrapolated")}
    key = "newton" if text == LARGE else "iterations"
    assert spent(found["zero"], key) > spent(found["last"], key) > spent(found["extrapolated"], key)
    for other in found.values():
        for a, b in zip(other, found["zero"], strict=True):
            assert a["q_stretch"] == pytest.approx(b["q_stretch"], rel=1e-7)


def test_a_factor_of_a_linear_problem_takes_no_guess(tmp_path):
    values = {guess: [row["q_stretch"] for row in rows(tmp_path, plate(0.2), "refactor", guess)] for guess in GUESSES}
    assert all(found == values["zero"] for found in values.values())
    # Nothing is transferred that nobody would use.
    assert all(row["ms_map"] == 0.0 for row in rows(tmp_path, plate(0.2), "rebuild", "last"))


def test_a_new_mesh_starts_from_the_transferred_solution_or_cold(tmp_path):
    sizes = [{"do": "set", "key": "mesh.size", "value": size} for size in (0.14, 0.13, 0.12)]
    steps = {
        guess: sum(row["newton"] for row in rows(tmp_path, LARGE, "rebuild", guess, sizes)[1:])
        for guess in ("zero", "same-mesh", "last")
    }
    assert steps["zero"] == steps["same-mesh"] > steps["last"]


@pytest.mark.parametrize("name", ["refactor", "rebuild"])
def test_modes_start_from_the_last_ones_with_a_new_factor(tmp_path, name):
    """Far below the second mode, the first is all that lies below the shift of a factor, which therefore counts it."""
    edits = tmp_path / "bar.jsonl"
    edits.write_text(BAR)
    overrides = ["effects.modal.modes=1", 'mesh.size="12 mm"', "mesh.layers=1", "solve.tolerance=1e-8"]
    found = {}
    for guess in ("zero", None):
        run = replay("bar_100.toml", edits, overrides, name, guess=guess)
        found[guess] = [dict(row) for row in run.frames()]
    moved = {guess: [row for row in each if row["event"] == "drag"] for guess, each in found.items()}
    assert {row["preconditioner"] for row in moved[None]} == {"davidson"}
    assert all(row["pc_rebuilt"] for each in moved.values() for row in each)
    assert all(row["inertia_checked"] for row in moved[None])
    assert spent(found[None]) < spent(found["zero"])
    for a, b in zip(found["zero"], found[None], strict=True):
        assert a["f_1"] == pytest.approx(b["f_1"], rel=1e-9)


@pytest.mark.parametrize("law", ["", "\n[effects.solid]\nmodel = 'plane_strain'\n[effects.large_deformation]\n"])
def test_a_motion_is_the_same_from_every_guess(tmp_path, law):
    scene = tower(tmp_path, law, SHAKEN, DAMPED, dynamics(0.01, 3), size=0.34)
    script = write_script(tmp_path, [{"do": "idle", "frames": 3}])
    sway = [rows_of(make_replay(scene, script, "thesis", guess=guess))[-1]["q_sway"] for guess in GUESSES]
    np.testing.assert_allclose(sway, sway[0], rtol=1e-8)


@pytest.mark.parametrize(("guess", "warm"), [("zero", False), ("last", True)])
def test_cloth_goes_on_from_where_it_is_or_falls_again(tmp_path, guess, warm):
    path = write_cloth(tmp_path, PIN, PIN.replace("pin", "other").replace('"a"', '"d"'))
    script = write_script(tmp_path, [{"do": "set", "key": "material.cotton.rho", "value": "401 kg/m^3"}])
    made = make_replay(path, script, "rebuild", guess=guess)
    steps = [row["relaxation_steps"] for row in rows_of(made)]
    assert (steps[1] < 0.2 * steps[0]) == warm


def test_a_bench_names_a_policy_with_its_guess(tmp_path):
    scene, script = write_scene(tmp_path, plate()), write_script(tmp_path, EVENTS)
    asked = {name: request(Job(str(scene), str(script), name)).policy for name in ("auto", "auto:last")}
    assert asked["auto"] == POLICIES["auto"] and asked["auto:last"] == policy("auto", "last")


@pytest.mark.cli
def test_the_guess_is_an_option_of_a_replay(tmp_path, command):
    scene, script = write_scene(tmp_path, plate(0.2)), write_script(tmp_path, EVENTS[:1])
    done = command("replay", scene, "--edits", script, "--guess", "last", "--json", "a.json", "--out", "a.vtkhdf")
    assert done.returncode == 0, done.stderr
    assert "policy auto, initial guess last" in done.stdout
    assert json.loads((tmp_path / "a.json").read_text())["guess"] == "last"
    assert command("replay", scene, "--guess", "best").returncode == 2
