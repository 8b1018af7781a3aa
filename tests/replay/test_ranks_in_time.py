"""Motion, heat and flow in time on two ranks: what one rank gives, and the same bits again."""

import json

import numpy as np
import pytest
from small_scenes import write_script

from restshape.application import applications

DRAGS = {
    "building": (["mesh.size=1.0", "effects.dynamics.steps=2"], ("right_top", (5.7, 16.6), (5.7, 15.4))),
    "csm3": (["mesh.size=0.02", "mesh.near={}", "effects.dynamics.steps=2"], ("tip", (0.6, 0.2), (0.59, 0.2))),
    "flow": (["mesh.size=0.03", "mesh.near.body=0.006"], ("tail", (0.005, 0), (0.008, 0))),
    "thermal": (["mesh.size=0.004", "mesh.near.bottom=0.003"], ("mouth", (0.047, 0.035), (0.049, 0.036))),
}
"""Scenes that go on in time: linear, of large deformation, and of a fluid without heat and with it."""

EVERY_DAY = ("csm3", "thermal")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[] if name in EVERY_DAY else [pytest.mark.weekly]) for name in DRAGS]
)
def test_two_ranks_give_what_one_gives_and_twice_the_same(tmp_path, on_ranks, name):
    overrides, (entity, at, to) = DRAGS[name]
    scene = next(path for app in applications().values() for path in app.scenes() if path.stem == name)
    events = [{"do": "idle", "frames": 2}, {"do": "press", "on": entity, "at": at}]
    script = write_script(tmp_path, [*events, {"do": "drag", "to": to, "frames": 4}])
    words, found = [word for key in overrides for word in ("--set", key)], {}
    for run, ranks in (("one", 1), ("two", 2), ("again", 2)):
        done = on_ranks(ranks, "replay", scene, "--edits", script, *words, "--json", f"{run}.json")
        assert done.returncode == 0, done.stdout + done.stderr
        found[run] = json.loads((tmp_path / f"{run}.json").read_text())
    assert (found["one"]["ranks"], found["two"]["ranks"]) == (1, 2) and found["two"]["levels"]["1"] > 0
    assert found["two"]["quantities"] == found["again"]["quantities"]
    for quantity, values in found["one"]["quantities"].items():
        one, two = (np.array(of, dtype=float) for of in (values, found["two"]["quantities"][quantity]))
        np.testing.assert_allclose(two, one, rtol=0.0, atol=1e-4 * np.abs(one).max(), err_msg=quantity)
