"""Vibration on several ranks."""

import json

import numpy as np
import pytest
from small_scenes import drag, write_script
from vibrating import SHAKEN, dynamics, tower


@pytest.mark.parametrize("steps", [1, 10])
def test_two_ranks_give_what_one_gives(on_ranks, tmp_path, steps):
    scene = tower(tmp_path, SHAKEN, dynamics(0.01, steps), window=True)
    path = [(0.5, 1.4 - 0.04 * k) for k in range(1, 16)]
    script = write_script(tmp_path, drag("window", (0.5, 1.4), path))
    found = []
    for ranks in (1, 2):
        done = on_ranks(ranks, "replay", scene, "--edits", script, "--parity", "--json", f"{ranks}.json")
        assert done.returncode == 0, done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    for name in ("sway", "amplitude", "energy"):
        one, two = (np.array(summary["quantities"][name]) for summary in found)
        assert np.abs(one - two).max() < 1e-8 * np.abs(one).max()
    assert found[0]["levels"]["1"] > 0 and found[0]["quantities"]["edit"] == pytest.approx(
        found[1]["quantities"]["edit"], rel=1e-6, abs=1e-9
    )
