"""Limits of quantities follow the parameters that a script sets: statuses, findings, recordings and reports."""

import json

import numpy as np
import pytest
from matplotlib.figure import Figure
from small_scenes import CLAMPED, HEAD, STEEL, block, meshed, write_scene, write_script

from restshape.replay.recording import Recording
from restshape.report.happenings import utilisations, worst_frame
from restshape.report.quantity_panels import draw_limits
from restshape.report.recorded_quantities import limit_series

PULL, LENGTH, E = 100e6, 2.0, 200e9
STRETCH = PULL * LENGTH / E
"""Of a bar without lateral contraction [m]: 1 mm."""
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


def test_a_limit_that_moves_is_a_line_of_steps():
    axes = Figure().subplots()
    draw_limits(axes, 1e3, 1e-3, 2e-3, {"max": np.array([1e-3, 2e-3, 2e-3])}, "mm", np.arange(3))
    (line,) = axes.get_lines()
    assert line.get_ydata().tolist() == [1.0, 2.0, 2.0] and axes.get_title(loc="right") == "max 1 to 2 mm"


@pytest.mark.parametrize("key", ["quantities.wall.max", "quantities.stretch.at"])
def test_quantities_themselves_cannot_be_set(command, tmp_path, key):
    script = write_script(tmp_path, [{"do": "set", "key": key, "value": "2 mm" if key.endswith("max") else "left"}])
    done = command("check", write_scene(tmp_path, BAR), script)
    assert done.returncode == 1 and "cannot be set during an edit" in done.stdout + done.stderr
