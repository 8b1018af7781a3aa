"""`restshape bench predict` and `derivative` as people and programs call them; no time is asserted."""

import json
from pathlib import Path

import numpy as np
import pytest
from drape_designs import BALL, HELD, sheet
from restshape_studies.commands import bench
from restshape_studies.pictures.design import draw_derivative, draw_drape
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.scene.load import load_scene

pytestmark = pytest.mark.cli

SCENES = Path(__file__).parents[2] / "scenes"
PNG = b"\x89PNG\r\n\x1a\n"


@pytest.fixture
def scene(tmp_path):
    path = write_scene(tmp_path, plate(0.2), "small.toml")
    edits = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.54, 0.5), 8)), "small.jsonl")
    first, *others = edits.read_text().splitlines()
    edits.write_text("\n".join([json.dumps({**json.loads(first), "scene": "small.toml"}), *others, ""]))
    return path


COARSE = ("--set", "mesh.size=0.2", "--set", "effects.cloth.bending=hinge")


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_predict_for_programs_and_people(tmp_path, command, scene):
    done = command("bench", "predict", scene, "--repeat", 1, "--json", "a.json", "--set", "solve.tolerance=1e-10")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert (found["frames"], found["predicted"], found["anchors"]) == (11, 8, 1)
    assert found["fps"]["predicted"] > 0 and found["ms"]["solved"] > 0
    np.testing.assert_allclose(found["way"], 0.005 * np.arange(1, 9), rtol=1e-9)
    # First order: the error grows with the square of the way.
    assert found["error"][7] / found["error"][3] == pytest.approx(4.0, rel=0.2)
    assert found["at"]["1.0"] == max(found["error"]) and found["at"]["0.5"] == max(found["error"][:4])
    assert min(found["session_s"].values()) > 0 and set(found["ratios"]) == {"frames", "session"}
    ways = found["ways"]
    assert list(ways) == ["none", "linear", "gmls", "gmls, no steps"] and ways["none"]["predicted"] == 0
    assert ways["linear"]["max"] == max(found["error"]) and ways["gmls"]["samples"] >= 1
    # Steps in the time of frames reach the solution; energies have errors of second order in those of displacements.
    assert ways["gmls"]["max"] < 1e-3 * ways["linear"]["max"]
    assert 0.0 < ways["linear"]["energy"]["max"] < ways["linear"]["max"]
    assert 0.0 < ways["linear"]["distance"]["mean"] < ways["linear"]["distance"]["max"]
    assert set(found["quantities"]) == {"stretch", "peak", "wall", "energy"}
    for words in (
        "8 of 11 frames predicted",
        "frames a second",
        "the whole session",
        "ways of prediction",
        "against the solved answer",
        "stretch",
    ):
        assert words in done.stdout
    assert (tmp_path / "results/bench-predict.png").read_bytes().startswith(PNG)


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
@pytest.mark.parametrize("law", ["", "[effects.large_deformation]\n"])
def test_derivative_for_programs_and_people(tmp_path, command, scene, law):
    scene.write_text(scene.read_text() + law)
    done = command("bench", "derivative", scene, "--json", "a.json", "--out", "pictures")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    steps = np.array(found["steps"])
    at = {way: dict(zip(steps, found[way])) for way in ("forward", "central", "semi")}
    big, small = steps[np.argmin(abs(steps - 1e-3))], steps[np.argmin(abs(steps - 1e-4))]
    # One-sided differences are off by their step, central ones by its square.
    for way, order in (("forward", 1), ("semi", 1), ("central", 2)):
        assert np.log10(at[way][big] / at[way][small]) == pytest.approx(order, abs=0.1)
        assert min(e for e in found[way] if e is not None) < 1e-5
    assert min(e for e in found["central"] if e is not None) < 1e-7
    assert found["forward"][-1] > 1e-3, "rounding"
    assert "semi-analytic (5.14)" in done.stdout and set(found["ms"]) == {"forward", "central", "semi", "dual"}
    assert (tmp_path / "pictures/sensitivity-epsilon.png").read_bytes().startswith(PNG)


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("predict", "small.toml", "--repeat", 0), ("--repeat",)),
        (("predict", SCENES / "pins.toml", *COARSE, "--repeat", 1), ("no frame of the script is predicted",)),
        (("predict", "small.toml", "--policy", "rebuild"), ("rebuild", "--predict")),
        (("predict", "small.toml", "--policy", "thesis", "--repeat", 1), ("springs", "--predict gmls")),
        (("predict", "small.toml", "--edits", "still.jsonl", "--repeat", 1), ("no frame", "still.jsonl")),
        (("derivative", "small.toml", "--edits", "still.jsonl"), ("drags nothing",)),
        (("derivative", "nowhere.toml"), ("nowhere.toml",)),
        (("derivative", "small.toml", "--by", "material.rubber.E"), ("about cloth", "--by")),
    ],
)
def test_what_cannot_be_measured(tmp_path, command, scene, words, reported):
    write_script(tmp_path, [{"do": "idle"}], "still.jsonl")
    done = command("bench", *words)
    assert done.returncode == 2, done.stderr
    assert all(word in done.stderr for word in reported), done.stderr


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_of_several_scripts_the_one_that_drags_the_shape_is_predicted(tmp_path):
    scene = write_scene(tmp_path, sheet("hinge", HELD, BALL.format(friction=0.3), "[effects.contact]\n", size=0.1))
    press = {"do": "press", "on": "ball", "at": [0.1, 0.1]}
    of_body = write_script(tmp_path, [press, {"do": "release"}], "a.jsonl")
    of_shape = write_script(tmp_path, [{**press, "on": "right", "at": [0.2, 0.1]}, {"do": "release"}], "b.jsonl")
    for path in (of_body, of_shape):
        head, *lines = path.read_text().splitlines(keepends=True)
        path.write_text("".join([json.dumps(json.loads(head) | {"scene": scene.name}) + "\n", *lines]))
    read = load_scene(scene)
    assert bench._script(bench.KINDS["predict"], scene, read) == of_shape
    assert bench._script(bench.KINDS["drape"], scene, read) == of_body
    of_shape.unlink()
    assert bench._script(bench.KINDS["predict"], scene, read) == of_body


