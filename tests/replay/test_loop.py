"""The frame loop: what happens to frames that cannot be computed."""

import numpy as np
import pytest
from small_scenes import PULLED, across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.errors import UserError
from restshape.replay.columns import columns
from restshape.replay.parity import Parity
from restshape.replay.recorder import Recorder
from restshape.replay.recording import Recording


def replay(folder, events, text=None, **options):
    """The rows of a replay of the plate, and whether each agrees with a cold solve."""
    made = make_replay(write_scene(folder, text or plate()), write_script(folder, events), **options)
    check = Parity(made)
    rows = rows_of(made, lambda row: row.update(check()))
    return made, rows, check.summary()


def test_first_frame_only(tmp_path):
    _, rows, _ = replay(tmp_path, [])
    assert len(rows) == 1 and rows[0]["level"] == 3 and rows[0]["refreshed"] == 1
    assert rows[0]["q_wall"] == pytest.approx(-1e8 * 0.01, rel=1e-5)
    assert rows[0]["residual"] < 1e-6


def test_refused_edits_are_recorded_and_the_replay_goes_on(tmp_path):
    events = [
        {"do": "undo"},
        {"do": "delete", "on": "left"},
        *drag("window", (0.5, 0.5), [(0.52, 0.5), (5.0, 0.5), (0.54, 0.5)]),
        {"do": "hole", "name": "other", "center": [0.5, 0.5], "radius": 0.05},
        {"do": "set", "key": "material.steel.nu", "value": 0.7},
    ]
    _, rows, parity = replay(tmp_path, events)
    refused = [bool(row["refused"]) for row in rows]
    assert refused == [False, True, True, False, False, True, False, False, True, True]
    assert rows[5]["level"] == 0 and rows[5]["q_stretch"] == rows[4]["q_stretch"]
    assert rows[6]["level"] == 1 and rows[6]["q_stretch"] != rows[4]["q_stretch"]
    assert parity["holds"]


FORMULA = plate().replace('traction = ["100 MPa", 0]', 'traction = ["S*sqrt(limit - x)", 0]') + (
    "[parameters]\nS = 1e8\nlimit = 2.05\n"
)


def test_a_formula_without_a_number_refuses_its_frames_only(tmp_path):
    # The pulled side leaves the place where its load means something, and comes back.
    path = [(2.02, 0.5), (2.06, 0.5), (2.07, 0.5), (2.01, 0.5)]
    _, rows, parity = replay(tmp_path, drag("right", (2.0, 0.5), path), FORMULA)
    assert [bool(row["refused"]) for row in rows] == [False, False, False, True, True, False, False]
    assert "x = 2.06" in rows[3]["refused"] and "loads.pull.traction" in rows[3]["refused"]
    assert rows[3]["q_stretch"] == rows[2]["q_stretch"]
    assert rows[5]["q_wall"] == pytest.approx(-1e8 * np.sqrt(0.04) * 0.01, rel=1e-5)
    assert parity["holds"]


def test_first_shape_without_a_solution_stops_the_replay(tmp_path):
    scene = write_scene(tmp_path, FORMULA.replace("2.05", "1.9"))
    with pytest.raises(UserError, match="not a finite number"):
        rows_of(make_replay(scene))


POINT = plate().replace(PULLED, '[loads.pull]\non = "c"\nforce = ["S*sqrt(limit - x)", 0]\n') + (
    "[parameters]\nS = 1e6\nlimit = 2.05\n"
)


