"""The frame loop: what happens to frames that cannot be computed."""

import numpy as np
import pytest
from small_scenes import PULLED, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.application import application
from restshape.errors import ReplayProblem, UserError
from restshape.replay.columns import columns_of
from restshape.replay.parity import Parity
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.scene.load import load_scene


def replay(folder, events, text=None, **options):
    """The rows of a replay of the plate, and whether each agrees with a cold solve."""
    made = make_replay(write_scene(folder, text or plate()), write_script(folder, events), **options)
    check = Parity(made)
    rows = rows_of(made, lambda row: row.update(check()))
    return made, rows, check.summary()


def test_first_frame_only(tmp_path):
    _, rows, _ = replay(tmp_path, [])
    assert len(rows) == 1 and rows[0]["level"] == 3 and rows[0]["pc_rebuilt"] == 1
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
    assert [row["stale"] for row in rows] == [int(one) for one in refused]
    for row in rows:
        numbers = [row[name] for name in ("q_stretch", "q_peak", "q_wall", "residual")]
        assert np.isnan(numbers).all() if row["stale"] else np.isfinite(numbers).all()
    assert rows[5]["level"] == 0 and rows[6]["q_stretch"] != rows[4]["q_stretch"]
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
    assert np.isnan(rows[3]["q_stretch"])
    assert rows[5]["q_wall"] == pytest.approx(-1e8 * np.sqrt(0.04) * 0.01, rel=1e-5)
    assert parity["holds"]


def test_first_shape_without_a_solution_stops_the_replay(tmp_path):
    scene = write_scene(tmp_path, FORMULA.replace("2.05", "1.9"))
    with pytest.raises(UserError, match="not a finite number"):
        rows_of(make_replay(scene))


POINT = plate().replace(PULLED, '[loads.pull]\non = "c"\nforce = ["S*sqrt(limit - x)", 0]\n') + (
    "[parameters]\nS = 1e6\nlimit = 2.05\n"
)


@pytest.mark.slow
@pytest.mark.parametrize("text", [FORMULA, POINT], ids=["traction", "force"])
@pytest.mark.parametrize("policy", ["auto", "rebuild"])
def test_frames_without_solution_on_new_meshes_are_taken_back(tmp_path, text, policy):
    # The side jumps so far that a new mesh is made, on which the load has no number; then all goes on from before.
    far = drag("right", (2.0, 0.5), [(2.01, 0.5), (4.5, 0.5), (4.6, 0.5)])
    hole = {"do": "hole", "name": "h", "center": [1.3, 0.5], "radius": 0.1}
    near = drag("h", (1.3, 0.5), [(1.31, 0.5)])
    scene = write_scene(tmp_path, text)
    script = write_script(tmp_path, [*far, {"do": "idle"}, hole, *near])
    with Recorder.start(tmp_path / "a.vtkhdf", {}, columns_of(load_scene(scene), application("plane"))) as recorder:
        made = make_replay(scene, script, policy, recorder=recorder)
        check = Parity(made)
        rows = rows_of(made, lambda row: check())
    assert [bool(row["refused"]) for row in rows] == [False] * 3 + [True] * 2 + [False] * 6
    assert check.summary()["holds"]
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.n == len(rows) and recording.verify() == []
        for i, row in enumerate(rows):
            X, cells = recording.mesh(i)
            assert len(cells) == row["elements"] and cells.max() == len(X) - 1
            assert len(recording.field(i, "displacement")) == len(X)
        for i in (3, 4, 5, 6):
            assert np.array_equal(recording.mesh(i)[0], recording.mesh(2)[0])
            assert np.array_equal(recording.mesh(i)[1], recording.mesh(2)[1])
        assert recording.mesh(2)[0][:, 0].max() == pytest.approx(2.01, rel=1e-12)
    for row in rows[5:7]:
        assert row["q_stretch"] == pytest.approx(rows[2]["q_stretch"], rel=1e-5)
    allowed = [*drag("right", (2.0, 0.5), [(2.01, 0.5)]), hole, *near]
    cold = rows_of(make_replay(scene, write_script(tmp_path, allowed, "cold.jsonl"), policy))
    assert rows[-1]["q_stretch"] == pytest.approx(cold[-1]["q_stretch"], rel=1e-4)


def test_a_refused_value_is_taken_back(tmp_path):
    events = [
        {"do": "set", "key": "parameters.limit", "value": 1.0},
        *drag("window", (0.5, 0.5), [(0.51, 0.5)]),
        {"do": "undo"},
        {"do": "undo"},
    ]
    made, rows, parity = replay(tmp_path, events, FORMULA)
    assert [bool(row["refused"]) for row in rows] == [False, True, False, False, False, False, True]
    assert "not a finite number" in rows[1]["refused"] and rows[-1]["refused"] == "there is nothing to undo"
    assert made.session.scene.parameters["limit"] == 2.05 and parity["holds"]
    assert np.isnan(rows[1]["q_stretch"])
    assert rows[5]["q_stretch"] == pytest.approx(rows[0]["q_stretch"], rel=1e-5)


MOTION = "[effects.dynamics]\ntime_step = 1e-4\n"
EFFECTS = (
    ("plane", ""),
    ("plane", "[effects.large_deformation]\n"),
    ("plane", "[effects.buckling]\n"),
    ("vibration", MOTION),
    ("vibration", MOTION + "[effects.large_deformation]\n"),
)


