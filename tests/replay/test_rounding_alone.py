"""Numbers that are rounding alone are shown as 0: beside what else has their unit, beside loads, beside their own."""

import json

import numpy as np
import pytest
from small_scenes import CLAMPED, HEAD, PULLED, STEEL, block, make_replay, meshed, write_scene, write_script

from restshape.replay.rounding import cleared, load_scales, scales, without_rounding
from restshape.replay.summary import summarise
from restshape.replay.tally import Tally

PULL = 100e6
BAR = (
    HEAD
    + block(2.0, 0.5)
    + STEEL
    + CLAMPED
    + PULLED
    + meshed(0.25)
    + '[quantities]\nalong = { reaction = "x", at = "left" }\nacross = { reaction = "y", at = "left" }\n'
)


def test_the_scale_is_that_of_the_unit_of_the_loads_or_the_own():
    series = {"a": np.array([np.nan, 2e-11]), "b": np.array([-7.0, 3.0]), "c": np.array([1e-30])}
    units = {"a": "N", "b": "N", "c": "W"}
    assert scales(series, units) == {"a": 7.0, "b": 7.0, "c": 1e-30}
    assert scales(series, units, {"W": 60.0}) == {"a": 7.0, "b": 7.0, "c": 60.0}
    assert scales(series, {}) == {"a": 2e-11, "b": 7.0, "c": 1e-30}
    np.testing.assert_array_equal(
        without_rounding(np.array([2e-11, 1e-5, np.nan, np.inf]), 7.0), [0, 1e-5, np.nan, np.inf]
    )
    # A load that nearly vanishes makes a load factor huge: those of other frames are no rounding beside it.
    factors = {"factor": np.array([8.0, 1e13]), "share": np.array([0.3, 1e-12])}
    assert scales(factors, dict.fromkeys(factors, "")) == {"factor": 1.0, "share": 0.3}
    assert cleared(1e-27, 60.0) == 0.0 and cleared(-1e-3, 60.0) == -1e-3


def test_loads_have_a_scale_by_unit(tmp_path):
    scene = make_replay(write_scene(tmp_path, BAR), write_script(tmp_path, [])).session.scene
    assert load_scales(scene) == {"Pa": PULL}


@pytest.mark.slow
def test_a_reaction_that_symmetry_makes_zero_is_printed_as_zero(command, tmp_path):
    """Of a symmetric pull the reaction across is 0, and its jumps are no share of anything."""
    scene = write_scene(tmp_path, BAR)
    done = command("replay", scene, "--set", "quantities.error=true", "--json", "a.json", "--out", "a.vtkhdf")
    assert done.returncode == 0, done.stderr
    row = next(line.split() for line in done.stdout.splitlines() if line.startswith("across"))
    assert row[1:9] == ["0", "N"] * 4
    values = json.loads((tmp_path / "a.json").read_text())["quantities"]
    assert 0.0 < abs(values["across"][0]) < 1e-9 * abs(values["along"][0])
    shown = command("report", "a.vtkhdf", "--animation", "none", "--json", "r.json")
    assert shown.returncode == 0, shown.stderr
    found = {row["quantity"]: row for row in json.loads((tmp_path / "r.json").read_text())["quantities"]}
    assert [found["across"][key] for key in ("first", "last", "min", "max", "error")] == [0.0] * 5
    assert found["along"]["first"] == values["along"][0]


def test_a_jump_of_rounding_is_no_share_and_others_are_of_the_largest_value():
    rows = [known_row(k, level, *numbers) for k, (level, *numbers) in enumerate(FRAMES)]
    tally = Tally({"force": "N", "noise": "N"})
    for row in rows:
        tally.add(row)
    jumps = tally.summary("auto", 1)["jumps"]
    assert jumps["force"] == {"largest": 0.5, "share": pytest.approx(0.05), "frame": 1}
    assert jumps["noise"] == {"largest": 8e-13, "share": None, "frame": 1}
    # Nothing says what noise is where no unit is known.
    assert summarise(rows, "auto", 1)["jumps"]["noise"]["share"] == pytest.approx(8e-13 / 3e-13)


FRAMES = [(3, 10.0, np.nan, 1e-13, np.nan), (2, 0.01, 0.5, 1e-13, 8e-13), (1, 5.0, np.nan, 3e-13, np.nan)]


def known_row(index, level, force, force_jump, noise, noise_jump):
    """A row of a frame with two forces."""
    texts = dict.fromkeys(("preconditioner", "refused", "note", "constraint_status", "violated_constraints"), "")
    numbers = dict.fromkeys(("iterations", "newton", "pc_rebuilt", "unknowns", "elements", "predicted", "line"), 0)
    forces = {"q_force": force, "force_jump": force_jump, "q_noise": noise, "noise_jump": noise_jump}
    return {"index": index, "level": level, "ms": 1.0, **texts, **numbers, **forces}
