"""Load factors along edits: reuse equals rebuild on all levels, ranks agree, recordings and statuses hold them."""

import json
from dataclasses import replace

import numpy as np
import pytest
from columns import FOOT, PUSHED, column
from small_scenes import across, drag, make_replay, rows_of, write_scene, write_script

from restshape.application import application
from restshape.replay.columns import columns_of
from restshape.replay.parity import Parity
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording

HOLE = "\n[shape.holes.window]\ncircle = { center = [0.4, 0.15], radius = 0.05 }\n"
WIDE = column(FOOT, PUSHED.format(1e6), height=0.3, size=0.06).replace("\n[material", HOLE + "\n[material", 1)
AROUND = drag("window", (0.4, 0.15), across((0.4, 0.15), (0.75, 0.17), 14))
THINNER = drag("top", (0.5, 0.3), across((0.5, 0.3), (0.5, 0.27), 6))
SET = [{"do": "set", "key": "loads.head.force", "value": [-2e6, 0]}, {"do": "undo"}]


@pytest.mark.slow
@pytest.mark.parametrize("order", [pytest.param(1, marks=pytest.mark.weekly), 2])
def test_reuse_equals_rebuild(tmp_path, order):
    text = WIDE.replace("order = 2", f"order = {order}").replace("tolerance = 1e-9", "tolerance = 1e-8")
    script = write_script(tmp_path, [*AROUND, *THINNER, *SET])
    replay = make_replay(write_scene(tmp_path, text), script)
    check = Parity(replay)
    rows = rows_of(replay, lambda row: row.update(check()))
    assert {row["level"] for row in rows} == {0, 1, 2, 3} and not any(row["refused"] for row in rows)
    assert check.summary()["holds"], check.summary()
    assert not any(row["missed_modes"] for row in rows)
    assert max(row["residual"] for row in rows) < 2e-8


@pytest.mark.slow
def test_old_factors_serve(tmp_path):
    events = drag("top", (0.5, 0.05), across((0.5, 0.05), (0.5, 0.04), 60))
    text = column(size=0.02).replace("tolerance = 1e-9", "tolerance = 1e-6")
    rows = rows_of(make_replay(write_scene(tmp_path, text), write_script(tmp_path, events)))[2:62]
    assert sum(row["pc_rebuilt"] for row in rows) < 30 and 3 <= sum(row["inertia_checked"] for row in rows) < 30
    assert np.mean([row["iterations"] for row in rows]) < 10


@pytest.mark.slow
@pytest.mark.parametrize("name", ["thesis", "refactor", "rebuild"])
def test_policies_agree(tmp_path, name):
    scene, script = write_scene(tmp_path, WIDE), write_script(tmp_path, [*THINNER, *SET])
    one, two = (rows_of(make_replay(scene, script, policy)) for policy in ("auto", name))
    same = 1e-7 if name == "refactor" else 5e-3
    np.testing.assert_allclose([r["q_first"] for r in two], [r["q_first"] for r in one], rtol=same)


def test_the_constraint_status_changes(tmp_path):
    text = column(height=0.05).replace("load_factor = 1 }", "load_factor = 1, at_least = 25 }")
    scene, events = write_scene(tmp_path, text), drag("top", (0.5, 0.05), across((0.5, 0.05), (0.5, 0.03), 12))
    rows = rows_of(make_replay(scene, write_script(tmp_path, events)))
    statuses = [row["constraint_status"] for row in rows]
    assert statuses == ["holds" if row["mu_1"] >= 25.0 else "fails" for row in rows]
    assert statuses[0] == "holds" and statuses[-1] == "fails"


def test_a_load_that_is_taken_away_leaves_nothing_to_buckle(tmp_path):
    """Load factors go with one over the load, and the parity check holds with a load and without."""
    text = column(height=0.05, size=0.05).replace("tolerance = 1e-9", "tolerance = 1e-6")
    scene, drawn = write_scene(tmp_path, text), drag("top", (0.5, 0.05), across((0.5, 0.05), (0.5, 0.045), 4))
    forces = ([0, 0], [-2000, 0], [-1000, 0])
    events = [*drawn, *({"do": "set", "key": "loads.head.force", "value": force} for force in forces)]
    replay = make_replay(scene, write_script(tmp_path, events))
    check = Parity(replay)
    *_, unloaded, double, single = rows_of(replay, lambda row: row.update(check()))
    assert np.isposinf(unloaded["mu_1"]) and unloaded["note"] == "nothing buckles: no load factor without a load"
    assert unloaded["constraint_status"] != "fails" and double["mu_1"] == pytest.approx(single["mu_1"] / 2, rel=1e-6)
    assert check.summary()["holds"], check.summary()


