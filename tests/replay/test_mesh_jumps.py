"""Jumps of quantities where the mesh changes: against steps of the replay itself, and at what they must not touch."""

import json
import math
from functools import partial

import numpy as np
import pytest
from cloths import PIN, write_cloth
from matplotlib.collections import LineCollection
from small_scenes import across, drag, make_replay, plate, rows_of, write_scene, write_script

from restshape.analysis.made_analysis import made_analysis
from restshape.analysis.motion.transient import TransientAnalysis
from restshape.analysis.static.steady import SteadyAnalysis
from restshape.application import application
from restshape.errors import UserError
from restshape.mesh.moved_meshes import OtherMesh
from restshape.mesh.moving import MovingMesh
from restshape.mesh.quality import areas
from restshape.replay.columns import columns_of
from restshape.replay.constraints import FAILS, HOLDS, UNCERTAIN, Limit
from restshape.replay.mesh_jumps import OTHER_EDGES, MeshJumps
from restshape.replay.recording.recorder import Recorder
from restshape.replay.recording.recording import Recording
from restshape.replay.summary import summarise
from restshape.replay.uncertain_limits import UncertainLimits
from restshape.report.quantity_panels import draw_quantities
from restshape.report.tables import jumped
from restshape.scene.load import load_scene

ASKED = ["solve.jumps=true"]
SHAKEN = drag("window", (0.5, 0.5), across((0.5, 0.5), (1.0, 0.5), 60))
FINE = drag("window", (0.5, 0.5), across((0.5, 0.5), (1.1, 0.5), 200))
COARSE = drag("window", (0.5, 0.5), across((0.5, 0.5), (1.4, 0.5), 3))


@pytest.mark.parametrize("order", [1, 2])
def test_a_step_is_the_jump_and_what_the_hand_does(tmp_path, order):
    """The hand goes on evenly, so that a step without its jump is like those beside it."""
    scene, script = write_scene(tmp_path, plate(0.2)), write_script(tmp_path, FINE)
    overrides = [*ASKED, f"mesh.order={order}", "solve.tolerance=1e-9"]
    rows = [row for row in rows_of(make_replay(scene, script, overrides=overrides)) if row["event"] == "drag"]
    steps = np.diff([row["q_stretch"] for row in rows])
    jumps = np.array([row["stretch_jump"] for row in rows[1:]])
    levels = np.array([row["level"] for row in rows[1:]])
    np.testing.assert_array_equal(np.isfinite(jumps), levels > 1)
    assert {2, 3} <= set(levels)
    known = np.nan_to_num(jumps)
    quiet = steps - known
    for k in np.flatnonzero(np.abs(known) > 20.0 * np.median(np.abs(quiet))):
        assert abs(quiet[k]) <= 0.1 * abs(known[k])
    # Without the jumps the curve is smoother by far.
    assert np.abs(np.diff(quiet)).max() < 0.2 * np.abs(np.diff(steps)).max()


def test_long_steps_are_compared_on_the_shape_before(tmp_path, monkeypatch):
    """Where the old triangles do not bear the new shape, the new mesh goes back to the old one."""
    seen = []
    noted = MeshJumps.note

    def note(self, moving, mesh_update):
        noted(self, moving, mesh_update)
        seen.extend((other, moving.mesh) for other in self._others() if other.before)

    monkeypatch.setattr(MeshJumps, "note", note)
    replay = make_replay(write_scene(tmp_path, plate(0.1)), write_script(tmp_path, COARSE), overrides=ASKED)
    rows = rows_of(replay)
    assert seen
    for other, mesh in seen:
        back = other.mesh.mesh
        assert back.outline is not mesh.outline and areas(back.X, back.cells).min() > 0.0
        np.testing.assert_array_equal(back.cells, mesh.cells)
    changed = [row for row in rows[1:] if row["level"] > 1]
    assert changed and all(abs(row["energy_jump"]) < 0.05 * row["q_energy"] for row in changed)


def test_frames_whose_shape_has_other_edges_say_that_they_have_none(tmp_path):
    """A hole far away is cut and deleted: a new mesh each time, with no shape in common with the old one."""
    events = [{"do": "hole", "name": "far", "center": [1.7, 0.5], "radius": 0.1}, {"do": "delete", "on": "far"}]
    scene, script = write_scene(tmp_path, plate(0.2)), write_script(tmp_path, [*COARSE, *events])
    rows = rows_of(make_replay(scene, script, overrides=ASKED))
    said = [row["event"] for row in rows if OTHER_EDGES in row["note"]]
    assert said == ["hole", "delete"]
    compared = [row for row in rows[1:] if row["level"] == 3 and row["event"] == "drag"]
    assert compared and all(np.isfinite(row["energy_jump"]) for row in compared)
    unsaid = rows_of(make_replay(scene, script, overrides=["solve.jumps=false"]))
    assert not any(OTHER_EDGES in row["note"] for row in unsaid)


