"""The heat sink on one rank and on two, its reuse against cold solves, and the scene that `restshape new` writes."""

import json

import numpy as np
import pytest
from counted_replays import begin_log, kernels, watched
from restshape_apps.thermal import application

SCENE = application.folder / "scenes" / "fins.toml"
EDITS = application.folder / "edits" / "fins.jsonl"


def test_two_ranks_give_what_one_gives(on_ranks, tmp_path):
    found = []
    for ranks in (1, 2):
        done = on_ranks(ranks, "replay", SCENE, "--edits", EDITS, "--parity", "--json", f"{ranks}.json")
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    for name in ("hottest", "mean", "air_heat"):
        one, two = (np.array(summary["quantities"][name]) for summary in found)
        assert np.abs(one - two).max() < 1e-6 * np.abs(one).max()
    assert found[0]["levels"]["1"] > 0


@pytest.mark.slow
def test_the_sink_loses_what_the_chip_gives_in_every_frame(command, tmp_path):
    done = command("replay", SCENE, "--edits", EDITS, "--set", "solve.tolerance=1e-9", "--json", "out.json")
    assert done.returncode == 0, done.stderr
    quantities = json.loads((tmp_path / "out.json").read_text())["quantities"]
    np.testing.assert_allclose(quantities["chip_heat"], -60.0, rtol=1e-9)
    np.testing.assert_allclose(quantities["air_heat"], 60.0, rtol=1e-5)


@pytest.mark.slow
def test_storage_that_no_scene_asks_for_is_absent():
    begin_log()
    stored = 'effects.storage={time_step="10 s", initial="300 K"}'
    steady, in_time = (kernels(watched(SCENE, EDITS, overrides)[0]) for overrides in ((), (stored,)))
    assert not any("capacity" in name for name in steady) and any("capacity" in name for name in in_time)
