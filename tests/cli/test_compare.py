"""`restshape compare`: the same bits of two replays, differences in closed form, other meshes, results as JSON."""

import json
import math
import shutil
from contextlib import closing

import h5py
import numpy as np
import pytest
from small_scenes import CLAMPED, HEAD, PULLED, QUANTITIES, STEEL, block, drag, meshed, plate, write_scene, write_script
from vibrating import SHAKEN, dynamics, tower

from restshape.comparison import comparison_picture
from restshape.comparison.header_differences import header_differences, shortened
from restshape.comparison.result import read_result
from restshape.comparison.result_comparison import compared as compared_results
from restshape.comparison.series_difference import series_difference
from restshape.outputs.si_numbers import si

BAR = HEAD + block(2.0, 0.5) + STEEL.replace("nu = 0.3", "nu = 0.0") + CLAMPED + PULLED + meshed(0.25) + QUANTITIES


@pytest.fixture
def replayed(command, tmp_path):
    """Replays a scene, and gives the paths of its recording and its JSON file."""

    def replay(scene, name, *words):
        out = tmp_path / f"{name}.vtkhdf"
        assert command("replay", scene, "--out", out, "--json", f"{name}.json", *words).returncode == 0
        return out, tmp_path / f"{name}.json"

    return replay


@pytest.fixture
def dragged(tmp_path):
    """A plate, and a script that drags its hole."""
    scene = write_scene(tmp_path, plate(size=0.25), "plate.toml")
    path = [(0.5 + 0.04 * k, 0.5) for k in range(1, 7)]
    return scene, write_script(tmp_path, drag("window", (0.5, 0.5), path))


def compared(command, folder, *words):
    """The exit code, what --json has, and what is printed."""
    ended = command("compare", *words, "--json", folder / "compared.json")
    return ended.returncode, json.loads((folder / "compared.json").read_text()), ended.stdout


@pytest.mark.slow
def test_a_repeated_replay_has_the_same_bits(command, tmp_path, replayed, dragged):
    scene, script = dragged
    (first, one), (second, other) = (replayed(scene, name, "--edits", script) for name in "ab")
    code, found, said = compared(command, tmp_path, first, second)
    assert code == 0 and found["outcome"] == "same bits" and "the same bits" in said
    assert found["hashes"][0] == found["hashes"][1] and found["columns"] == [] and found["header"] == {}
    assert all(one["largest"] == 0.0 for one in (*found["quantities"].values(), *found["fields"].values()))
    code, found, _ = compared(command, tmp_path, one, other)
    assert found["time"] is None
    assert code == 0 and found["outcome"] == "same values" and set(found["ms"]) == {"p50", "p95", "p99"}
    code, found, _ = compared(command, tmp_path, first, other)
    assert code == 0 and found["outcome"] == "same values"


@pytest.mark.slow
def test_another_value_is_found_and_its_difference_is_that_of_the_closed_form(command, tmp_path, replayed):
    """Of a bar that stretches by traction times length over the modulus."""
    scene = write_scene(tmp_path, BAR)
    first, _ = replayed(scene, "a")
    second, _ = replayed(scene, "b", "--set", "material.steel.E=250e9")
    code, found, said = compared(command, tmp_path, first, second)
    assert code == 1 and found["outcome"] == "different"
    assert found["header"] == {"material.steel.E": [200e9, 250e9]} and "material.steel.E" in said
    stretch = found["quantities"]["stretch"]
    assert stretch["largest"] == pytest.approx(1e-3 - 0.8e-3, rel=1e-6)
    assert stretch["rms"] == pytest.approx(0.2e-3, rel=1e-6)
    assert stretch["relative"] == pytest.approx(0.2, rel=1e-6)
    assert found["fields"]["displacement"]["largest"] == pytest.approx(0.2e-3, rel=1e-6)
    # The displacement goes evenly along x, to which its difference is proportional; that along y is none.
    X = read_result(first).recording.points(0)
    wanted = 0.2e-3 * math.sqrt(float(np.mean((X[:, 0] / 2.0) ** 2)) / 2.0)
    assert found["fields"]["displacement"]["rms"] == pytest.approx(wanted, rel=1e-6)
    assert found["quantities"]["peak"]["relative"] < 1e-6
    assert found["points"]["largest"] == 0.0 and found["meshes"]["same cells"] == 1
    assert compared(command, tmp_path, first, second, "--tolerance", 0.21)[:1] == (0,)
    assert compared(command, tmp_path, first, second, "--tolerance", 0.19)[:1] == (1,)