def test_they_change_no_frame_and_can_be_left_out(tmp_path):
    scene, script = write_scene(tmp_path, plate(0.2)), write_script(tmp_path, FINE[:1] + FINE[1:])
    found = {}
    for words in ((), ("solve.jumps=false",)):
        replay = make_replay(scene, script, overrides=words)
        found[words] = [(replay.analysis.x.tobytes(), row["iterations"], row["pc_age"]) for row in replay.frames()]
    assert found[()] == found["solve.jumps=false",]
    app = application("plane")
    assert not any(name.endswith("_jump") for name in columns_of(load_scene(scene, ["solve.jumps=false"]), app))
    assert "energy_jump" in columns_of(load_scene(scene), app)


@pytest.mark.slow
def test_a_limit_that_a_jump_of_the_mesh_passes_is_uncertain(tmp_path):
    """On the old mesh the quantity holds, on the new one of the same shape it fails: neither is known."""
    script = write_script(tmp_path, FINE)
    rows = rows_of(make_replay(write_scene(tmp_path, plate(0.2)), script, overrides=ASKED))
    changed = next(row for row in rows[1:] if row["level"] == 3)
    value, jump = changed["q_stretch"], changed["stretch_jump"]
    far = 2.0 * abs(jump)
    statuses = {}
    for bound in (value - 0.5 * jump, value + far, value - far):
        limit = "stretch = { " + f"max = {bound!r}, error = false,"
        scene = write_scene(tmp_path, plate(0.2).replace("stretch = {", limit))
        statuses[bound] = rows_of(make_replay(scene, script, overrides=ASKED))[changed["index"]]
    found = statuses[value - 0.5 * jump]
    assert found["constraint_status"] == UNCERTAIN and not found["violated_constraints"]
    assert "stretch fails, but uncertain: " in found["note"] or "stretch holds, but uncertain: " in found["note"]
    assert found["note"].endswith(": a jump of the mesh")
    assert statuses[value + far]["constraint_status"] == HOLDS
    assert statuses[value - far]["constraint_status"] == FAILS and statuses[value - far]["violated_constraints"]


def test_a_jump_counts_until_the_next_new_mesh():
    found = partial(UncertainLimits({}), limits={"q": Limit(most=1.0)})
    frames = [(3, 0.2), (1, math.nan), (2, 0.01), (3, 0.001), (1, math.nan)]
    statuses = [found(known_row(0.9, level, jump)).get("constraint_status", HOLDS) for level, jump in frames]
    assert statuses == [UNCERTAIN] * 3 + [HOLDS] * 2


def test_what_an_application_finds_wrong_stays_wrong():
    for status in (FAILS, UNCERTAIN):
        own = {"constraint_status": status, "violated_constraints": "loose"}
        limits = partial(UncertainLimits({}, lambda own=own: own), limits={"q": Limit(most=1.0)})
        found = limits(known_row(1.05, 3, 0.2) | own)
        assert found["constraint_status"] == status and found["violated_constraints"] == "loose"


def known_row(value, level, jump):
    """What counts of a row with one quantity, whose mesh made it jump."""
    return {
        "q_q": value,
        "level": level,
        "q_jump": jump,
        "constraint_status": HOLDS,
        "predicted": 0,
        "estimate_time": math.nan,
    }


def test_summary_has_the_largest(tmp_path):
    scene, script = write_scene(tmp_path, plate(0.2)), write_script(tmp_path, FINE)
    rows = rows_of(make_replay(scene, script, overrides=ASKED))
    found = summarise(rows, "auto", 1)["jumps"]
    for name in ("stretch", "energy"):
        sizes = np.abs([row[f"{name}_jump"] for row in rows])
        k = int(np.nanargmax(sizes))
        size = max(abs(row[f"q_{name}"]) for row in rows)
        assert found[name] == {"largest": sizes[k], "share": sizes[k] / size, "frame": k}
    json.dumps(found, allow_nan=False)


