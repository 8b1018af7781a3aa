"""Drag and lift of a steady flow, predicted along a drag of the tail: how far from the solution, and by which work."""

import numpy as np
import pytest
from counted_replays import begin_log, happened, watched
from restshape_apps.flow import application

SCENE = application.folder / "scenes" / "steady_flow.toml"
EDITS = application.folder / "edits" / "steady_flow.jsonl"
HALF, WHOLE = 21, 41
"""Frames with half of the way, and all of it."""


@pytest.fixture(scope="module")
def rows():
    """Those of the shipped script, by whether they are predicted."""
    begin_log()
    return {way: watched(SCENE, EDITS, predict=way)[0] for way in ("none", "linear")}


@pytest.mark.slow
def test_what_a_prediction_leaves_over_grows_with_the_square_of_the_way(rows):
    """The drag is even in the way of the tail, so that its slope is 0: all of its change is what is left over."""
    drag, lift = (
        np.array([[row[name] for row in rows[way]] for way in ("none", "linear")]) for name in ("q_drag", "q_lift")
    )
    left = np.abs(drag[0] - drag[1])
    assert left[WHOLE] / left[HALF] == pytest.approx(4.0, rel=0.05)
    assert left[WHOLE] < 0.004 * drag[0, WHOLE]
    assert np.abs(lift[0] - lift[1]).max() < 0.001 * lift[0, WHOLE] and lift[0, WHOLE] > 0.5


@pytest.mark.slow
def test_a_prediction_says_how_far_from_the_flow_it_is(rows):
    """The solve of the release begins at the last prediction, and says how far that was; no solved frame says it."""
    predicted = rows["linear"]
    estimates = np.array([row["estimate"] for row in predicted])
    assert estimates[WHOLE] == pytest.approx(predicted[WHOLE + 1]["prediction_error"], rel=0.1)
    assert estimates[WHOLE] / estimates[HALF] == pytest.approx(4.0, rel=0.1)
    assert np.isnan([row["estimate"] for row in rows["none"]]).all()


@pytest.mark.slow
def test_a_predicted_frame_solves_nothing(rows):
    """Both forces take one residual, of the cells around the body; the first frame is estimated before it is shown."""
    predicted = [row for row in rows["linear"] if row["predicted"]]
    assert len(predicted) == 40
    calls = [row["calls"] for row in predicted]
    assert all(set(one) == {"flow_tri3"} and set(one["flow_tri3"]) == {"residual"} for one in calls)
    assert [one["flow_tri3"]["residual"][0] for one in calls] == [2] + 39 * [1]
    assert happened(predicted, "KSPSolve") == 0


@pytest.mark.slow
def test_the_end_of_a_drag_makes_no_factor(rows):
    """None shows whether a flow is stable."""
    assert happened(rows["none"][WHOLE + 1 :], "MatLUFactorNum") == 0
    assert happened(rows["none"][1:2], "MatLUFactorNum") == 0


def test_an_area_is_known_in_predicted_frames(tmp_path):
    """It does not depend on the flow, which a prediction lacks; a pressure does."""
    begin_log()
    scene = tmp_path / "area.toml"
    asked = 'area = { area = true }\nahead = { pressure = true, at = "body" }\n'
    scene.write_text(SCENE.read_text(encoding="utf-8") + asked, encoding="utf-8")
    rows = [row for row in watched(scene, EDITS, predict="linear")[0] if row["predicted"]]
    assert rows and all(row["area_distance"] == 0.0 for row in rows)
    assert all(row["ahead_distance"] > 0.0 for row in rows)


@pytest.mark.slow
def test_each_predicted_quantity_says_how_far_off_it_is(tmp_path):
    """A body that leaves the wake of another: its drag is farther off than velocities are, and that of the other less.

    The estimate is one step with a factor of where the drag began, which far from there is off by half or twice.
    """
    text = SCENE.read_text(encoding="utf-8").replace('["60 mm", 0]', '["15 mm", 0]')
    body = 'body = { loop = ["nose", "belly", "back"] }'
    text = text.replace(body, f'{body}\nsecond = {{ circle = {{ center = ["80 mm", "2 mm"], radius = "8 mm" }} }}')
    text = text.replace("near = {", 'near = { second = "2.5 mm",')
    text += 'behind = { drag_coefficient = { speed = "0.02 m/s", length = "20 mm" }, at = "second" }\n'
    scene, edits = tmp_path / "two.toml", tmp_path / "two.jsonl"
    scene.write_text(text, encoding="utf-8")
    header = '{"format": "restshape-edits", "version": 1, "scene": "two.toml", "units": "mm"}\n'
    drag = '{"t": 0.1, "do": "drag", "path": [[80, 30]], "frames": 20}\n'
    edits.write_text(f'{header}{{"t": 0, "do": "press", "on": "second", "at": [80, 2]}}\n{drag}', encoding="utf-8")
    rows = {way: watched(scene, edits, predict=way)[0] for way in ("none", "linear")}
    ahead = [k for k, row in enumerate(rows["linear"]) if row["predicted"]]
    for name, least in (("behind", 0.9), ("drag", 0.4)):
        off = np.array([abs(rows["none"][k][f"q_{name}"] - rows["linear"][k][f"q_{name}"]) for k in ahead])
        said = np.array([rows["linear"][k][f"{name}_distance"] for k in ahead])
        far = off > 1e-3
        share = [rows["linear"][k]["estimate"] * abs(rows["linear"][k][f"q_{name}"]) for k in ahead]
        assert (said >= 0.999 * np.array(share)).all(), (said, share)
        most = np.maximum(2.5 * off, 1.001 * np.array(share))
        assert (said[far] > least * off[far]).all() and (said[far] < most[far]).all(), (off, said)
    last = max(k for k in ahead if rows["linear"][k]["estimate"] > 0.15)
    share = rows["linear"][last]["behind_distance"] / rows["none"][last]["q_behind"]
    assert share > 2.0 * rows["linear"][last]["estimate"] > 0.3
    assert all(np.isnan(row["behind_distance"]) for row in rows["linear"] if not row["predicted"])
