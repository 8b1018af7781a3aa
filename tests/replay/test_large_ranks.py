"""Large deformation on two ranks gives what it gives on one."""

import json

import numpy as np
import pytest
from large import beam, gravity, solid
from small_scenes import across, drag, write_scene, write_script

pytestmark = pytest.mark.mpi
WIND = '\n[loads.wind]\non = "top"\npressure = 500\n'


@pytest.mark.parametrize("wind", [pytest.param("", marks=pytest.mark.weekly), WIND], ids=["weight", "wind"])
def test_replay(tmp_path, on_ranks, wind):
    scene = write_scene(tmp_path, beam(solid(), gravity(0, -8), wind))
    events = [
        *drag("b", (1, 0), across((1, 0), (1.1, -0.05), 4)),
        {"do": "set", "key": "effects.gravity.g", "value": [0, -900]},
    ]
    script, found = write_script(tmp_path, events), []
    for ranks in (1, 2):
        words = ("--edits", script, "--json", f"{ranks}.json", "--set", "solve.tolerance=1e-9", "--parity")
        done = on_ranks(ranks, "replay", scene, *words)
        assert done.returncode == 0, done.stdout + done.stderr
        found.append(json.loads((tmp_path / f"{ranks}.json").read_text()))
    one, two = found
    assert one["refused"] == two["refused"] == 1 and one["parity"]["holds"] and two["parity"]["holds"]
    for quantity in ("x", "y", "energy"):
        # A refused frame has None.
        values = (np.array(found["quantities"][quantity], dtype=float) for found in (two, one))
        np.testing.assert_allclose(*values, rtol=1e-6)
