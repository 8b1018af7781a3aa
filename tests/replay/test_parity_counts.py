"""What reuse verification says of the frames that it compared, and of those that it left out."""

import numpy as np
import pytest
from small_scenes import across, drag, make_replay, plate, write_scene, write_script

from restshape.analysis.analysis import Comparison
from restshape.cli.parity_line import parity_lines
from restshape.replay.parity import Parity

SHORT = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.54, 0.53), 8))
REFUSED = {"do": "set", "key": "material.steel.E", "value": 0}


def checked(folder, events, **more):
    """The summary, and rows with what the verification adds to them."""
    made = make_replay(write_scene(folder, plate()), write_script(folder, events), **more)
    check, rows = Parity(made), []
    for row in made.frames():
        rows.append(row | check())
    return check.summary(), rows


def test_frames_are_counted_by_kind(tmp_path):
    long = drag("window", (0.5, 0.5), across((0.5, 0.5), (1.3, 0.55), 30))
    found, rows = checked(tmp_path, long)
    levels = [row["level"] for row in rows]
    assert found["holds"] and found["left_out"] == {} and found["frames"] == len(rows)
    assert found["compared"] == {
        kind: levels.count(level)
        for level, kind in ((1, "level 1"), (2, "level 2"), (3, "level 3"), (0, "still"))
        if levels.count(level)
    }
    assert {"level 1", "level 3", "still"} <= set(found["compared"])
    assert parity_lines(found)[0].startswith(f"parity with cold solves: holds for all {len(rows)} frames")


def test_refused_and_predicted_frames_are_left_out_and_named(tmp_path):
    found, rows = checked(tmp_path, [REFUSED, *SHORT, REFUSED], predict="linear")
    refused, predicted = (sum(bool(row[key]) for row in rows) for key in ("refused", "predicted"))
    assert refused == 2 and predicted == 8
    assert found["left_out"] == {"predicted": 8, "refused": 2} and found["frames"] == len(rows)
    compared = len(rows) - 10
    first, kinds, left, ahead = parity_lines(found)
    assert f"holds for {compared} of {len(rows)} frames" in first
    assert "level 3" in kinds and "8 predicted, 2 refused" in left and "from the solved answer" in ahead


def test_a_predicted_frame_has_its_distance_from_the_solved_answer(tmp_path):
    found, rows = checked(tmp_path, SHORT, predict="linear")
    distances = [row["parity_prediction"] for row in rows if row["predicted"]]
    # Of second order in the way of the hand, and what a correction on release finds.
    assert distances[7] / distances[3] == pytest.approx(4.0, rel=0.15)
    assert found["prediction"] == max(distances)
    assert distances[-1] == pytest.approx(rows[-1]["prediction_error"], rel=1e-3)


def test_frames_that_nobody_analyses_are_unsolved(tmp_path):
    script = write_script(tmp_path, SHORT)
    head, *rest = script.read_text().splitlines()
    script.write_text("\n".join([head[:-1] + ', "analysis": "on demand"}', *rest]) + "\n")
    made = make_replay(write_scene(tmp_path, plate()), script)
    check = Parity(made)
    looked = [check() for _ in made.frames()]
    found = check.summary()
    assert found["left_out"]["unsolved"] == sum(not one for one in looked) > 0
    assert found["frames"] == len(looked)


@pytest.mark.parametrize("wrong", [Comparison(1e-12, 0.0), Comparison(0.0, 1e-5), Comparison(0.0, np.nan)])
def test_one_frame_that_differs_is_enough(tmp_path, monkeypatch, wrong):
    made = make_replay(write_scene(tmp_path, plate()), write_script(tmp_path, SHORT))
    check, compare = Parity(made), made.analysis.compare_cold
    for row in made.frames():
        monkeypatch.setattr(made.analysis, "compare_cold", lambda row=row: wrong if row["index"] == 3 else compare())
        check()
    found = check.summary()
    assert not found["holds"] and found["failed"] == {"level 1": 1}
    assert "FAILS in 1 of 11 frames (1 level 1)" in parity_lines(found)[0]


def test_what_compared_nothing_does_not_hold(tmp_path):
    made = make_replay(write_scene(tmp_path, plate()))
    found = Parity(made).summary()
    assert not found["holds"] and "no frame was compared" in parity_lines(found)[0]
