"""Replays of furniture: statuses, ranges and suggestions frame by frame, recordings, two ranks."""

import csv
import json
from dataclasses import astuple
from pathlib import Path

import numpy as np
import pytest
from furniture_scenes import BENCH, write_bench, write_edits
from restshape_apps.furniture.analysis import furnishing
from restshape_apps.furniture.physics.fasteners import wood
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.physics.plank_bending import plank_bending
from restshape_apps.furniture.pieces import SCENES
from small_scenes import make_replay, rows_of

from restshape.application import application
from restshape.cli.main import main
from restshape.replay.recording.recording import Recording
from restshape.scene.load import load_scene

EDITS = SCENES.parent / "edits"
NAMES = sorted(path.stem for path in SCENES.glob("*.toml"))
EVERY_DAY = {"bench", "chair-1", "scales", "shelf-1"}
"""Scenes whose scripts are replayed whole with parity every day; the others each week, and in part every day by
tests/replay/test_parity.py."""


def replayed(folder, *events, text=BENCH, name="auto"):
    """The replay of events on the bench, and its rows."""
    replay = make_replay(write_bench(folder, text), write_edits(folder, *events), name)
    return replay, rows_of(replay)


def slide(by, frames):
    """The left leg goes along the board."""
    return {"do": "press", "on": "left", "parameter": "move z"}, {"do": "drag", "by": by, "frames": frames}


def test_a_bench_tips_where_its_weight_is_beyond_its_leg(tmp_path):
    # Drawn upwards and with its width along y, the leg has its z against x: it goes towards the middle and beyond.
    _, rows = replayed(tmp_path, *slide(-0.7, 14), {"do": "release"})
    density = wood("pine").density
    top, leg = density * 1.2 * 0.3 * 0.02, density * 0.5 * 0.3 * 0.02
    mass = top + 2 * leg + 20.0
    # With the leg at x the weight of all is at leg (x + 0.5) / mass, and the leg's outer side at x - 0.01.
    x = (0.5 * leg + 0.01 * mass) / (mass - leg)
    assert rows[1]["range_low"] == pytest.approx(-(x + 0.5), abs=1e-5)
    falls = [row["violated_constraints"] == "falls under its weights" for row in rows[2:16]]
    assert falls == [-row["at"] > x + 0.5 for row in rows[2:16]] and any(falls)
    assert [row["inside"] for row in rows[2:16]] == [int(not fall) for fall in falls]


def test_a_range_holds_where_the_frames_of_a_drag_hold(tmp_path):
    replay, rows = replayed(tmp_path, *slide(-0.7, 50))
    low, high = rows[1]["range_low"], rows[1]["range_high"]
    found = [(row["at"], row["constraint_status"] == "holds") for row in rows[2:]]
    assert {holds for _, holds in found} == {True, False}
    assert all(holds == (low <= at <= high) for at, holds in found)
    assert {row["ranges"] for row in rows[2:]} == {rows[1]["ranges"]}
    assert rows[1]["parameter"] == "left: move z" and replay.analysis.design_direction is not None


def test_an_invalid_piece_that_is_let_go_has_suggestions_that_hold(tmp_path):
    replay, rows = replayed(tmp_path, *slide(-0.7, 10), {"do": "release"})
    assert rows[-2]["violated_constraints"] == "falls under its weights" and rows[-2]["suggested"] == 0
    reported = json.loads(rows[-1]["suggestions"])
    assert 1 <= len(reported) == rows[-1]["suggested"] <= 8 and rows[-1]["tried"] > 0
    design = replay.analysis.design
    for suggestion, one in zip(design.suggestion_list.found, reported):
        assert Furniture(design.piece).test(suggestion.t * suggestion.direction).valid is one["valid"]
        assert one["words"] == suggestion.words and one["range"][0] <= one["t"] <= one["range"][1]