@pytest.mark.slow
def test_fields_on_other_meshes_are_sampled(command, tmp_path, replayed):
    """Linear elements hold the even stretch on both meshes: nothing is lost between them."""
    scene = write_scene(tmp_path, BAR)
    first, _ = replayed(scene, "a")
    second, _ = replayed(scene, "b", "--set", "mesh.size=0.17", "--set", "material.steel.E=400e9")
    code, found, said = compared(command, tmp_path, first, second)
    assert code == 1 and found["meshes"] == {"same cells": 0, "sampled": 1, "other meshes": 0}
    assert found["fields"]["displacement"]["largest"] == pytest.approx(0.5e-3, rel=1e-6)
    assert "sampled in 1 frame\n" in said or "sampled in 1 frame," in said


@pytest.mark.slow
def test_a_frame_that_is_refused_and_one_that_is_missing_are_found(command, tmp_path, replayed, dragged):
    scene, script = dragged
    first, one = replayed(scene, "a", "--edits", script)
    path = [(0.5 + 0.04 * k, 0.5) for k in range(1, 6)] + [(0.5, 9.0)]
    far = write_script(tmp_path, drag("window", (0.5, 0.5), path), "far.jsonl")
    second, other = replayed(scene, "b", "--edits", far)
    for pair in ((first, second), (one, other)):
        code, found, said = compared(command, tmp_path, *pair, "--tolerance", 10)
        assert code == 1 and found["refused"] == [7] and "refused in one of them only: 7" in said
        assert found["quantities"]["stretch"]["alone"] >= 1
    code, found, said = compared(command, tmp_path, first, second)
    assert "script line 3" in found["header"]
    short = write_script(tmp_path, drag("window", (0.5, 0.5), path[:3]), "short.jsonl")
    third, _ = replayed(scene, "c", "--edits", short)
    code, found, said = compared(command, tmp_path, first, third, "--tolerance", 10)
    assert code == 1 and found["frames"] == [9, 6] and "the first 6 are compared" in said


def test_a_bit_of_a_field_is_found(command, tmp_path, replayed):
    """Also where its checksum were right: hashes are of the values themselves."""
    first, _ = replayed(write_scene(tmp_path, BAR), "a")
    changed = tmp_path / "changed.vtkhdf"
    shutil.copy(first, changed)
    with h5py.File(changed, "r+") as file:
        values = file["VTKHDF/PointData/displacement"]
        row = values[5]
        row[0] = np.nextafter(row[0], np.inf, dtype=row.dtype)
        values[5] = row
    with closing(read_result(first)) as one, closing(read_result(changed)) as other:
        found = compared_results(one, other)
        assert found.outcome == "different" and found.columns == ["field displacement"]
        assert compared_results(one, other, 1e-6).outcome == "within tolerance"
        assert compared_results(one, one).outcome == "same bits"
    # The command refuses it: its checksum is not right.
    ended = command("compare", first, changed)
    assert ended.returncode == 2 and "damaged" in ended.stderr