@pytest.mark.slow
def test_reports_mark_large_ones(tmp_path, monkeypatch):
    scene, script = write_scene(tmp_path, plate(0.2)), write_script(tmp_path, FINE)
    replay = make_replay(scene, script, overrides=ASKED)
    loaded = replay.session.scene
    with Recorder.start(tmp_path / "a.vtkhdf", {}, columns_of(loaded, application("plane"))) as recorder:
        replay.recorder = recorder
        rows = rows_of(replay)
    sizes = {name: max(abs(row[f"q_{name}"]) for row in rows) for name in loaded.quantities}
    bounded = sizes.keys() - {"peak"}
    worst = [max(abs(row[f"{name}_jump"]) / sizes[name] for name in bounded) for row in rows]
    with Recording(tmp_path / "a.vtkhdf") as recording:
        for least in (0.0005, 0.005):
            np.testing.assert_array_equal(jumped(recording, least), np.flatnonzero(np.array(worst) > least))
        drawn = []
        monkeypatch.setattr("restshape.report.quantity_panels.save_picture", lambda figure, path: drawn.append(figure))
        assert draw_quantities(recording, tmp_path / "q.png")
    panel = next(axes for axes in drawn[0].axes if axes.get_title(loc="left") == "energy")
    bars = next(one for one in panel.collections if isinstance(one, LineCollection)).get_segments()
    changed = [row for row in rows if np.isfinite(row["energy_jump"])]
    assert len(bars) == len(changed)
    for bar, row in zip(bars, changed):
        found = bar[:, 1] / row["q_energy"]
        np.testing.assert_allclose(found / found[1], [1.0 - row["energy_jump"] / row["q_energy"], 1.0], rtol=1e-9)


MOVING = (
    plate(0.2).replace('app = "plane"', 'app = "moving"').partition("[quantities]")[0]
    + "[effects.dynamics]\ntime_step = 2e-4\nsteps = 4\n[effects.ground]\nacceleration = 50\nfrequency = 100\n"
    + '[quantities]\nstrain = { energy = "strain" }\nedit = { energy = "edit" }\nremesh = { energy = "remesh" }\n'
    + 'peak = { displacement = "x", at = "c", reduce = "peak" }\nwall = { reaction = "x", at = "left" }\n'
)


@pytest.mark.slow
@pytest.mark.parametrize(
    "effects", ["", "[effects.large_deformation]\n", "[effects.damping]\nalpha = 3\nbeta = 1e-4\n"]
)
def test_motion_on_the_very_mesh_of_a_frame_is_the_frames_own(tmp_path, monkeypatch, effects):
    """Beside another mesh that is no other, nothing jumps: the steps from the state before are those of the frame."""
    monkeypatch.setattr(MovingMesh, "other_meshes", lambda moving, _: (OtherMesh(moving.field_mesh, before=False),))
    scene, script = write_scene(tmp_path, MOVING + effects), write_script(tmp_path, SHAKEN)
    rows = rows_of(make_replay(scene, script, overrides=["solve.tolerance=1e-10"]))
    sizes = {key: max(abs(row[f"q_{key}"]) for row in rows) for key in ("strain", "edit", "remesh", "peak", "wall")}
    flipped = [row for row in rows[1:] if row["level"] == 2]
    assert len(flipped) > 1 and all(np.isnan(row["strain_jump"]) for row in rows if row["level"] == 1)
    for row in flipped:
        for key, size in sizes.items():
            assert abs(row[f"{key}_jump"]) <= 1e-6 * size, key


def test_motion_jumps_where_the_mesh_changes(tmp_path):
    """What a new mesh adds to the energy is known from the account of energies, too."""
    rows = rows_of(make_replay(write_scene(tmp_path, MOVING), write_script(tmp_path, SHAKEN)))
    levels = [row["level"] for row in rows]
    assert {1, 2, 3} <= set(levels[1:])
    assert all(np.isfinite(row["strain_jump"]) == (row["level"] > 1) for row in rows[1:])
    added = np.diff([row["q_remesh"] for row in rows])
    for row, more in zip(rows[1:], added):
        if row["level"] > 1:
            assert row["remesh_jump"] == pytest.approx(more, rel=1e-9, abs=1e-12)
            assert 0.0 < abs(row["strain_jump"]) < 0.02 * max(row["q_strain"] for row in rows)