def test_a_motion_has_no_prediction(command):
    done = command("bench", "predict", SCENES / "building.toml", "--edits", SCENES / "building.jsonl", "--repeat", 1)
    assert done.returncode == 2 and "time integration depends on the past" in done.stderr


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_derivatives_of_a_drape(tmp_path, command):
    path = write_scene(tmp_path, sheet("hinge", HELD, size=0.04), "sheet.toml")
    edits = write_script(tmp_path, drag("top", (0.1, 0.2), across((0.1, 0.2), (0.1, 0.21), 2)), "sheet.jsonl")
    words = ("--edits", edits, "--json", "a.json", "--out", "pictures")
    done = command("bench", "derivative", path, *words)
    assert done.returncode == 0, done.stderr
    assert "both derivatives by hand take" in done.stdout and "nodes are free of friction" in done.stdout
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["drape"] and max(found["residuals"]) < 1e-6
    for first, second, _ in found["remainders"]:
        assert 1.9 < 1.0 + np.log2(first / second) < 2.1
    numbers = {one["key"]: one for one in found["numbers"]["rows"]}
    assert {"material.cotton.E", "material.cotton.rho", "effects.gravity.g.0", "start.move.2"} <= set(numbers)
    assert numbers["material.cotton.rho"]["order"] == pytest.approx(2.0, abs=0.1)
    # Pins take all of the cloth along.
    assert numbers["start.move.2"]["motion"] == pytest.approx(1.0, rel=1e-6)
    assert found["numbers"]["idle"] == ["material.cotton.grain"] and not found["numbers"]["left_out"]
    assert (tmp_path / "pictures" / "sensitivity-epsilon.png").read_bytes().startswith(PNG)


@pytest.mark.usefixtures("jobs_here")
def test_derivatives_of_a_drape_of_panels(tmp_path, command):
    shape, panel = "[shape.", "[panels.one."
    text = sheet("hinge", HELD.replace('"a", "b"', '"one.a", "one.b"'), size=0.1)
    path = write_scene(tmp_path, text.replace("[shape]", "[panels.one]").replace(shape, panel), "panels.toml")
    done = command("bench", "derivative", path, "--by", "material.cotton.rho", "--json", "a.json", "--out", "pictures")
    assert done.returncode == 0, done.stderr
    found = json.loads((tmp_path / "a.json").read_text())
    assert found["edge"].startswith("one.")
    assert [one["key"] for one in found["numbers"]["rows"]] == ["material.cotton.rho"]


@pytest.mark.slow
@pytest.mark.usefixtures("jobs_here")
def test_derivatives_of_a_drape_by_one_number_and_times_alone(tmp_path, command):
    table = BALL.format(friction=0.4) + "[effects.contact]\n"
    path = write_scene(tmp_path, sheet("hinge", table, size=0.05), "sheet.toml")
    edits = write_script(tmp_path, drag("top", (0.1, 0.2), across((0.1, 0.2), (0.1, 0.21), 2)), "sheet.jsonl")
    words = ("bench", "derivative", path, "--edits", edits, "--out", "pictures")
    done = command(*words, "--by", "bodies.ball.sphere.radius", "--json", "a.json")
    assert done.returncode == 0 and "bodies.ball.sphere.radius" in done.stdout and "along x" not in done.stdout
    ((row,),) = (json.loads((tmp_path / "a.json").read_text())["numbers"]["rows"],)
    assert row["orders"]["sticks"] == pytest.approx(2.0, abs=0.2)
    assert row["orders"]["free"] == pytest.approx(2.0, abs=0.2)
    (tmp_path / "pictures" / "sensitivity-epsilon.png").unlink()
    done = command(*words, "--only-times")
    assert done.returncode == 0 and "order" not in done.stdout and "residuals" in done.stdout
    assert not list((tmp_path / "pictures").iterdir())
    done = command(*words, "--by", "material.cotton.colour")
    assert done.returncode == 2 and "is no number of this scene" in done.stderr


@pytest.mark.filterwarnings("error")
def test_pictures_without_a_point_have_no_legend(tmp_path):
    exact = {"steps": [0.1], "forward": [0.0], "central": [0.0], "semi": [0.0], "unknowns": 6}
    draw_derivative("still", exact, tmp_path / "derivative.png")
    draw_drape(
        "still", {"steps": [0.1], "remainders": [[0.0]] * 2, "numbers": None, "nodes": 4}, tmp_path / "drape.png"
    )
    assert (tmp_path / "derivative.png").stat().st_size and (tmp_path / "drape.png").stat().st_size