@pytest.mark.slow
def test_fields_have_their_exaggeration_and_what_is_marked(tmp_path, replayed, monkeypatch):
    """The larger displacement of both becomes 8 % of the size: with half the modulus, half the exaggeration."""
    scene = write_scene(tmp_path, BAR)
    figures, (first, _) = [], replayed(scene, "a")
    second, _ = replayed(scene, "b", "--set", "material.steel.E=100e9")
    monkeypatch.setattr(comparison_picture, "save_picture", lambda figure, path: figures.append(figure))
    results = read_result(first), read_result(second)
    with closing(results[0].recording), closing(results[1].recording):
        comparison_picture.draw_comparison(*results, compared_results(*results), tmp_path / "a.png")
    (figure,) = figures
    part = figure.subfigs[-1]
    # The end moves by traction times length over the modulus, 2 mm of 2 m.
    assert part._suptitle.get_text() == "deformation ×80 in both  ·  dashed: shape at rest"
    said = [axes.get_title(loc="left").replace("\n", " ") for axes in part.axes[:2]]
    assert "largest displacement 1 mm" in said[0] and "largest displacement 2 mm" in said[1]
    assert all("○ peak 100 MPa" in one for one in said)


@pytest.mark.slow
def test_pictures_show_both_results(command, tmp_path, replayed, dragged):
    from PIL import Image

    scene, script = dragged
    first, one = replayed(scene, "a", "--edits", script)
    second, _ = replayed(scene, "b", "--edits", script, "--set", "mesh.size=0.3")
    for words in ((first, second), (one, second)):
        assert command("compare", *words, "--out", "both.png").returncode == 1
        with Image.open(tmp_path / "both.png") as picture:
            pixels = np.asarray(picture.convert("RGB"))
        # The lines of the second one have a colour of their own, and only fields make the picture this high.
        assert (np.abs(pixels.astype(int) - [213, 94, 0]).max(axis=2) < 30).sum() > 200
        assert (pixels.shape[0] > 1200) is (words[0] == first)


@pytest.mark.parametrize("text", ["[]", "{}", '{"frames": 2, "quantities": {"a": [1]}}', "no JSON", '{"frames": 1}'])
def test_what_is_no_result_is_refused(command, tmp_path, text):
    (tmp_path / "a.json").write_text(text)
    ended = command("compare", "a.json", "a.json")
    assert ended.returncode == 2 and "a.json" in ended.stderr


def test_a_file_that_is_not_there_and_a_bad_tolerance_are_refused(command, tmp_path):
    assert command("compare", "a.vtkhdf", "b.vtkhdf").returncode == 2
    (tmp_path / "a.json").write_text('{"frames": 1, "quantities": {"a": [1]}}')
    for value in ("-1", "nan", "inf"):
        assert command("compare", "a.json", "a.json", "--tolerance", value).returncode == 2
    assert command("compare", "a.json", "a.json").returncode == 0


def test_differences_of_series_are_those_of_their_numbers():
    found = series_difference("a", np.array([1.0, np.nan, 3.0, 4.0]), np.array([1.0, np.nan, 1.0, np.nan, 9.0]))
    assert (found.compared, found.alone, found.largest, found.frame, found.scale) == (2, 1, 2.0, 2, 3.0)
    assert found.rms == pytest.approx(math.sqrt(2.0)) and found.relative == math.inf
    same = series_difference("a", np.zeros(2), np.zeros(2))
    assert same.relative == 0.0 and same.frame == -1


def test_a_header_differs_in_dotted_keys(tmp_path):
    results = []
    for name, header in (("a", {"policy": "auto", "ranks": 1}), ("b", {"policy": "thesis", "guess": "zero"})):
        (tmp_path / name).write_text(json.dumps({"frames": 0, "quantities": {}, **header}))
        results.append(read_result(tmp_path / name))
    # Of JSON files only what both say counts.
    assert [tuple(one) for one in header_differences(*results)] == [("policy", "auto", "thesis")]


@pytest.mark.slow
def test_json_files_say_how_they_were_made(command, tmp_path, replayed):
    scene = write_scene(tmp_path, BAR, "bar.toml")
    (recording, one), (_, other) = replayed(scene, "a"), replayed(scene, "b", "--set", "mesh.size=0.125")
    code, found, said = compared(command, tmp_path, one, other)
    assert code == 1 and found["header"]["overrides"] == [[], ["mesh.size=0.125"]]
    assert "overrides" in said and found["header"]["unknowns"][0] < found["header"]["unknowns"][1]
    pulled, _ = replayed(scene, "c", "--set", "loads.pull.traction=['5 MPa', 0]")
    # The load is named as the scene names it, and once.
    assert list(compared(command, tmp_path, recording, pulled)[1]["header"]) == ["loads.pull.traction"]
    # A single frame moved nothing, so that there is no time to compare.
    assert not found["ms"] and "p50" not in said
    assert not compared(command, tmp_path, one, recording)[1]["ms"]


