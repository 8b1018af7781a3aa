"""Limits of quantities follow the parameters that a script sets: statuses, findings, recordings and reports."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure
from small_scenes import CLAMPED, HEAD, STEEL, block, meshed, write_scene, write_script

from restshape.replay.recording.recording import Recording
from restshape.report.happenings import utilisations, worst_frame
from restshape.report.quantity_panels import draw_limits
from restshape.report.recorded_quantities import limit_series

PULL, LENGTH = 100e6, 2.0
BAR = (
    HEAD
    + '[parameters]\nwide = "240 mm"\npull = "100 MPa"\n'
    + block(LENGTH, 0.5)
    + STEEL.replace("nu = 0.3", "nu = 0.0")
    + CLAMPED
    + '[loads.pull]\non = "right"\ntraction = ["pull", 0]\n'
    + meshed(0.25)
    + '[quantities]\nstretch = { displacement = "x", at = "right", reduce = "mean", max = "wide/200" }\n'
    + 'wall = { reaction = "x", at = "left", max = 0 }\n'
)
SETS = [{"do": "set", "key": "parameters.wide", "value": wide} for wide in ("180 mm", "300 mm")]


def replayed(command, folder, *words):
    scene, script = write_scene(folder, BAR), write_script(folder, SETS)
    done = command("replay", scene, "--edits", script, "--out", "a.vtkhdf", "--csv", "a.csv", *words)
    assert done.returncode == 0, done.stderr
    return done, folder / "a.vtkhdf"


def test_a_limit_follows_its_parameter(command, tmp_path):
    young = float(STEEL.split("E = ")[1].split()[0].strip('"').replace("GPa", "e9"))
    stretch = PULL * LENGTH / young
    assert 0.18 / 200 < stretch < 0.24 / 200
    _, path = replayed(command, tmp_path)
    with Recording(path) as recording:
        status = [str(one.decode() if isinstance(one, bytes) else one) for one in recording.table["constraint_status"]]
        assert status == ["holds", "fails", "holds"] and not recording.table["stale"].any()
        assert recording.table["q_stretch"] == pytest.approx([stretch] * 3, rel=1e-6)
        series = limit_series(recording)
        assert series["stretch"]["max"] == pytest.approx([0.24 / 200, 0.18 / 200, 0.3 / 200])
        assert series["wall"]["max"].tolist() == [0.0, 0.0, 0.0] and "wall_max" not in recording.table
        assert utilisations(recording)["stretch"] == pytest.approx(
            stretch * 200 / np.array([0.24, 0.18, 0.3]), rel=1e-6
        )
        assert worst_frame(recording)[0] == 1
        assert "at most 900 µm" in str(recording.table["violated_constraints"][1])
    assert "stretch_max" in (tmp_path / "a.csv").read_text().splitlines()[0]


@pytest.mark.slow
def test_the_report_has_the_limit_of_the_end(command, tmp_path):
    _, path = replayed(command, tmp_path)
    done = command("report", path, "--animation", "none", "--json", "r.json")
    assert done.returncode == 0, done.stderr
    rows = {row["quantity"]: row for row in json.loads((tmp_path / "r.json").read_text())["quantities"]}
    assert rows["stretch"]["at_most"] == pytest.approx(0.3 / 200)


@pytest.mark.slow
def test_the_picture_of_a_sweep_has_the_limit_of_each_run(command, tmp_path, monkeypatch):
    """Of 180, 240 and 300 mm the first is beyond: 1 mm over 0.9 mm; given lengths make a line of each.

    The script sets 180 mm in a frame of each run.
    """
    drawn = []
    monkeypatch.setattr("restshape.variation.sweep_picture.save_picture", lambda figure, path: drawn.append(figure))
    scene, wide = write_scene(tmp_path, BAR), ("--set", "parameters.wide=180mm,240mm,300mm")
    for more in ((), ("--set", "parameters.pull=50MPa,100MPa"), ("--edits", write_script(tmp_path, SETS))):
        done = command("sweep", scene, *more, *wide, "--out", "a.png")
        assert done.returncode == 0, done.stderr
    pictures = [next(one for one in figure.axes if one.get_title(loc="left") == "stretch") for figure in drawn]
    for axes, beyond in zip(pictures, ([180], [180], [180, 240, 300])):
        crosses = [one for one in axes.get_lines() if one.get_marker() == "x" and len(one.get_xdata())]
        drawn_at = [x for one in crosses for x, y in zip(*one.get_data()) if np.isfinite(y)]
        assert drawn_at == beyond
    for axes in pictures[:2]:
        (limit,) = [one for one in axes.get_lines() if one.get_drawstyle() == "steps-mid"]
        assert limit.get_xdata().tolist() == [180, 240, 300]
        assert limit.get_ydata() == pytest.approx([0.9, 1.2, 1.5])
        assert axes.get_title(loc="right") == "max 0.9 to 1.5 mm"
    # The script ends with 300 mm in each run.
    assert pictures[2].get_title(loc="right") == "max 1.5 mm, beyond the axis"


def test_a_limit_that_moves_is_a_line_of_steps():
    axes = Figure().subplots()
    draw_limits(axes, 1e3, 1e-3, 2e-3, {"max": np.array([1e-3, 2e-3, 2e-3])}, "mm", np.arange(3))
    (line,) = axes.get_lines()
    assert line.get_ydata().tolist() == [1.0, 2.0, 2.0] and axes.get_title(loc="right") == "max 1 to 2 mm"


def test_limits_that_move_there_and_back_are_named_by_their_ends():
    axes = Figure().subplots()
    rows = np.array([[1e-3, 2e-3, 1e-3], [np.nan, 3e-3, 1e-3]])
    draw_limits(axes, 1e3, 1e-3, 2e-3, {"max": rows, "min": np.array([np.nan] * 3)}, "mm", np.arange(3))
    assert len(axes.get_lines()) == 2 and axes.get_title(loc="right") == "max 1 to 3 mm"


def test_limits_of_lines_have_their_colours_and_short_numbers():
    axes = Figure().subplots()
    rows = np.array([[0.5 / 300] * 3, [1.1 / 300] * 3])
    draw_limits(axes, 1e3, 1e-3, 4e-3, {"max": rows}, "mm", np.arange(3), ["#112233", "#445566"])
    assert [line.get_color() for line in axes.get_lines()] == ["#112233", "#445566"]
    assert axes.get_title(loc="right") == "max 1.667 to 3.667 mm"


@pytest.mark.slow
def test_a_sweep_ties_limits_to_their_lines(command, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr("restshape.variation.sweep_picture.save_picture", lambda figure, path: drawn.append(figure))
    keys = ("--set", "parameters.wide=180mm,310mm", "--set", "parameters.pull=50MPa,100MPa")
    done = command("sweep", write_scene(tmp_path, BAR), *keys, "--out", "a.png")
    assert done.returncode == 0, done.stderr
    lines = [line for axes in drawn[0].axes if axes.get_title(loc="left") == "stretch" for line in axes.get_lines()]
    limits = [line for line in lines if line.get_drawstyle() == "steps-mid"]
    curves = [line for line in lines if line.get_marker() == "o"]
    assert [line.get_ydata()[0] for line in limits] == pytest.approx([0.9, 1.55])
    assert [line.get_color() for line in limits] == [line.get_color() for line in curves]
    assert "limit, in the colour of its line" in [text.get_text() for text in drawn[0].legends[0].get_texts()]


@pytest.mark.parametrize("key", ["quantities.wall.max", "quantities.stretch.at"])
def test_quantities_themselves_cannot_be_set(command, tmp_path, key):
    script = write_script(tmp_path, [{"do": "set", "key": key, "value": "2 mm" if key.endswith("max") else "left"}])
    done = command("check", write_scene(tmp_path, BAR), script)
    assert done.returncode == 1 and "cannot be set during an edit" in done.stdout + done.stderr
