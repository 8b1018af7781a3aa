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