def test_what_bears_more_uses_more_of_its_joints_and_a_push_counts(tmp_path):
    light, heavy, pushed = (
        replayed(tmp_path, text=text)[1][0]
        for text in (
            BENCH,
            BENCH.replace("20 kg", "40 kg"),
            BENCH + '[pushes.a]\non = "top"\nforce = [0, "60 N", 0]\n[effects.push]\n',
        )
    )
    assert heavy["utilisation"] > 1.2 * light["utilisation"] and pushed["utilisation"] > light["utilisation"]
    assert pushed["stability_margin"] < light["stability_margin"]


def test_sag_is_that_of_a_beam_on_two_supports(tmp_path):
    # A mass in the middle of a span between two legs that give way to nothing but the turns of the board's ends.
    text = BENCH.replace('mass = "20 kg"', 'mass = "20 kg"\nat = [0, 0, 0.5]') + "[effects.bending]\n"
    replay, rows = replayed(tmp_path, text=text)
    piece = replay.analysis.design.piece
    stiff = wood("pine").E * 0.3 * 0.02**3 / 12
    free = 200.0 * 1.0**3 / (48 * stiff)
    clamped = free / 4
    assert clamped < rows[0]["deflection"] < 1.3 * free
    assert len(replay.analysis.deflection) == len(piece.planks)


def test_nothing_drives_a_piece_without_gravity(tmp_path):
    _, rows = replayed(tmp_path, text=BENCH.replace("[effects.gravity]\ng = [0, 0, -10]\n", ""))
    assert rows[0]["constraint_status"] == "holds" and rows[0]["utilisation"] == 0.0


def test_effects_that_are_off_are_absent(tmp_path, monkeypatch):
    asked = []

    def bent(*words):
        asked.append(words)
        return plank_bending(*words)

    monkeypatch.setattr(furnishing, "plank_bending", bent)
    push = '[pushes.a]\non = "top"\nforce = [0, "60 N", 0]\n'
    replay, rows = replayed(tmp_path, *slide(-0.1, 2), text=BENCH + push)
    assert not asked and len(replay.analysis.forces) == 1 and np.isnan(rows[-1]["deflection"])
    assert "deflection" not in replay.analysis.fields()[1]
    replay, rows = replayed(tmp_path, *slide(-0.1, 2), text=BENCH + push + "[effects.push]\n[effects.bending]\n")
    # Three planks, two cases, and three frames in which they are somewhere else.
    assert len(asked) == 18 and len(replay.analysis.forces) == 2 and rows[-1]["deflection"] > 0.0
    quiet = "[effects.guidance]\nranges = false\nsuggestions = 0\n"
    replay, rows = replayed(tmp_path, *slide(-0.7, 2), {"do": "release"}, text=BENCH + quiet)
    assert [row["ranges"] for row in rows] == [""] * 5 and rows[-1]["suggested"] == 0 and rows[-1]["flaws"]


EVENTS = [
    *slide(-0.2, 4),
    {"do": "release"},
    {"do": "press", "on": "right"},
    {"do": "drag", "to": [0.4, 0.05, 0.25], "frames": 3},
    {"do": "release"},
    {"do": "rotate", "on": "left", "by": "10 deg", "about": "y", "frames": 3},
    {"do": "scale", "on": "top", "factor": 1.1, "along": "y", "frames": 2},
    {"do": "plank", "name": "shelf", "from": [-0.25, 0, 0.2], "to": [0.39, 0, 0.2], "width": [0, 0.2, 0]},
    {"do": "connect", "on": "shelf"},
    {"do": "weight", "name": "vase", "on": "top", "mass": 50, "at": [-0.49, 0, 0.5]},
    {"do": "choose", "number": 1},
    {"do": "slide", "to": 0.6, "frames": 3},
    {"do": "set", "key": "wood.thickness", "value": "25 mm", "frames": 3},
    {"do": "undo"},
    {"do": "redo"},
    {"do": "delete", "on": "shelf"},
    {"do": "idle", "frames": 2},
    {"do": "analyse"},
]


