"""Derivatives of frequencies by parameters that give the shape: Taylor remainders, similarity, and refusals."""

import json

import numpy as np
import pytest

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame, replayed_to
from restshape.scene.load import load_scene
from restshape.sensitivity.parameter_derivative import parameter_derivatives

BAR = """format = "restshape-scene"
version = 1
app = "metallophone"
[parameters]
length = "100 mm"
width = "0.3*length"
depth = "width/8"
turn = 0.2
[shape]
outline = ["bottom", "right", "top", "left"]
[shape.vertices]
a = [0, 0]
b = ["length", 0]
c = ["length", "width"]
d = [0, "width"]
[shape.edges]
bottom = { line = ["a", "b"] }
right = { arc = ["b", "c"], bulge = "turn" }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[shape.holes]
bore = { circle = { center = ["0.4*length", "width/2"], radius = "width/6" } }
[material.aluminium]
E = "70 GPa"
nu = 0.33
rho = "2700 kg/m^3"
thickness = "depth"
[effects.modal]
modes = 3
[mesh]
size = "8 mm"
[solve]
tolerance = 1e-9
"""
MODELS = {
    "plate": ['effects.modal.model="plate"', "mesh.order=1"],
    "tet10": ['effects.modal.model="solid"', "mesh.order=2", "mesh.layers=1"],
}


@pytest.fixture
def bar(tmp_path):
    path = tmp_path / "bar.toml"
    path.write_text(BAR, encoding="utf-8")
    return path


def frequencies_at(folder, bar, words, key, value):
    """The frequencies after the nodes have gone with the shape to a value."""
    header = {"format": "restshape-edits", "version": 1}
    event = {"t": 0.0, "do": "set", "key": key, "value": value}
    path = folder / "edit.jsonl"
    path.write_text(f"{json.dumps(header)}\n{json.dumps(event)}\n", encoding="utf-8")
    replay = replayed_to(load_scene(bar, words), path, None)
    assert replay.row["level"] == 1 and not replay.row["refused"]
    return replay.analysis.frequencies


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("key", "value"), [("parameters.length", 0.1), ("parameters.width", 0.03)])
def test_the_remainder_of_a_derivative_is_of_second_order(tmp_path, bar, model, key, value):
    # The width is no formula where it is the number that changes.
    words = [*MODELS[model], *(["parameters.width=0.03"] if key == "parameters.width" else [])]
    analysis = first_frame(bar, words).analysis
    first, slope = analysis.frequencies, parameter_derivatives(analysis, key)
    remainders, changes = [], []
    for h in (4e-3, 2e-3, 1e-3):
        after = frequencies_at(tmp_path, bar, words, key, value * (1.0 + h))
        changes.append(np.abs(after - first))
        remainders.append(np.abs(after - first - h * value * slope))
    # A derivative that lacks a part leaves a remainder of first order, which halves.
    ratios = np.array(remainders[:-1]) / np.array(remainders[1:])
    assert np.all(np.array(remainders) <= 0.02 * np.array(changes))
    assert np.all((ratios > 3.6) & (ratios < 4.4)), ratios


@pytest.mark.slow
def test_similar_bars_have_frequencies_by_the_inverse_of_their_size(bar):
    """All lengths are formulas of one: f is proportional to its inverse, whatever the mesh."""
    analysis = first_frame(bar, MODELS["tet10"]).analysis
    found = 0.1 * parameter_derivatives(analysis, "parameters.length")
    assert found == pytest.approx(-analysis.frequencies, rel=1e-5)


def test_what_bends_an_arc_is_refused_in_words(bar):
    analysis = first_frame(bar, MODELS["plate"]).analysis
    with pytest.raises(UserError, match="how edges of the shape bend"):
        parameter_derivatives(analysis, "parameters.turn")


def test_the_command_lists_parameters_of_the_shape(bar, tmp_path, capsys):
    words = [word for one in MODELS["plate"] for word in ("--set", one)]
    out = tmp_path / "rates.json"
    assert main(["rates", str(bar), *words, "--json", str(out)]) == 0, capsys.readouterr().err
    found = json.loads(out.read_text(encoding="utf-8"))["by"]
    assert "parameters.length" in found and "parameters.turn" not in found
    assert "parameters.turn" in capsys.readouterr().out