@pytest.mark.slow
def test_motion_that_an_old_mesh_does_not_bear_is_compared_on_the_shape_before(tmp_path):
    """Of second order a new mesh comes where a placement is invalid: the state before is brought to the new mesh."""
    made = make_replay(write_scene(tmp_path, MOVING), write_script(tmp_path, SHAKEN), overrides=["mesh.order=2"])
    rows = rows_of(made)
    new = [row for row in rows[1:] if row["level"] == 3]
    assert new
    for row in new:
        before = rows[row["index"] - 1]
        assert 0.0 < abs(row["strain_jump"]) < 0.05 * before["q_strain"] and np.isnan(row["peak_jump"])
        # Interpolation and projection lose energy, about what the frame's own lose, whose shape is the next one.
        assert row["remesh_jump"] == pytest.approx(row["q_remesh"] - before["q_remesh"], rel=0.7)
        assert row["remesh_jump"] < 0.0 and abs(row["edit_jump"]) < 1e-9 * abs(before["q_edit"])


def test_motion_of_second_order_goes_on_where_flips_follow_flips(tmp_path):
    """A flipped edge keeps the number of its node, which a new mesh of the same triangles would number again."""
    settings = ["mesh.order=2", "mesh.min_quality=0.45"]
    made = make_replay(write_scene(tmp_path, MOVING), write_script(tmp_path, SHAKEN), overrides=settings)
    rows = rows_of(made)
    flipped = [row for row in rows[1:] if row["level"] == 2]
    assert len(flipped) > 3
    for key in ("strain", "edit"):
        size = max(abs(row[f"q_{key}"]) for row in rows)
        assert all(0.0 < abs(row[f"{key}_jump"]) < 0.02 * size for row in flipped), key


def test_cloth_whose_folds_are_one_answer_of_several_is_refused(tmp_path):
    scene = write_cloth(tmp_path, PIN)
    with pytest.raises(UserError, match=r"solve\.jumps"):
        make_replay(scene, write_script(tmp_path, []), overrides=ASKED)
    assert not any(name.endswith("_jump") for name in columns_of(load_scene(scene), application("cloth")))


@pytest.mark.mpi
def test_two_ranks_find_the_same_errors_and_jumps(tmp_path, on_ranks):
    text = plate(0.2).replace("energy = {", "energy = { error = true,")
    scene, script = write_scene(tmp_path, text), write_script(tmp_path, COARSE)
    found = []
    for ranks in (1, 2):
        words = ("--edits", script, "--set", "solve.tolerance=1e-9", "--set", *ASKED, "--json", f"{ranks}.json")
        done = on_ranks(ranks, "replay", scene, *words)
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    one, two = found
    assert two["quantity_errors"]["energy"] == pytest.approx(one["quantity_errors"]["energy"], rel=0.02)
    assert two["jumps"]["energy"]["largest"] == pytest.approx(one["jumps"]["energy"]["largest"], rel=1e-4)


SINGLE = MOVING.replace("steps = 4", "steps = 1").replace(
    'edit = { energy = "edit" }\nremesh = { energy = "remesh" }\n', ""
)
STEPS = {
    "statics": plate(0.2),
    "motion": SINGLE,
    "damped motion": SINGLE + "[effects.damping]\nalpha = 3\nbeta = 1e-4\n",
}


@pytest.mark.slow
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("text", STEPS.values(), ids=STEPS)
def test_flips_are_seen_with_what_is_kept_as_by_a_solve_with_nothing_kept(tmp_path, monkeypatch, text, order):
    """Conjugate gradients with the frame's preconditioner, from the frame's answer, beside a pattern and a factor."""
    settings = [*ASKED, f"mesh.order={order}", "solve.tolerance=1e-10", "mesh.min_quality=0.45"]
    scene, script = write_scene(tmp_path, text), write_script(tmp_path, SHAKEN)
    found, made = [], []
    monkeypatch.setattr(
        "restshape.replay.mesh_jumps.made_analysis", lambda *args: made.append(1) or made_analysis(*args)
    )
    for beside in (True, False):
        if not beside:
            for kind in (SteadyAnalysis, TransientAnalysis):
                monkeypatch.setattr(kind, "observed_beside", lambda *_: None)
        rows = rows_of(make_replay(scene, script, overrides=settings))
        flipped = [row for row in rows[1:] if row["level"] == 2]
        found.append([{key: row[key] for key in row if key.endswith("_jump")} for row in flipped])
        made.append(0)
    ours, theirs = found
    assert len(ours) > 1 and sum(made[: made.index(0)]) <= sum(made) - sum(made[: made.index(0)]) - len(ours)
    for key in ours[0]:
        jumps = np.array([row[key] for row in theirs])
        size = max(abs(row[f"q_{key.removesuffix('_jump')}"]) for row in rows)
        np.testing.assert_allclose(
            [row[key] for row in ours], jumps, rtol=0, atol=2e-3 * abs(jumps).max() + 1e-8 * size
        )