@pytest.mark.slow
@pytest.mark.parametrize("name", ["auto", "rebuild"])
def test_every_event_gives_what_a_model_from_nothing_gives(tmp_path, name):
    replay = make_replay(write_bench(tmp_path), write_edits(tmp_path, *EVENTS), name)
    seen = set()
    for row in replay.frames():
        seen.add(row["event"])
        analysis = replay.analysis
        if row["stale"]:
            assert (row["flaws"], row["constraint_status"]) == (-1, "") and np.isnan(row["unbalanced_load"])
            continue
        cold = Furniture(analysis.design.piece)
        result = cold.test(analysis.gamma)
        assert (row["flaws"], row["unbalanced_load"]) == (result.flaws, pytest.approx(result.unbalanced, abs=1e-9))
        if analysis.forces:
            # The test counts what contacts bear by another method, which agrees where it finds an equilibrium.
            assert row["residual"] < 1e-9
            assert astuple(analysis.compare_cold()) == pytest.approx((0.0, 0.0), abs=1e-12)
        if analysis.design_direction:
            again = type(analysis.design_direction.design)(analysis.design_direction.design.piece).valid_along(
                analysis.design_direction
            )
            assert again.intervals == pytest.approx(analysis.design_direction.ranges.intervals, abs=1e-12)
    assert seen == {event["do"] for event in EVENTS} | {"start"}


@pytest.mark.slow
def test_reuse_changes_no_number(tmp_path):
    rows = [replayed(tmp_path, *EVENTS, name=name)[1] for name in ("auto", "rebuild")]
    for one, other in zip(*rows):
        for column in (
            "flaws",
            "utilisation",
            "stability_margin",
            "range_low",
            "range_high",
            "suggestions",
            "ranges",
            "violated_constraints",
        ):
            assert one[column] == other[column] or np.isnan([one[column], other[column]]).all(), column
    assert sum(row["pc_rebuilt"] for row in rows[0]) < sum(row["pc_rebuilt"] for row in rows[1])


def test_levels_are_0_and_1_only(tmp_path):
    _, rows = replayed(tmp_path, *EVENTS)
    assert {row["level"] for row in rows} == {0, 1}
    assert all(row["level"] == 1 for row in rows if row["event"] in ("slide", "rotate", "scale", "plank"))
    assert np.isnan([row["estimate"] for row in rows]).all()


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", [name if name in EVERY_DAY else pytest.param(name, marks=pytest.mark.weekly) for name in NAMES]
)
def test_the_scripts_that_ship_replay_and_hold_parity(tmp_path, name):
    out, table = tmp_path / "run.json", tmp_path / "run.csv"
    words = ["replay", str(SCENES / f"{name}.toml"), "--edits", str(EDITS / f"{name}.jsonl")]
    assert main([*words, "--parity", "--json", str(out), "--csv", str(table)]) == 0
    found = json.loads(out.read_text())
    assert found["refused"] == 0 and found["parity"]["holds"] and found["parity"]["entries"] == 0.0
    assert found["constraint_status"]["holds"] > 0


@pytest.mark.slow
def test_a_recording_holds_boxes_and_the_use_of_each_plank(tmp_path):
    vtk = pytest.importorskip("vtk")
    path = tmp_path / "bench.vtkhdf"
    scene, edits = write_bench(tmp_path), write_edits(tmp_path, *slide(-0.1, 3), {"do": "release"}, EVENTS[8])
    assert main(["replay", str(scene), "--edits", str(edits), "--out", str(path)]) == 0
    with Recording(path) as recording:
        assert recording.status == "done" and recording.verify() == []
        assert recording.cells(0).shape == (3, 8) and recording.cells(-1).shape == (4, 8)
        X = recording.points(0)
        assert np.ptp(X[:8], axis=0) == pytest.approx([1.2, 0.3, 0.02])
        assert recording.field(0, "utilisation").max() == pytest.approx(recording.table["utilisation"][0])
        assert recording.table["parameter"][2] == "left: move z"
        assert set(recording.fields) == {"displacement", "utilisation", "valid"}
    reader = vtk.vtkHDFReader()
    reader.SetFileName(str(path))
    reader.Update()
    grid = reader.GetOutputDataObject(0)
    sizes = vtk.vtkCellSizeFilter()
    sizes.SetInputData(grid)
    sizes.Update()
    volumes = sizes.GetOutput().GetCellData().GetArray("Volume")
    assert [volumes.GetValue(k) for k in range(3)] == pytest.approx([0.0072, 0.003, 0.003])


