"""Quantities of what is heard: cents from a named tone, ratios of frequencies, their errors, a note of each mode."""

import math

import numpy as np
import pytest
from restshape_apps.metallophone import application

from restshape.analysis.modal.tone_quantities import tone_error, tone_value
from restshape.errors import UserError
from restshape.interface.first_frame import first_frame
from restshape.interface.replays import replay_files
from restshape.scene.load import load_scene

SCENES = application.folder / "scenes"
PLATE = ("effects.modal.model=plate", "effects.modal.modes=3", 'mesh.size="8 mm"')
DRAGGED = """{"format": "restshape-edits", "version": 1, "units": "mm"}
{"t": 0.0, "do": "press", "on": "right", "at": [150, 15]}
{"t": 0.1, "do": "drag", "path": [[120, 15]], "frames": 6}
{"t": 0.5, "do": "release"}
"""


def bar(tmp_path, *quantities):
    """A bar of 150 mm with quantities of its own, and its drag through a crossing of modes 2 and 3."""
    text = (SCENES / "bar_150.toml").read_text()
    scene, edits = tmp_path / "bar.toml", tmp_path / "shorter.jsonl"
    scene.write_text(text[: text.index("[quantities]")] + "[quantities]\n" + "\n".join(quantities))
    edits.write_text(DRAGGED)
    return scene, edits


def test_modes_are_followed_through_a_crossing(tmp_path):
    quantities = (
        'off = { cents = "A#5", min = "-20 cent", max = 20 }',
        'bend = { cents = "C7", mode = 2 }',
        "overtone = { ratio = 2 }",
        "torsion = { mode = 3 }",
    )
    rows = replay_files(*bar(tmp_path, *quantities), "auto", PLATE)["rows"]
    for row in rows:
        places = {int(number): k for k, number in enumerate(row["mode_ids"].split(), 1)}
        first, second, third = (row[f"f_{places[number]}"] for number in (1, 2, 3))
        assert row["q_off"] == pytest.approx(1200.0 * math.log2(first / (440.0 * 2.0 ** (13 / 12))), abs=1e-9)
        assert row["q_bend"] == pytest.approx(1200.0 * math.log2(second / (440.0 * 2.0 ** (27 / 12))), abs=1e-9)
        assert row["q_overtone"] == pytest.approx(second / first, rel=1e-12) and row["q_torsion"] == third
        assert row["constraint_status"] in ("holds" if abs(row["q_off"]) < 20.0 else "fails", "uncertain")
        for k in (1, 2, 3):
            known = 440.0 * 2.0 ** ((note_number(row[f"tone_{k}"]) - 69) / 12.0 + row[f"cents_{k}"] / 1200.0)
            assert known == pytest.approx(row[f"f_{k}"], rel=1e-12)
        assert (row["tone_1"], row["cents_1"]) == (row["tone"], row["cents"])
    # Bending overtakes torsion on the way, and is still bending: 2.76 times the first.
    assert rows[0]["mode_ids"] == "1 2 3" and rows[-1]["mode_ids"] == "1 3 2"
    assert all(2.7 < row["q_overtone"] < 2.8 for row in rows)
    assert {row["constraint_status"] for row in rows} >= {"holds", "fails"}


def note_number(name):
    """The number of a key (MIDI), counted without the module that names it."""
    return ["C", "C#", "D", "D#", "E", "F", "F#", "G", "G#", "A", "A#", "B"].index(name[:-1]) + 12 * (int(name[-1]) + 1)


def test_tones_are_tuned_as_the_scene_says(tmp_path):
    scene, _ = bar(tmp_path, 'off = { cents = "A5" }')
    usual, low = (first_frame(scene, [*PLATE, f"effects.modal.a4={a4}"]).analysis.observe()["off"] for a4 in (440, 415))
    assert low - usual == pytest.approx(1200.0 * math.log2(440.0 / 415.0), abs=1e-9)


