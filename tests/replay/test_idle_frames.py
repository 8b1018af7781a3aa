"""Frames in which nothing has changed: nothing is computed again, counted by kernels' and PETSc's own calls."""

from itertools import islice
from math import isnan

import pytest
from petsc4py import PETSc
from small_scenes import make_replay, write_script

from restshape import _kernels
from restshape.algebra.stages import LOGGED, log_stage
from restshape.application import applications
from restshape.replay.columns import SIMULATED

EVENTS = ("MatMult", "MatMultAdd", "MatSolve", "PCApply", "PCSetUp", "KSPSolve", "VecNorm")
SCENES = [path for one in applications().values() for path in sorted((one.folder / "scenes").glob("*.toml"))[:2]]
"""Two of each application."""


@pytest.fixture(scope="module", autouse=True)
def _logged():
    PETSc.Log.begin()


def work():
    """How often each kernel has been called, and each event has happened, so far."""
    stages = [None, *map(log_stage, LOGGED)]
    counts = {
        name: sum(PETSc.Log.Event(name).getPerfInfo(stage and stage.id)["count"] for stage in stages) for name in EVENTS
    }
    return counts, _kernels.calls()


def columns(row):
    """The row but for its place in the script, its times and the age of what is kept."""
    left_out = ("index", "t", "pc_age", "pc_rebuilt", "iterations", "newton", "residual", "preconditioner")
    return {key: value for key, value in row.items() if key not in left_out and not key.startswith("ms")}


def alike(one, other):
    return one == other or (isinstance(one, float) and isnan(one) and isnan(other))


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES, ids=lambda path: f"{path.parts[-3]}-{path.stem}")
def test_idle_frames_compute_nothing_and_say_the_same(tmp_path, scene):
    script = write_script(tmp_path, [{"do": "idle", "frames": 4}])
    frames = make_replay(scene, script).frames()
    before = list(islice(frames, 2))[1]
    if SIMULATED in before:
        pytest.skip("time goes on in its idle frames")
    done = work()
    for row in islice(frames, 2):
        same = columns(row)
        assert all(alike(value, same[name]) for name, value in columns(before).items())
        assert alike(row["residual"], before["residual"])
    assert work() == done
