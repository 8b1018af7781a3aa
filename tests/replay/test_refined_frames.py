"""Drags on a coarse mesh, shown on a fine one: what is shown, when the fine mesh is solved, and what is said."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from drape_designs import BALL, CONTACT, HELD, sheet
from small_scenes import across, make_replay, plate, rows_of, write_scene, write_script

from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.physics.cloth.sensitivity import drape_prediction
from restshape.physics.cloth.sensitivity.drape_distance import missing_way
from restshape.physics.cloth.sensitivity.refined_prediction import RefinedPrediction
from restshape.replay.columns import REFINED, columns_of
from restshape.replay.refined_frames import SQUARE, RefinedFrames

QUANTITIES = '[quantities]\nlowest = { displacement = "z", reduce = "min" }\n'
HANGING = sheet("morley", HELD, QUANTITIES, size=0.04)
LEVELS = ["mesh.levels=2"]
HAND = (0.2, 0.1)


def cloth(kind="hinge", friction=0.3):
    """A sheet on a ball, on nested meshes of about 90 and 25 nodes."""
    text = sheet(kind, HELD, BALL.format(friction=friction), CONTACT, QUANTITIES, size=0.025)
    return text.replace("tolerance = 1e-9", "tolerance = 1e-7")


def far(*places, rest=6, frames=4, released=True):
    """A drag of the right side through places, at each of which the hand rests."""
    events, at = [{"do": "press", "on": "right", "at": list(HAND)}], HAND
    for place in places:
        events += [{"do": "drag", "path": across(at, place, frames)}]
        events += [{"do": "idle", "frames": rest}] if rest else []
        at = place
    return [*events, {"do": "release"}] if released else events


def shown(folder, text, events, predict="gmls", overrides=(), look=None, **known):
    """Rows of a replay, and the unknowns of the finest mesh in each frame."""
    scene, script = write_scene(folder, text), write_script(folder, events)
    made, found = make_replay(scene, script, overrides=[*LEVELS, *overrides], predict=predict, **known), []
    look = look or (lambda made: made.analysis.x.copy())
    return rows_of(made, lambda row: found.append(look(made))), found


def off(found, exact):
    """The largest distance [m] of nodes."""
    return float(np.linalg.norm(found - exact, axis=1).max())


@pytest.mark.slow
@pytest.mark.parametrize("text", [cloth(friction=0.0), HANGING], ids=["on a ball", "hanging"])
def test_a_drag_is_coarse_a_rest_and_a_release_are_fine(tmp_path, text):
    events = far((0.21, 0.1), (0.22, 0.1))
    (rows, found), (true, exact) = (shown(tmp_path, text, events, way) for way in ("gmls", "none"))
    assert all(len(x) == len(exact[0]) for x in found)
    drags = [k for k, row in enumerate(rows) if row["event"] == "drag"]
    for k in drags:
        row = rows[k]
        # It is no rest of the fine mesh, and says so.
        assert row["predicted"] == 1 and row["converged"] == -1 and row["level_shown"] == 1
        assert np.isnan(row["residual"]) and row["estimate"] > 0.0
    assert [rows[k]["fine_age"] for k in drags[:4]] == [1, 2, 3, 4]
    assert rows[1]["level_shown"] == 2 and rows[1]["fine_age"] == 0
    work = " ".join(row["idle_work"] for row in rows)
    assert all(name in work for name in ("coarse solve", "coarse derivative", "fine step", "fine solve"))
    rests = [k for k, row in enumerate(rows) if row["event"] == "idle" and not row["predicted"]]
    assert len(rests) >= 4 and all(rows[k]["converged"] == 1 and rows[k]["level_shown"] == 2 for k in rests)
    assert rows[drags[4]]["fine_age"] == 1
    # Frames of drags are nearer to the solved ones than the way of the cloth in the drag by far.
    way = off(exact[drags[0] - 1], exact[drags[-1]])
    assert max(off(found[k], exact[k]) for k in drags) < 0.5 * way
    assert rows[-1]["event"] == "release" and rows[-1]["converged"] == 1 and rows[-1]["level_shown"] == 2
    assert off(found[-1], exact[-1]) < 1e-5 * way
    assert rows[-1]["q_lowest"] == pytest.approx(true[-1]["q_lowest"], rel=1e-6)


@pytest.mark.slow
def test_the_estimate_says_how_far_the_fine_drape_is(tmp_path):
    events = far((0.24, 0.1), rest=0)
    (rows, found), (_, exact) = (shown(tmp_path, cloth(), events, way) for way in ("gmls", "none"))
    for row, x, y in zip(rows, found, exact):
        if row["event"] == "drag":
            true = np.linalg.norm(x - y) / np.linalg.norm(y - y.mean(axis=0))
            assert true / 8.0 < row["estimate"] < 20.0 * true


@pytest.mark.slow
def test_few_frames_are_estimated_and_say_what_the_others_are_off_by(tmp_path, monkeypatch):
    """Beside frames each of which is estimated of itself, with its residual; no time pays for samples on the way."""
    events, found, steps = far((0.24, 0.1), rest=0, frames=16), {}, []
    slow = Calibration.load()
    units = {name: 220.0 * value for name, value in slow.__dict__.items() if name != "machine"}
    for when in ("auto", "every"):

        def counted(*arguments, when=when):
            steps.append(when)
            return missing_way(*arguments)

        monkeypatch.setattr(drape_prediction, "missing_way", counted)
        words, known = [f"solve.estimate={when}"], replace(slow, **units)
        rows, _ = shown(tmp_path, cloth(), events, overrides=["predict.frame_time=0", *words], calibration=known)
        found[when] = [row for row in rows if row["event"] == "drag" and row["predicted"]]
    assert len(found["auto"]) == len(found["every"]) >= 14 and 3 * steps.count("auto") < steps.count("every")
    ratios = [row["estimate"] / one["estimate"] for row, one in zip(found["auto"], found["every"])]
    assert min(ratios) > 0.6 and max(ratios) < 2.5 and 0.8 < np.median(ratios) < 1.5, ratios
    assert all(row["residual"] > 1e-6 and row["max_strain"] > 0.0 for row in found["every"])


@pytest.mark.slow
def test_the_same_bits_twice_idle_work_included(tmp_path):
    events = far((0.215, 0.1), (0.205, 0.1), rest=4)
    (rows, one), (again, two) = (shown(tmp_path, cloth(), events) for _ in range(2))
    assert [x.tobytes() for x in one] == [x.tobytes() for x in two]
    names = ("samples", "solver_steps", "idle_spent", "idle_work", "level_shown", "fine_age", "estimate")
    assert [[row[name] for name in names] for row in rows] == [[row[name] for name in names] for row in again]


@pytest.mark.slow
def test_a_hand_that_moves_on_leaves_the_fine_solve_at_a_step(tmp_path):
    """On a machine that the calibration says to be slow the rest pays for some steps: the hand moves on before more."""
    events = far((0.22, 0.1), (0.225, 0.1), rest=8)
    slow = Calibration.load()
    units = {name: 220.0 * value for name, value in slow.__dict__.items() if name != "machine"}
    rows, found = shown(tmp_path, HANGING, events, calibration=replace(slow, **units))
    first = next(k for k, row in enumerate(rows) if row["event"] == "drag" and row["line"] == 5)
    rest = " ".join(row["idle_work"] for row in rows[:first])
    assert "fine step" in rest and "fine solve" not in rest
    assert [row["fine_age"] for row in rows[first : first + 4]] == list(range(first - 1, first + 3))
    assert all(row["level_shown"] == 1 for row in rows[2 : first + 4])
    assert rows[-1]["converged"] == 1 and rows[-1]["level_shown"] == 2 and rows[-1]["fine_age"] == 0
    _, exact = shown(tmp_path, HANGING, events, "none")
    assert off(found[-1], exact[-1]) < 1e-6


@pytest.mark.slow
def test_a_new_mesh_within_a_drag_begins_again(tmp_path):
    rows, _ = shown(tmp_path, cloth(), far((0.06, 0.1), rest=0, frames=14))
    drags = [(row["level"], row["level_shown"], row["refused"]) for row in rows if row["event"] == "drag"]
    assert {2, 3} <= {level for level, *_ in drags} and not any(refused for *_, refused in drags)
    assert drags[drags.index((3, 2, "")) + 1] == (1, 1, "")
    assert rows[-1]["event"] == "release" and rows[-1]["converged"] == 1


@pytest.mark.slow
def test_a_fine_solve_that_falls_is_no_correction(tmp_path, monkeypatch):
    """Where steps of the fine cloth have led far from what is shown, frames are as without them."""
    events = far((0.22, 0.1), (0.225, 0.1), rest=8, released=False)
    slow = Calibration.load()
    units = {name: 220.0 * value for name, value in slow.__dict__.items() if name != "machine"}
    found = {}
    for way in (None, 0.2, 1e-4):

        def fallen(pair, way=way):
            return None if way is None else pair.correction + way * np.array([0.0, 0.0, -1.0])

        monkeypatch.setattr(RefinedPrediction, "reached", fallen)
        _, found[way] = shown(tmp_path, HANGING, events, calibration=replace(slow, **units))
    assert off(found[0.2][-1], found[None][-1]) == 0.0 < off(found[1e-4][-1], found[None][-1])


@pytest.mark.slow
def test_a_motion_takes_the_fine_cloth_along_as_it_is(tmp_path):
    """The correction is in directions of the coarse cloth: turned and moved coarse cloth is turned fine cloth."""
    maps = []
    shown(tmp_path, cloth("morley"), far((0.21, 0.1), rest=0), look=lambda made: maps.append(made.prediction.pair))
    pair = maps[-1]
    coarse, fine = pair._corners(), pair.analysis.x
    turn, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    way, corners = np.array([0.3, -0.1, 0.2]), pair.analysis.problem.corner_number
    moved = fine @ turn.T
    moved[corners] += way
    correction = pair.map.of(coarse, fine)
    found = pair.map.joined(coarse @ turn.T + way, correction)
    assert np.abs(found - moved).max() < 1e-13
    # And what is taken apart is put together again.
    assert np.abs(pair.map.joined(coarse, correction) - fine).max() < 1e-15
    assert np.abs(pair.map.prolonged(np.ones((len(coarse), 1))) - 1.0).max() < 1e-15


def test_levels_of_a_drag(tmp_path):
    """One level is the finest mesh alone; more than there are, or on solids, are refused."""
    events = far((0.203, 0.1), rest=0, frames=1)
    rows, _ = shown(tmp_path, cloth(), events, overrides=["predict.levels=1"])
    assert not REFINED.keys() & rows[0].keys()
    with pytest.raises(UserError, match=r"the mesh has 2 levels, and 3 are asked for\n.*set mesh\.levels to 3 or more"):
        shown(tmp_path, cloth(), events, overrides=["predict.levels=3"])
    with pytest.raises(UserError, match="the mesh has 1 level, and 2 are asked for"):
        shown(tmp_path, cloth(), events, overrides=["mesh.levels=1", "predict.levels=2"])
    with pytest.raises(UserError, match=r"has one mesh only\n.*leave it out"):
        make_replay(write_scene(tmp_path, plate()), write_script(tmp_path, []), overrides=["predict.levels=2"])


def test_columns_are_those_of_nested_meshes_alone(tmp_path):
    made = make_replay(write_scene(tmp_path, cloth()), write_script(tmp_path, []), overrides=LEVELS)
    scene = made.session.scene
    columns = {way: columns_of(scene, application_of(scene), way) for way in ("none", "linear", "gmls")}
    assert REFINED.keys() <= columns["gmls"].keys()
    assert not REFINED.keys() & (columns["none"].keys() | columns["linear"].keys())


@pytest.mark.slow
@pytest.mark.parametrize(
    "text", [pytest.param(cloth(), marks=pytest.mark.weekly), HANGING], ids=["on a ball", "hanging"]
)
def test_without_estimates_frames_are_the_same_and_less_is_said_of_them(tmp_path, text):
    """With flips, a new mesh and a rest on the way: what is left out of frames changes none of those that follow."""
    events = far((0.21, 0.1), (0.6, 0.3), rest=3, frames=14)
    (rows, found), (lean, bare) = (
        shown(tmp_path, text, events, overrides=[f"solve.estimate={when}"]) for when in ("every", "none")
    )
    assert {2, 3} <= {row["level"] for row in rows if row["event"] == "drag"}
    assert [x.tobytes() for x in found] == [x.tobytes() for x in bare]
    left = ("residual", "estimate", "max_strain")
    for full, row in zip(rows, lean):
        coarse = row["level_shown"] == 1 and row["predicted"]
        assert all(np.isnan(row[name]) for name in left) or not (coarse and row["event"] == "drag")
        same = [
            name for name in ("q_lowest", "note", "predicted", "samples", "solver_steps", "converged") if name in row
        ]
        assert [row[name] for name in same] == [full[name] for name in same]
        assert np.isnan(row["residual"]) if coarse else row["residual"] == full["residual"]
    assert sum(np.isnan(row["residual"]) for row in lean) > 4


class EstimatedAt(RefinedFrames):
    """Frames at a way of the hand that have an estimate."""

    distance = size = 1.0

    def __init__(self):
        self.spec, self._samples, self._estimate = SimpleNamespace(epsilon=1e-6), None, None
        self._power, self.pair = SQUARE, SimpleNamespace(coarse_distance=lambda: 1e-3 * self.distance**1.5)


def test_a_second_estimate_at_one_way_of_the_hand_keeps_the_power():
    """Two ways give the power by which the distance grows; a frame that is estimated twice takes nothing from it."""
    frames = EstimatedAt()
    for way in (1.0, 2.0, 2.0):
        frames.distance = way
        frames.estimated(np.nan)
        assert frames._power == pytest.approx(SQUARE if way == 1.0 else 1.5)
    frames.distance = 4.0
    assert frames._expected_error(*frames._estimate) == pytest.approx(1e-3 * 4.0**1.5)
