"""Replays, sweeps and exports of shapes that parameters give."""

import csv
import json
import math

import pytest
from parametric_scenes import BRACKET, PLATE, write_scene

from restshape.export.toml_scene import toml_text
from restshape.replay.recording.recording import Recording
from restshape.report.goal_curves import goals_of
from restshape.scene.given_numbers import given_numbers
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

DEPTHS = (0.25, 0.27, 0.29)


def script(folder, *events):
    """The file of a script."""
    lines = [{"format": "restshape-edits", "version": 1, "units": "m"}]
    lines += [{"t": float(i), **event} for i, event in enumerate(events)]
    (folder / "edit.jsonl").write_text("\n".join(map(json.dumps, lines)) + "\n", encoding="utf-8")
    return folder / "edit.jsonl"


def set_to(key, value, frames):
    return {"do": "set", "key": key, "value": value, "frames": frames}


def rows_of(command, folder, *words):
    """The rows of a replay that ends with 0."""
    done = command("replay", *words, "--csv", folder / "rows.csv")
    assert done.returncode == 0, done.stderr + done.stdout
    with (folder / "rows.csv").open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def written_by_hand(folder, path, *overrides):
    """The scene with numbers in place of its formulas."""
    scene = load_scene(path, overrides)
    raw = json.loads(json.dumps(scene.raw))
    for one in given_numbers(scene):
        inner = raw
        for part in one.key[:-1]:
            inner = inner[int(part) if isinstance(inner, list) else part]
        inner[int(one.key[-1]) if isinstance(inner, list) else one.key[-1]] = one.value
    del raw["parameters"]
    found = folder / "by_hand.toml"
    found.write_text(toml_text(raw), encoding="utf-8")
    return found


@pytest.mark.parametrize("depth", DEPTHS)
def test_a_parametric_bracket_is_the_one_written_by_hand(command, tmp_path, depth):
    path, words = write_scene(tmp_path, BRACKET), f"parameters.depth={depth}"
    by_hand = written_by_hand(tmp_path, path, words)
    assert "depth" not in by_hand.read_text(encoding="utf-8")
    (one,), (other,) = rows_of(command, tmp_path, path, "--set", words), rows_of(command, tmp_path, by_hand)
    for name in ("q_tip", "q_area", "unknowns", "mesh_area", "min_quality"):
        assert one[name] == other[name], name


def test_a_swept_bracket_reuses_mesh_and_analysis(command, tmp_path):
    path = write_scene(tmp_path, BRACKET)
    swept = f"parameters.depth={','.join(map(str, DEPTHS))}"
    done = command("sweep", path, "--set", swept, "--json", tmp_path / "sweep.json")
    assert done.returncode == 0, done.stderr
    runs = json.loads((tmp_path / "sweep.json").read_text())["runs"]
    assert [one["level"] for one in runs] == [3, 1, 1] and [one["analysis"] for one in runs] == [
        "new",
        "reused",
        "reused",
    ]
    for depth, run in zip(DEPTHS, runs):
        (alone,) = rows_of(command, tmp_path, path, "--set", f"parameters.depth={depth}")
        assert run["quantities"]["area"]["last"] == pytest.approx(float(alone["q_area"]), rel=1e-13)
        # Another mesh is as far.
        assert run["quantities"]["tip"]["last"] == pytest.approx(float(alone["q_tip"]), rel=0.01)


def test_a_sweep_after_edits_starts_from_the_shape_of_its_scene(command, tmp_path):
    path, edits = write_scene(tmp_path), script(tmp_path, set_to("parameters.width", "36 cm", 2))
    words = ("--edits", edits, "--set", "parameters.width=30 cm,36 cm,33 cm")
    done = command("sweep", path, *words, "--json", tmp_path / "sweep.json")
    assert done.returncode == 0, done.stderr
    runs = json.loads((tmp_path / "sweep.json").read_text())["runs"]
    ends = [(one["quantities"]["area"]["min"], one["quantities"]["area"]["last"]) for one in runs]

    def area(width):
        return width**2 / 3 - math.pi * (width / 15) ** 2

    assert ends == [pytest.approx((area(width), area(0.36)), rel=1e-12) for width in (0.30, 0.36, 0.33)]


@pytest.mark.slow
@pytest.mark.parametrize(("body", "key", "value"), [(PLATE, "width", "36 cm"), (BRACKET, "depth", "28 cm")])
def test_frames_of_a_parameter_agree_with_cold_solves(command, tmp_path, body, key, value):
    edits = script(
        tmp_path,
        set_to(f"parameters.{key}", value, 4),
        {"do": "press", "on": "d"},
        {"do": "drag", "to": [0.27, 0.25]} if key == "depth" else {"do": "drag", "to": [0.0, 0.13]},
        {"do": "release"},
        set_to(f"parameters.{key}", "26 cm" if key == "depth" else "32 cm", 3),
        {"do": "undo"},
    )
    rows = rows_of(command, tmp_path, write_scene(tmp_path, body), edits, "--parity")
    assert [row["level"] for row in rows[1:5]] == ["1"] * 4 and not any(row["refused"] for row in rows)
    given = outline_from_spec(load_scene(tmp_path / "plate.toml", [f"parameters.{key}={value}"]).shape)
    assert float(rows[4]["q_area"]) == pytest.approx(given.area(), rel=1e-14)