@pytest.mark.parametrize(("app", "effects"), EFFECTS)
def test_a_frame_without_a_solution_is_taken_back_by_one_assignment(tmp_path, app, effects):
    path = [(2.02, 0.5), (2.06, 0.5), (2.01, 0.5)]
    scene = write_scene(tmp_path, FORMULA.replace('"plane"', f'"{app}"') + effects)
    made = make_replay(scene, write_script(tmp_path, drag("right", (2.0, 0.5), path)))
    known, refused = {}, []
    for row in made.frames():
        present = dict(vars(made.analysis))
        if row["refused"]:
            refused.append(row["index"])
            assert {name for name, value in present.items() if value is not known[name]} == {"state"}
            before, state = vars(known["state"]), vars(present["state"])
            assert {name for name, value in state.items() if value is not before[name]} == {"interrupted"}
        assert made.analysis.state.interrupted == bool(row["refused"])
        known = present
    assert refused == [3]


def test_taking_the_supports_away_is_refused(tmp_path):
    events = [
        {"do": "set", "key": "supports.wall.fix", "value": ["x"]},
        *drag("window", (0.5, 0.5), [(0.51, 0.5)]),
        {"do": "undo"},
        *drag("window", (0.5, 0.5), [(0.52, 0.5)]),
    ]
    _, rows, parity = replay(tmp_path, events)
    assert "free to move" in rows[1]["refused"] and "Traceback" not in rows[1]["refused"]
    assert not any(row["refused"] for row in rows[2:])
    assert parity["holds"]


@pytest.mark.parametrize(
    ("size", "end", "good", "first"),
    [(0.08, 0.8, [0.55, 0.6, 0.64], 0.66), (0.12, 0.78, [0.55, 0.6], 0.64)],
    ids=["later", "at once"],
)
def test_flips_of_frames_without_solution_are_taken_back(tmp_path, size, end, good, first):
    # The load on the hole has no number beyond x = end, where edges flip, in the first frame without a solution or in
    # a later one, or a new mesh is needed; then it comes back.
    text = plate(size) + f'[loads.blown]\non = "window"\npressure = "S*sqrt({end} - x)"\n[parameters]\nS = 1e6\n'
    away = [(x, 0.5) for x in np.linspace(first, 1.0, 18)]
    path = [*((x, 0.5) for x in good), *away, (good[-1], 0.5), (good[-1] - 0.02, 0.5), (0.4, 0.5)]
    scene, script = write_scene(tmp_path, text), write_script(tmp_path, drag("window", (0.5, 0.5), path))
    seen, refused, levels = [], [], []
    made = make_replay(scene, script, "thesis")
    check, update, rollback = Parity(made), made.moving.update, made.moving.rollback

    def noted(edit):
        levels.append(update(edit))
        return levels[-1]

    def watched():
        seen.append(made.moving.mesh.cells.tobytes())
        rollback()

    made.moving.update, made.moving.rollback = noted, watched
    for row in made.frames():
        check()
        cells = made.moving.mesh.cells.tobytes()
        if row["refused"]:
            refused.append((cells != seen[-1], levels[-1].level))
            assert "loads.blown.pressure" in row["refused"]
            assert made.moving.mesh.X[:, 0].max() == 2.0 and made.analysis.space is made.moving.mesh
    assert len(refused) == len(away) and any(changed for changed, _ in refused)
    assert (refused[0] == (True, 2)) == (first == 0.64)
    assert not row["refused"] and check.summary()["holds"]
    centre = made.session.outline.centroid(made.session.outline.entity("window"))
    np.testing.assert_allclose(centre, [0.4, 0.5], atol=1e-12)


def test_supports_of_frames_without_solution_are_forgotten(tmp_path):
    wrong = {"on": "bottom", "fix": {"x": "sqrt(0.5 - x)", "y": 0}}
    events = [
        {"do": "set", "key": "supports.wall", "value": wrong},
        {"do": "set", "key": "supports.wall.on", "value": "bottom"},
        {"do": "undo"},
        *drag("window", (0.5, 0.5), [(0.51, 0.5)]),
    ]
    _, rows, parity = replay(tmp_path, events, POINT)
    assert [bool(row["refused"]) for row in rows] == [False, True, False, False, False, False, False]
    assert np.isnan(rows[1]["q_wall"])
    for row in rows[3:]:
        assert row["q_wall"] == pytest.approx(-1e6 * np.sqrt(0.05), rel=1e-5)
    assert parity["holds"]


@pytest.mark.parametrize("policy", ["auto", "thesis", "refactor", "rebuild"])
def test_a_solver_that_fails_on_a_new_mesh_serves_the_one_before(tmp_path, policy):
    events = drag("window", (0.5, 0.5), [(0.51, 0.5), (1.5, 0.45), (0.52, 0.5), (0.53, 0.5)])
    made = make_replay(write_scene(tmp_path, plate()), write_script(tmp_path, events), policy)
    solve, sizes = made.analysis.solver.solve, []

    def once_in_vain(*words, **options):
        report = solve(*words, **options)
        sizes.append(words[0].size[0])
        if len(sizes) == 3:
            raise ReplayProblem("no convergence today")
        return report

    made.analysis.solver.solve = once_in_vain
    check = Parity(made)
    rows = rows_of(made, lambda row: check())
    assert [row["refused"] for row in rows] == [""] * 3 + ["no convergence today"] + [""] * 3
    assert sizes[2] != sizes[1] and rows[3]["unknowns"] == rows[2]["unknowns"] == sizes[1]
    assert np.isnan(rows[3]["q_stretch"]) and check.summary()["holds"]


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
