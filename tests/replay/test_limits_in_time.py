"""Limits of motions: what the errors of time steps leave of them."""

import math

import numpy as np
import pytest
from small_scenes import make_replay, rows_of, write_scene, write_script

from restshape.replay.constraints import FAILS, UNCERTAIN
from restshape.replay.step_errors import StepErrors
from restshape.replay.tally import Tally
from restshape.scene.quantity import in_unit

TOWER = """
format = "restshape-scene"
version = 1
app = "moving"
[shape]
outline = ["foot", "r", "head", "l"]
vertices = { a = [0, 0], b = ["0.2 m", 0], c = ["0.2 m", "3 m"], d = [0, "3 m"] }
[shape.edges]
foot = { line = ["a", "b"] }
r = { line = ["b", "c"] }
head = { line = ["c", "d"] }
l = { line = ["d", "a"] }
[material.m]
E = "210 GPa"
nu = 0.3
rho = 7850
thickness = "20 mm"
[effects.dynamics]
time_step = "STEP"
steps = COUNT
[effects.ground]
frequency = "18 Hz"
displacement = "1 mm"
[effects.damping]
ratio = 0.05
frequencies = ["18 Hz", "100 Hz"]
[supports.wall]
on = "foot"
fix = ["x", "y"]
[mesh]
size = "200 mm"
order = 2
[quantities]
roof = { displacement = "x", at = "head", reduce = "peak", max = "5 mm" }
space = { area = true, max = "1 m^2" }
"""


def shaken(folder, step, count, frames):
    """The scene of a tower whose base swings at its own frequency, and idle frames."""
    scene = write_scene(folder, TOWER.replace("STEP", step).replace("COUNT", str(count)))
    return scene, write_script(folder, [{"do": "idle", "frames": frames}])


def test_steps_too_long_leave_a_limit_uncertain_that_short_ones_pass(tmp_path):
    """Less than three steps a period: the peak is a tenth of that with 22."""
    found = {}
    for step, count in (("20 ms", 5), ("2.5 ms", 40)):
        found[count] = rows_of(make_replay(*shaken(tmp_path, step, count, 6)))[1:]
    assert {row["constraint_status"] for row in found[40]} == {FAILS}
    assert max(row["q_roof"] for row in found[5]) < 0.3 * max(row["q_roof"] for row in found[40])
    assert {row["constraint_status"] for row in found[5]} == {UNCERTAIN}
    for row in found[5]:
        shown = in_unit("m", row["q_roof"], 4)
        assert row["note"] == f"roof holds, but uncertain: {shown}, at most 5 mm: less than ten time steps a period"
    # Numbers alone make no new reason, whose text is that of the largest, whatever its unit.
    tally = Tally()
    for row in found[5]:
        tally.add(row)
    (reason,) = tally.reasons["note"].values()
    largest = max(range(6), key=lambda i: abs(found[5][i]["q_roof"]))
    assert reason.text == found[5][largest]["note"] and {" µm" in row["note"] for row in found[5]} == {True, False}
    assert (reason.frame, reason.last, reason.worst, reason.count) == (1, 6, 1 + largest, 6)


@pytest.mark.parametrize("steps", [20, 40, 100])
def test_errors_of_a_period_are_those_of_the_phase(steps):
    """The average acceleration turns w into (2 / dt) atan(w dt / 2); a step's error is dt^2 (a' - a) / 12."""
    turn = 2.0 * math.pi / steps
    times = turn * np.arange(steps)
    local = turn**2 / 12.0 * np.abs(np.diff(np.cos(times))).max()
    known = StepErrors()
    known.take({"q_q": 3.0, "estimate_time": local}, ["q"])
    known.take({"q_q": 1.0, "estimate_time": 1e-3 * local}, ["q"])
    phase = 2.0 * math.pi - 2.0 * steps * math.atan(0.5 * turn)
    assert known.error("q") == pytest.approx(3.0 * phase, rel=0.05)


def test_what_does_not_go_on_in_time_has_none():
    known = StepErrors()
    known.take({"q_q": 3.0, "estimate_time": math.nan}, ["q"])
    assert known.error("q") == 0.0


def test_check_warns_of_few_steps_a_period(tmp_path, command):
    for step, said in (("20 ms", "is not resolved"), ("4 ms", "off by about 1.7 % in frequency"), ("2.5 ms", "")):
        done = command("check", shaken(tmp_path, step, 5, 1)[0])
        assert done.returncode == 0 and ("steps a period" in done.stdout) == bool(said) and said in done.stdout