def test_a_refused_frame_leaves_all_as_it_was(tmp_path):
    """The supports are taken away for a frame."""
    events = [{"do": "set", "key": "supports.foot.fix", "value": ["x"]}, *THINNER]
    rows = rows_of(make_replay(write_scene(tmp_path, WIDE), write_script(tmp_path, events)))
    assert rows[1]["refused"]
    assert np.isnan(rows[1]["mu_1"]) and not any(row["refused"] for row in rows[2:])


@pytest.mark.slow
def test_recording(tmp_path):
    scene, script = write_scene(tmp_path, WIDE), write_script(tmp_path, [*AROUND[:2], {"do": "release"}])
    replay = make_replay(scene, script)
    path = tmp_path / "a.vtkhdf"
    recorder = Recorder.start(path, {"scene": "column"}, columns_of(replay.session.scene, application("plane")))
    replay.recorder = recorder
    rows = rows_of(replay)
    recorder.close("finished")
    with Recording(path) as recording:
        np.testing.assert_array_equal(recording.table["mu_2"], [row["mu_2"] for row in rows])
        first, last = (recording.field(i, "buckling_mode_1") for i in (0, recording.n - 1))
        for shape in (first, last):
            assert np.linalg.norm(shape, axis=1).max() == pytest.approx(1.0)
        X, _ = recording.mesh(0)
        # Clamped at the left, it bends at the right.
        assert np.abs(first[X[:, 0] == 0.0]).max() == 0.0 and X[np.argmax(np.abs(first[:, 1])), 0] > 0.9


@pytest.mark.slow
@pytest.mark.mpi
def test_two_ranks(tmp_path, on_ranks):
    scene = write_scene(tmp_path, WIDE)
    around = drag("window", (0.4, 0.15), across((0.4, 0.15), (0.7, 0.17), 4))
    script, found = write_script(tmp_path, [*around, *SET]), []
    for ranks in (1, 2):
        words = ("--edits", script, "--json", f"{ranks}.json", "--set", "solve.tolerance=1e-8", "--parity")
        done = on_ranks(ranks, "replay", scene, *words)
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    one, two = found
    assert one["parity"]["holds"] and two["parity"]["holds"] and one["levels"] == two["levels"]
    for quantity in ("first", "second"):
        np.testing.assert_allclose(two["quantities"][quantity], one["quantities"][quantity], rtol=1e-6)


def test_what_rounding_leaves_of_a_slender_column_is_no_difference(tmp_path):
    """Of 400 times its thickness: entries of its stiffness are beyond 1e16 times what bends it."""
    text = column(height=0.0025, size=0.002).replace("tolerance = 1e-9", "tolerance = 1e-6")
    events = drag("top", (0.5, 0.0025), across((0.5, 0.0025), (0.5, 0.0028), 4))
    replay = make_replay(write_scene(tmp_path, text), write_script(tmp_path, events))
    check = Parity(replay)
    rows_of(replay, lambda row: row.update(check()))
    assert check.summary()["holds"], check.summary()
    modes = replay.analysis.state.modes
    state = replay.analysis.state
    replay.analysis.state = replace(state, modes=replace(modes, load_factors=modes.load_factors * (1.0 + 3e-5)))
    assert replay.analysis.compare_cold().solution > replay.analysis.tolerance


def test_a_column_without_strains_meets_a_cold_solve(tmp_path):
    """It goes along x as it is: its strain energy is rounding, to which no difference is compared."""
    ends = '\n[supports.ends]\non = ["left", "right"]\nfix = { x = 0.2, y = 0 }\n'
    replay = make_replay(write_scene(tmp_path, column(ends, "", size=0.02)), write_script(tmp_path, []))
    check = Parity(replay)
    rows_of(replay, lambda row: row.update(check()))
    assert check.summary()["holds"], check.summary()


def test_load_factors_that_are_no_numbers_meet_no_others(tmp_path):
    replay = make_replay(write_scene(tmp_path, column()), write_script(tmp_path, []))
    rows_of(replay)
    modes = replay.analysis.state.modes
    modes = replace(modes, load_factors=np.nan * modes.load_factors)
    replay.analysis.state = replace(replay.analysis.state, modes=modes)
    assert np.isnan(replay.analysis.compare_cold().solution)