def test_reuse_gives_what_rebuilding_gives(command, tmp_path):
    path, edits = write_scene(tmp_path), script(tmp_path, set_to("parameters.width", "36 cm", 4))
    reused, rebuilt = (rows_of(command, tmp_path, path, edits, "--policy", one) for one in ("auto", "rebuild"))
    assert {row["level"] for row in rebuilt} == {"3"} and {row["level"] for row in reused[1:]} == {"1"}
    for one, other in zip(reused, rebuilt):
        assert float(one["q_area"]) == pytest.approx(float(other["q_area"]), rel=1e-14)
        assert float(one["q_tip"]) == pytest.approx(float(other["q_tip"]), rel=5e-3)


def test_an_export_keeps_formulas_where_they_still_hold(command, tmp_path):
    path = write_scene(tmp_path, BRACKET)
    edits = script(
        tmp_path,
        set_to("parameters.depth", "28 cm", 2),
        {"do": "press", "on": "d"},
        {"do": "drag", "to": [0.28, 0.24]},
        {"do": "release"},
    )
    done = command("export", path, edits, "--as", "toml", "--out", tmp_path / "out.toml")
    assert done.returncode == 0, done.stderr
    back = load_scene(tmp_path / "out.toml")
    shape = back.raw["shape"]
    assert back.raw["parameters"]["depth"] == "28 cm"
    assert shape["vertices"]["c"] == ["depth", "height - band"] and shape["vertices"]["d"] == ["depth", 0.24]
    assert shape["edges"]["curve"]["through"] == ["0.45*depth", "0.6*height"]
    assert shape["holes"]["slot"]["polygon"][0] == ["band/2", "0.8*height"]
    last = rows_of(command, tmp_path, path, edits)[-1]
    assert outline_from_spec(back.shape).area() == pytest.approx(float(last["q_area"]), rel=1e-12)
    # The tip alone keeps the number that a hand gave it.
    wider = outline_from_spec(load_scene(tmp_path / "out.toml", ["parameters.depth=0.3"]).shape)
    assert wider.points[wider.vertex_names.index("c")].tolist() == [0.3, 0.8 * 0.3 - 0.03]


def test_an_arc_whose_ends_a_hand_has_moved_is_exported_by_its_bulge(command, tmp_path):
    edits = script(tmp_path, {"do": "press", "on": "b"}, {"do": "drag", "to": [0.04, 0.0]}, {"do": "release"})
    path = write_scene(tmp_path, BRACKET)
    assert command("export", path, edits, "--as", "toml", "--out", tmp_path / "out.toml").returncode == 0
    back = load_scene(tmp_path / "out.toml")
    assert "bulge" in back.raw["shape"]["edges"]["curve"]
    last = rows_of(command, tmp_path, path, edits)[-1]
    assert outline_from_spec(back.shape).area() == pytest.approx(float(last["q_area"]), rel=1e-12)


def test_check_prints_formulas_with_their_values(command, tmp_path):
    done = command("check", write_scene(tmp_path), "--json", tmp_path / "check.json")
    assert done.returncode == 0, done.stderr
    lines = [" ".join(line.split()) for line in done.stdout.splitlines()]
    assert "shape.holes.bore.circle.radius r 0.02 m" in lines and "loads.pull.force.1 -P -1000 N" in lines
    found = json.loads((tmp_path / "check.json").read_text())["formulas"]
    assert found["shape.vertices.c.1"] == {"formula": "height", "value": pytest.approx(0.1)}


def test_a_scene_without_formulas_has_no_table_of_them(command, tmp_path):
    path = write_scene(tmp_path)
    assert "formulas" in command("check", path).stdout.splitlines()
    assert "formulas" not in command("check", written_by_hand(tmp_path, path)).stdout.splitlines()


def test_a_recorded_goal_of_formulas_is_drawn(command, tmp_path):
    body = PLATE + '[goal.line]\npolyline = [["width", 0], ["width", "height/2"]]\n'
    done = command("replay", write_scene(tmp_path, body), "--out", tmp_path / "out.vtkhdf")
    assert done.returncode == 0, done.stderr
    with Recording(tmp_path / "out.vtkhdf") as recording:
        (curve,) = goals_of(recording)
    assert curve[0].tolist() == [0.3, 0.0] and curve[-1] == pytest.approx([0.3, 0.05])