def test_errors_are_those_of_the_frequencies_in_cents_and_added_up(tmp_path):
    scene, _ = bar(tmp_path, 'off = { cents = "A5", error = true }', "over = { ratio = 2, error = true }")
    analysis = first_frame(scene, PLATE).analysis
    found, relative = analysis.quantity_errors(["off", "over"]), analysis._estimate(analysis.state)
    assert found["off"] == pytest.approx(1200.0 * math.log2(1.0 + relative[0]), rel=1e-2) and found["off"] > 0.0
    ratio = analysis.frequencies[1] / analysis.frequencies[0]
    assert found["over"] == pytest.approx(ratio * (relative[0] + relative[1]), rel=1e-12)


def test_predicted_values_say_how_far_they_may_be_off(tmp_path):
    scene, _ = bar(tmp_path, 'off = { cents = "A5" }', "over = { ratio = 2 }", "area = { area = true }")
    analysis = first_frame(scene, PLATE).analysis
    distance, known = analysis.predictor.distance(), analysis.predictor.quantity_distances()
    assert known.keys() == {"off", "over"} and known["off"] == pytest.approx(distance * 1200.0 / math.log(2.0))


def test_a_mode_that_is_gone_has_no_value(tmp_path):
    scene, _ = bar(tmp_path, 'off = { cents = "A5", mode = 2 }', "over = { ratio = 2 }")
    quantities = load_scene(scene, PLATE).quantities
    frequencies, ids = np.array([500.0, 900.0]), np.array([1, 7])
    for quantity in quantities.values():
        assert math.isnan(tone_value(quantity, 440.0, frequencies, ids))
        assert math.isnan(tone_error(quantity, np.full(2, 1e-3), frequencies, ids))


@pytest.mark.parametrize(
    ("quantity", "where", "what"),
    [
        ('{ cents = "H5" }', "off.cents", "no tone is named 'H5'"),
        ("{ cents = 5 }", "off.cents", "text"),
        ('{ cents = "C5", ratio = 2 }', "off", "cents and ratio"),
        ('{ cents = "C5", mode = 0 }', "off.mode", "too small"),
        ("{ ratio = 2, mode = 3 }", "off", "mode and ratio|ratio and mode"),
        ("{ ratio = 1 }", "off.ratio", "too small"),
        ('{ cents = "C5", max = "3 Hz" }', "off.max", "an? number is wanted|interval"),
        ("{ }", "off", "none of them"),
    ],
)
def test_what_makes_no_sense_is_refused(tmp_path, quantity, where, what):
    scene, _ = bar(tmp_path, f"off = {quantity}")
    with pytest.raises(UserError, match=what) as caught:
        load_scene(scene)
    assert f"quantities.{where}" in caught.value.where


@pytest.mark.parametrize("quantity", ['{ cents = "C5", mode = 4 }', "{ ratio = 4 }", "{ frequency = 4 }"])
def test_modes_that_are_not_computed_have_no_tone(tmp_path, quantity):
    """The scene is refused as soon as it is read."""
    scene, _ = bar(tmp_path, f"off = {quantity}")
    with pytest.raises(UserError, match="only 3 modes are computed") as caught:
        load_scene(scene, PLATE)
    assert "4 or more" in caught.value.do and "bar.toml" in caught.value.where


def test_estimated_error_of_a_thickness_by_formula():
    """An undercut bar as a plate, against a fine mesh: between nodes its thickness is linear, and more than it is."""
    bar = application.folder / "template" / "undercut" / "scene.toml"
    plates = [first_frame(bar, [f'mesh.size="{h} mm"', "effects.modal.modes=1"]).analysis for h in (14, 10, 3)]
    exact = plates[-1].frequencies[0]
    for plate in plates[:2]:
        assert 1.0 < plate.errors()["estimate"] / (plate.frequencies[0] / exact - 1.0) < 1.5
