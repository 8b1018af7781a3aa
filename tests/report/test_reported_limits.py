"""Limits, constraint statuses and errors of quantities in a report's tables and pictures."""

import json
from types import SimpleNamespace

import h5py
import numpy as np
import pytest
from matplotlib.figure import Figure
from small_scenes import make_replay, plate, rows_of, write_scene, write_script

from restshape.application import application
from restshape.calibration import Calibration
from restshape.cli.main import main
from restshape.cli.report_tables import _quantity as report_row
from restshape.interface.first_frame import first_frame
from restshape.replay.columns import columns_of, error_column
from restshape.replay.constraints import Limit, formatted_constraint, violated_constraints
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.replay.request import Request
from restshape.report.frames import caption
from restshape.report.happenings import worst_frame
from restshape.report.quantity_panels import draw_limits, draw_quantities
from restshape.report.scenery import scenery
from restshape.report.tables import quantity_table
from restshape.report.timeline import draw_timeline
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.scene.quantity import limit_in_unit


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A plate pulled ever harder: its stretch passes a limit, coming within its error just before."""
    folder = tmp_path_factory.mktemp("limits")
    text = plate(0.2).replace("stretch = {", "stretch = { MAX")
    first = first_frame(write_scene(folder, text.replace("MAX", ""))).analysis
    value, error = first.observe()["stretch"], first.quantity_errors(["stretch"])["stretch"]
    limit = value + 3.0 * error
    scene = write_scene(folder, text.replace("MAX", f"max = {limit!r},"))
    factors = (1.0 + 2.5 * error / value, 1.0 + 6.0 * error / value)
    pulls = [{"do": "set", "key": "loads.pull.traction", "value": [1e8 * factor, 0]} for factor in factors]
    script = write_script(folder, pulls)
    replay = make_replay(scene, script)
    loaded, app = replay.session.scene, application("plane")
    request = Request(loaded, load_script(script, loaded), app, replay.policy, Calibration.load())
    path = folder / "a.vtkhdf"
    with Recorder.start(path, request.header(), columns_of(loaded, app)) as recorder:
        replay.recorder = recorder
        rows = rows_of(replay)
    return path, rows, limit


@pytest.mark.slow
def test_the_report_shows_limits_errors_and_statuses(recorded, tmp_path, capsys):
    path, rows, limit = recorded
    assert [row["constraint_status"] for row in rows] == ["holds", "uncertain", "fails"]
    words = ("--out", str(tmp_path / "r"), "--animation", "none", "--json", str(tmp_path / "a.json"))
    assert main(["report", str(path), *words]) == 0
    shown = capsys.readouterr().out
    assert "holds in 1 frame, uncertain in 1 frame, fails in 1 frame" in shown
    assert (
        "at most" in shown
        and "largest estimated error" in shown
        and "estimates, no bounds" in shown
        and "at least" not in shown
    )
    data = json.loads((tmp_path / "a.json").read_text())
    row = next(row for row in data["quantities"] if row["quantity"] == "stretch")
    assert row["at_most"] == pytest.approx(limit) and row["error"] == max(row["stretch_error"] for row in rows)
    assert data["constraint_status"] == {"holds": 1, "uncertain": 1, "fails": 1}


def test_pictures_mark_statuses(recorded, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr("restshape.report.timeline.save_picture", lambda figure, path: drawn.append(figure))
    with Recording(recorded[0]) as recording:
        draw_timeline(recording, tmp_path / "t.png")
        common = scenery(recording)
        captions = [caption(recording, i, common, 80) for i in range(recording.n)]
    figure: Figure = drawn[0]
    texts = [text.get_text() for text in figure.legends[0].get_texts()]
    assert "limit within the error (1)" in texts and "limit violated (1)" in texts
    marks = {line.get_marker(): line.get_xdata() for line in figure.axes[0].lines if line.get_marker() in ("x", "d")}
    np.testing.assert_array_equal(marks["d"], [1])
    np.testing.assert_array_equal(marks["x"], [2])
    assert "uncertain" not in captions[0] and "limit uncertain" in captions[1] and "LIMIT VIOLATED" in captions[2]


def test_errors_are_a_band_around_the_quantity(recorded, tmp_path, monkeypatch):
    drawn = []
    monkeypatch.setattr("restshape.report.quantity_panels.save_picture", lambda figure, path: drawn.append(figure))
    with Recording(recorded[0]) as recording:
        assert draw_quantities(recording, tmp_path / "q.png")
        value, error = recording.table["q_stretch"][0], recording.table[error_column("stretch")][0]
    axes = next(axes for axes in drawn[0].axes if axes.get_title(loc="left") == "stretch")
    (band,) = (one for one in axes.collections if any(len(path.vertices) > 8 for path in one.get_paths()))
    heights = band.get_paths()[0].vertices
    first = heights[np.isclose(heights[:, 0], -0.5), 1]
    factor = 10.0 ** np.round(np.log10(first.mean() / value))
    assert first.max() == pytest.approx(factor * (value + error)) and first.min() == pytest.approx(
        factor * (value - error)
    )
    assert error > 0.0 and axes.get_ylim()[0] <= first.min() and axes.get_ylim()[1] >= first.max()


@pytest.mark.parametrize(
    ("unit", "limit", "value", "words"),
    [
        ("Pa", {"max": 200e6}, 190e6, "worst: q at 95 % of its limit"),
        ("K", {"min": 303.15}, 304.2, "worst: q 1.05 K within its limit"),
        ("K", {"max": 313.15}, 321.69, "worst: q 8.54 K beyond its limit"),
        ("m", {"min": -3e-3}, -3.2e-3, "worst: q 200 µm beyond its limit"),
        ("m", {"min": -3e-3, "max": 1e-3}, -2.9e-3, "worst: q 100 µm within its limit"),
    ],
)
def test_how_near_a_limit_is_reads_in_the_unit_where_a_share_means_nothing(monkeypatch, unit, limit, value, words):
    monkeypatch.setattr("restshape.report.happenings.quantity_units", lambda header: {"q": unit})
    table, n = {"q_q": np.array([value])}, 1
    assert worst_frame(SimpleNamespace(table=table, n=n, header={"limits": {"q": limit}})) == (0, words)


def test_a_limit_far_from_the_values_is_named_in_its_own_unit():
    axes = Figure().subplots()
    assert not draw_limits(axes, 1e6, -5e-4, 5e-4, {"max": 0.04}, "µm")
    assert axes.get_title(loc="right") == "max 40 mm, beyond the axis" and not axes.get_lines()
    assert draw_limits(axes, 1e6, -5e-4, 5e-4, {"max": 6e-4}, "µm")
    assert axes.get_title(loc="right") == "max 600 µm"
    assert not draw_limits(axes, 1e-6, 1e5, 2e6, {"max": 4e9}, "MPa")
    assert axes.get_title(loc="right") == "max 4 GPa, beyond the axis"
    assert not draw_limits(axes, 1.0, 1.0, 2.0, {"max": 4e3}, "m")
    assert axes.get_title(loc="right") == "max 4 km, beyond the axis"


@pytest.mark.parametrize(("bound", "shown"), [(363.15, "363.15 K"), (313.15, "313.15 K"), (300.0, "300 K")])
def test_limits_have_one_rounding_everywhere(bound, shown):
    row = {"quantity": "q", "first": 350.0, "last": 350.0, "min": 350.0, "max": 350.0, "at_most": bound, "unit": "K"}
    assert report_row(row, ["at_most"])[-1] == shown == limit_in_unit("K", bound)
    (found,) = violated_constraints({"q": Limit(most=bound, unit="K")}, {"q": 400.0})
    assert formatted_constraint(found).endswith(f"at most {shown}")
    axes = Figure().subplots()
    draw_limits(axes, 1.0, 350.0, 360.0, {"max": bound}, "K")
    assert axes.get_title(loc="right") == f"max {shown}" + ("" if bound > 350.0 else ", beyond the axis")


def test_columns_beside_a_quantity_q_are_no_quantities(tmp_path, capsys):
    """`q_error` and `q_jump` of a quantity `q`, `q_top_error` of one `q_top`, in tables, JSON and recordings."""
    text = plate(0.3).replace("stretch = {", "q = { max = 1.0,")
    scene = write_scene(tmp_path, text + 'q_top = { displacement = "y", at = "c", max = 1.0 }\n')
    out, summary = tmp_path / "a.vtkhdf", tmp_path / "a.json"
    assert main(["replay", str(scene), "--out", str(out), "--json", str(summary)]) == 0
    assert "q_error" not in capsys.readouterr().out
    found, names = json.loads(summary.read_text()), set(load_scene(scene).quantities)
    assert found["quantities"].keys() == names and found["quantity_errors"].keys() == {"q", "q_top"}
    assert found["jumps"].keys() <= names
    with Recording(out) as recording:
        assert {"q_error", "q_top_error", "q_jump"} <= recording.table.keys()
        assert {row["quantity"] for row in quantity_table(recording)} == names
    with h5py.File(out) as file:
        assert "q_jump" not in file["VTKHDF/FieldData"] and "q_q" in file["VTKHDF/FieldData"]
