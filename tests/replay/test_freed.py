"""What a replay has made is freed with the last reference to it, not when the garbage collector comes by."""

import gc
import os
import sys
from pathlib import Path
from subprocess import run
from weakref import ref

import modal
import pytest
from cloths import PIN, write_cloth
from large import beam
from restshape_studies.explain.filled import stored
from small_scenes import across, drag, make_replay, plate, write_scene, write_script

from restshape.replay.loop import Replay


def solid(folder: Path, predict: str = "none") -> Replay:
    """A plate whose hole is dragged."""
    script = write_script(folder, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.6, 0.55), 4)))
    return make_replay(write_scene(folder, plate(0.15)), script, predict=predict)


def predicted(folder: Path) -> Replay:
    """The same, between solves by the design derivative."""
    return solid(folder, "linear")


def large(folder: Path) -> Replay:
    """A beam in large deformation, by Newton's method."""
    return make_replay(write_scene(folder, beam()))


def cloth(folder: Path) -> Replay:
    """A hanging cloth, by motion, descent and Newton's method."""
    return make_replay(write_cloth(folder, PIN))


def modes(folder: Path) -> Replay:
    """The modes of a bar."""
    return make_replay(modal.SCENES / "bar_100.toml", overrides=["mesh.layers=1"])


@pytest.mark.parametrize("make", [solid, predicted, large, cloth, modes])
def test_matrices_go_with_the_replay(make, tmp_path):
    before = stored()
    gc.disable()
    try:
        replay = make(tmp_path)
        for _ in replay.frames():
            pass
        assert stored()[0] > before[0]
        analysis = ref(replay.analysis)
        del replay
        assert analysis() is None
        assert stored() == before
    finally:
        gc.enable()


@pytest.mark.cli
@pytest.mark.parametrize("make", ["large", "cloth"])
def test_programs_may_end_with_a_replay_that_goes_on(make, tmp_path):
    program = f"from test_freed import *\nreplay = {make}(Path({str(tmp_path)!r}))\nframes = replay.frames()\n"
    program += "next(frames)\nprint('end')"
    here = Path(__file__).parent
    folders = os.pathsep.join(map(str, (here, here.parent, here.parent / "applications")))
    environment = os.environ | {"PYTHONPATH": folders}
    done = run([sys.executable, "-c", program], env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stdout, done.stderr) == (0, "end\n", "")