def test_two_ranks_find_the_same_rows(tmp_path, on_ranks):
    scene, edits = write_bench(tmp_path), write_edits(tmp_path, *EVENTS)
    tables = []
    for ranks in (1, 2):
        done = on_ranks(ranks, "replay", scene, "--edits", edits, "--csv", f"{ranks}.csv")
        assert done.returncode == 0, done.stderr
        with (tmp_path / f"{ranks}.csv").open(newline="") as file:
            rows = list(csv.DictReader(file))
        tables.append([{key: row[key] for key in row if not key.startswith("ms")} for row in rows])
    assert len(tables[0]) > 20 and tables[0] == tables[1]


def test_furniture_is_not_predicted(tmp_path, capsys):
    scene = write_bench(tmp_path)
    assert main(["replay", str(scene), "--predict", "linear"]) == 2
    assert "predict" in capsys.readouterr().err


def test_check_reports_planks_and_refused_edits(tmp_path, capsys):
    scene, out = write_bench(tmp_path), tmp_path / "check.json"
    edits = write_edits(tmp_path, {"do": "press", "on": "left", "parameter": "length x"}, {"do": "release"})
    assert main(["check", str(scene), str(edits), "--json", str(out)]) == 1
    found = json.loads(out.read_text())
    assert list(found["planks"]) == ["top", "left", "right"] and len(found["joints"]) == 2 and found["valid"]
    assert "cannot become longer" in found["edits"]["refused"][0]["why"]
    assert "kg of pine" in capsys.readouterr().out


def test_scripts_of_furniture_are_written_from_lines(tmp_path):
    scene, out = write_bench(tmp_path), tmp_path / "made.jsonl"
    lines = ["drag left by 0.1 0 0 in 3 frames", "right length y by -5 cm in 2 frames", "rotate left by 5 deg about y"]
    lines += ["weight vase of 3 kg on top at 0 0 0.5", "set wood.thickness = 25 mm in 2 frames", "undo", "idle 2"]
    assert main(["script", str(scene), *lines, "--out", str(out)]) == 0
    events = [json.loads(line) for line in out.read_text().splitlines()][1:]
    assert events[1]["to"] == pytest.approx([-0.4, 0.0, 0.25]) and events[4]["by"] == pytest.approx(-0.05)
    assert main(["check", str(scene), str(out)]) == 0
    assert main(["script", str(scene), "smooth left by 0.5"]) == 2


def test_the_columns_are_those_of_the_rows(tmp_path):
    _, rows = replayed(tmp_path, *EVENTS[:3])
    own = application("furniture").own_columns(load_scene(write_bench(tmp_path)))
    assert set(own) <= set(rows[0]) and Path(SCENES).is_dir()


@pytest.mark.parametrize(
    "words", [["accuracy", "--sizes", "1"], ["bench", "reuse"], ["bench", "order"], ["bench", "drape"]]
)
def test_studies_of_meshes_refuse_what_has_none(tmp_path, capsys, words):
    assert main([*words, str(write_bench(tmp_path))]) == 2
    assert "has no mesh" in capsys.readouterr().err


@pytest.mark.slow
def test_on_demand_only_frames_that_are_asked_for_are_judged(tmp_path):
    scene, path = write_bench(tmp_path), tmp_path / "run.vtkhdf"
    edits = write_edits(tmp_path, *slide(-0.7, 3), {"do": "release"}, {"do": "analyse"}, analysis="on demand")
    assert main(["replay", str(scene), "--edits", str(edits), "--out", str(path)]) == 0
    with Recording(path) as recording:
        judged = [bool(word) for word in recording.table["constraint_status"]]
        assert judged == [True, True, False, False, False, False, True]
        assert (
            recording.table["violated_constraints"][-1] == "falls under its weights"
            and recording.table["suggested"][-1] > 0
        )
        assert (
            np.isnan(recording.field(2, "utilisation")).all() and np.isfinite(recording.field(0, "utilisation")).all()
        )
        assert np.ptp(recording.points(4) - recording.points(0), axis=0)[0] == pytest.approx(0.7)