@pytest.mark.parametrize("text", [FORMULA, POINT], ids=["traction", "force"])
def test_frames_without_solution_on_new_meshes_are_recorded(tmp_path, text):
    # New holes make new meshes while the load has no number; what is recorded fits together all the same.
    holes = [{"do": "hole", "name": f"h{k}", "center": [1.0 + 0.3 * k, 0.5], "radius": 0.1} for k in range(3)]
    bad, good = ({"do": "set", "key": "parameters.limit", "value": v} for v in (1.0, 2.05))
    events = [bad, holes[0], {"do": "idle"}, holes[1], good, holes[2], *drag("h1", (1.3, 0.5), [(1.31, 0.5)])]
    scene, script = write_scene(tmp_path, text), write_script(tmp_path, events)
    asked = columns(["stretch", "peak", "wall", "energy"])
    with Recorder.start(tmp_path / "a.vtkhdf", {}, asked) as recorder:
        made = make_replay(scene, script, recorder=recorder)
        check = Parity(made)
        rows = rows_of(made, lambda row: check())
    assert [bool(row["refused"]) for row in rows] == [False, True, True, True, True] + 5 * [False]
    assert check.summary()["holds"]
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.n == len(rows) and recording.verify() == []
        for i, row in enumerate(rows):
            X, cells = recording.mesh(i)
            assert len(cells) == row["elements"] and cells.max() == len(X) - 1
            assert len(recording.field(i, "displacement")) == len(X)
    cold = make_replay(scene, write_script(tmp_path, [good, *holes], "cold.jsonl"))
    assert rows[6]["q_stretch"] == pytest.approx(rows_of(cold)[-1]["q_stretch"], rel=1e-4)


def test_taking_the_supports_away_is_refused(tmp_path):
    events = [
        {"do": "set", "key": "supports.wall.fix", "value": ["x"]},
        *drag("window", (0.5, 0.5), [(0.51, 0.5)]),
        {"do": "undo"},
        {"do": "undo"},
        *drag("window", (0.5, 0.5), [(0.52, 0.5)]),
    ]
    _, rows, parity = replay(tmp_path, events)
    assert "free to move" in rows[1]["refused"] and "Traceback" not in rows[1]["refused"]
    assert not any(row["refused"] for row in rows[6:])
    assert parity["holds"]


def test_flips_of_frames_without_solution_are_not_lost(tmp_path):
    # The load has no number while the hole crosses the plate and edges flip; undo brings the first values back.
    bad = {"do": "set", "key": "parameters.limit", "value": 1.0}
    far = drag("window", (0.5, 0.5), across((0.5, 0.5), (0.75, 0.5), 20))
    events = [*drag("window", (0.5, 0.5), [(0.501, 0.5)]), bad, *far, {"do": "undo"}, {"do": "undo"}]
    _, rows, parity = replay(tmp_path, events, FORMULA, relocation="laplacian", criterion="author")
    assert sum(bool(row["refused"]) for row in rows) >= 20
    assert not rows[-1]["refused"] and parity["holds"]


def test_supports_of_frames_without_solution_are_forgotten(tmp_path):
    events = [
        {"do": "set", "key": "parameters.limit", "value": 1.0},
        {"do": "set", "key": "supports.wall.on", "value": "bottom"},
        {"do": "undo"},
        {"do": "undo"},
        *drag("window", (0.5, 0.5), [(0.51, 0.5)]),
    ]
    _, rows, parity = replay(tmp_path, events, POINT)
    assert [bool(row["refused"]) for row in rows] == [False, True, True, True, False, False, False, False]
    assert rows[-1]["q_wall"] == pytest.approx(-1e6 * np.sqrt(0.05), rel=1e-5)
    assert parity["holds"]


def test_values_change_what_they_say(tmp_path):
    events = [
        {"do": "set", "key": "material.steel.E", "value": "100 GPa"},
        {"do": "set", "key": "loads.pull.traction", "value": ["200 MPa", 0]},
        {"do": "set", "key": "mesh.size", "value": 0.1},
        {"do": "undo"},
        {"do": "redo"},
    ]
    _, rows, parity = replay(tmp_path, events)
    stretch = [row["q_stretch"] for row in rows]
    assert stretch[1] == pytest.approx(2 * stretch[0], rel=1e-5)
    assert stretch[2] == pytest.approx(4 * stretch[0], rel=1e-5)
    assert [row["level"] for row in rows] == [3, 0, 0, 3, 3, 3]
    assert stretch[4] == pytest.approx(stretch[2], rel=1e-5)
    assert parity["holds"]


def test_supports_that_change_under_a_kept_mesh(tmp_path):
    events = [{"do": "set", "key": "supports.wall.on", "value": "right"}, {"do": "undo"}]
    text = plate().replace('on = "right"\ntraction', 'on = "top"\ntraction')
    _, rows, parity = replay(tmp_path, events, text)
    assert parity["holds"]
    assert rows[1]["q_wall"] == pytest.approx(0.0, abs=1e-3) and rows[2]["q_wall"] == pytest.approx(-2e6, rel=1e-5)
