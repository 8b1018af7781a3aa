"""The best schedule of refreshes against all schedules, and the cost of a replay over the best schedule."""

from itertools import combinations

import numpy as np
import pytest
from petsc4py import PETSc
from small_scenes import across, drag, plate, write_scene, write_script
from whole_schedules import best_schedule

from restshape.application import application_of
from restshape.calibration import Calibration
from restshape.policy import policy
from restshape.replay.loop import Replay
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.variation.hindsight import Watch


def by_hand(refreshes, refresh, frame):
    """The cost of a schedule, frame by frame."""
    cost, last = 0.0, 0
    for j in range(len(frame)):
        if j in refreshes:
            cost, last = cost + (refresh[j] if np.ndim(refresh) == 1 else refresh[last][j]), j
        cost += frame[last][j]
    return cost


def every(n):
    """All schedules of n frames; the first always refreshes."""
    return [(0, *later) for k in range(n) for later in combinations(range(1, n), k)]


@pytest.mark.parametrize("pairwise", [False, True])
@pytest.mark.parametrize("n", [1, 2, 5, 9])
def test_no_schedule_is_better(n, pairwise):
    rng = np.random.default_rng(n)
    for _ in range(5):
        frame = np.triu(rng.uniform(0, 3, (n, n))).cumsum(axis=1)
        refresh = rng.uniform(1, 8, (n, n) if pairwise else n)
        cost, refreshes = best_schedule(refresh, frame)
        assert cost == pytest.approx(min(by_hand(s, refresh, frame) for s in every(n)))
        assert cost == pytest.approx(by_hand(refreshes, refresh, frame))


def test_frames_out_of_reach_are_never_used():
    frame = np.where(np.arange(6)[None, :] - np.arange(6)[:, None] > 1, np.inf, 1.0)
    cost, refreshes = best_schedule(np.full(6, 10.0), frame)
    assert cost == 3 * 10 + 6 and len(refreshes) == 3


def test_nothing_costs_nothing():
    assert best_schedule(np.zeros(0), np.zeros((0, 0))) == (0.0, [])


def test_equal_steps_are_refreshed_equally_often():
    """Iterations that grow by one a frame, refresh 18: intervals of sqrt(2 x 18) = 6 are best."""
    age = np.arange(36)[None, :] - np.arange(36)[:, None]
    cost, refreshes = best_schedule(np.full(36, 18.0), np.maximum(age, 0).astype(float))
    assert refreshes == list(range(0, 36, 6)) and cost == 6 * (18 + 15)


@pytest.mark.parametrize("window", [1, 3, 36])
@pytest.mark.parametrize("refresh", [0.5, 4.0, 18.0])
def test_old_preconditioners_that_a_younger_one_replaces_need_no_look(window, refresh):
    """Where a younger one never takes more iterations, the best schedule stays the best without the oldest."""
    rng = np.random.default_rng(window)
    moved = rng.uniform(0.0, 2.0, 36).cumsum()
    frame = 1.0 + np.floor(np.abs(moved[None, :] - moved[:, None]))
    whole, costs = best_schedule(np.full(36, refresh), frame, window), []
    assert best_schedule(np.full(36, refresh), frame, window, slack=refresh, looked=costs) == whole
    assert len(costs) < 36 * window or window == 1


@pytest.mark.slow
@pytest.mark.skipif(PETSc.COMM_WORLD.size > 1, reason="one rank")
def test_cost_in_hindsight_of_a_drag_that_goes_one_way(tmp_path):
    script = write_script(tmp_path, drag("window", (0.5, 0.5), across((0.5, 0.5), (1.2, 0.5), 60)))
    scene = load_scene(write_scene(tmp_path, plate(0.08)))
    request = Request(scene, load_script(script, scene), application_of(scene), policy("auto"), Calibration.load())
    replay = Replay(request, PETSc.COMM_WORLD)
    watch = Watch(replay.analysis.solver)
    for _ in replay.frames():
        watch.settle()
    found = watch.found()
    # All frames but press and release are solved, with a matrix each.
    assert found["matrices"] == 61
    # The guesses are those of the run: within an iteration in a few frames, the run is a schedule like any other.
    assert 0.98 <= found["ratio"] <= 2.1
    assert found["run"] == pytest.approx(found["ratio"] * found["best"])
    for name in ("run", "best"):
        assert len(found["schedule"][name]) == found["refreshes"][name] >= 1
        assert found["schedule"][name][0] == 0