@pytest.mark.slow
@pytest.mark.parametrize("place", [0, 1])
def test_frames_at_other_simulated_times_are_noted(command, tmp_path, replayed, place):
    """Of steps of 10 ms and 5 ms, 4 a frame: frame 5 is at 200 ms or 100 ms. Recordings and JSON files both know."""
    scene = tower(tmp_path, SHAKEN, dynamics(steps=4), size=0.5)
    script = write_script(tmp_path, [{"t": 0.0, "do": "idle", "frames": 5}])
    first = replayed(scene, "a", "--edits", script)[place]
    second = replayed(scene, "b", "--edits", script, "--set", "effects.dynamics.time_step=0.005")[place]
    _, found, said = compared(command, tmp_path, first, second, "--out", "both.png")
    assert found["time"]["largest"] == pytest.approx(0.1) and found["time"]["frame"] == 5
    assert "paired by their number" in said and "by up to 100 ms (frame 5)" in said
    _, found, said = compared(command, tmp_path, first, first)
    assert found["time"]["largest"] == 0.0 and "simulated times" not in said


@pytest.mark.slow
def test_tables_have_units(command, tmp_path, replayed):
    scene = write_scene(tmp_path, BAR, "bar.toml")
    (first, _), (second, _) = replayed(scene, "a"), replayed(scene, "b", "--set", "material.steel.E=1e11")
    _, found, said = compared(command, tmp_path, first, second)
    with closing(read_result(first)) as result:
        units = result.units
    rows = {line.split()[0]: line for line in said.splitlines() if line.strip()}
    for name, one in found["quantities"].items():
        if one["largest"]:
            assert si(one["largest"], units[name]) in rows[name]
    assert f"{si(found['fields']['displacement']['largest'], 'm')}" in rows["displacement"]


def test_units_of_json_are_those_of_recordings(tmp_path):
    path = tmp_path / "a.json"
    origin = {"units": {"area": "m^2", "stored": "J", "volume": "m^3"}}
    path.write_text(json.dumps({"frames": 1, "quantities": {"area": [2.0]}, "origin": origin}))
    with closing(read_result(path)) as found:
        assert found.units == {"area": "m²", "stored": "J", "volume": "m³"}


def test_values_are_written_as_scenes_have_them():
    values = (["bottom", "höhe"], True, {"x": 0}, None, "5 mm", [0.0, 1])
    shown = ['["bottom", "höhe"]', "true", '{"x": 0}', "-", "5 mm", "[0.0, 1]"]
    assert [shortened(value) for value in values] == shown


@pytest.mark.slow
def test_which_file_lacks_what_is_said(command, tmp_path, replayed):
    scene = write_scene(tmp_path, BAR, "bar.toml")
    (first, one), (second, other) = replayed(scene, "a"), replayed(scene, "b", "--set", "material.steel.E=1.9e11")
    code, _, said = compared(command, tmp_path, one, second, "--tolerance", "0.2")
    assert code == 0 and "\nquantities differ by at most 0.2" in said
    assert f"note: quantities alone are compared: {one} does not have fields" in said
    assert "neither file has fields" in compared(command, tmp_path, one, other)[2]
    assert "note:" not in compared(command, tmp_path, first, second)[2]
    # Loads are shown as the scene has them, not again as sizes that were found from them.
    text = BAR.replace('"100 MPa"', '"200 MPa"') + "whole = { area = true }\n"
    longer = write_scene(tmp_path, text, "longer.toml")
    third, _ = replayed(longer, "c")
    _, found, said = compared(command, tmp_path, first, third)
    assert "quantities of B only: whole" in said and "of A only" not in said
    assert "loads.pull.traction" in said and not any(
        key.startswith(("load_scales", "limits")) for key in found["header"]
    )
