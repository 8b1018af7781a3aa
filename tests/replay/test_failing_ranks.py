"""A rank that fails, or sees other files ends all of them, with one message and its exit code."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from small_scenes import across, drag, plate, write_scene, write_script

from restshape.replay.recording.recording import Recording

PROGRAM = str(Path(__file__).with_name("failing_rank_program.py"))

pytestmark = [pytest.mark.mpi, pytest.mark.slow]


def run_on_two(folder, outside, *words):
    command = ["mpiexec", "-n", "2", sys.executable, PROGRAM, *map(str, words)]
    return subprocess.run(command, cwd=folder, env=outside, capture_output=True, text=True, timeout=60)


def long_script(folder, frames=2000):
    steps = [*across((0.5, 0.5), (0.7, 0.5), 20), *across((0.7, 0.5), (0.5, 0.5), 20)]
    return write_script(folder, drag("window", (0.5, 0.5), (steps * (frames // 40))))


def test_an_error_on_one_rank_ends_all_and_the_recording_is_whole(tmp_path, outside):
    scene, script = write_scene(tmp_path, plate(0.2)), long_script(tmp_path, 40)
    done = run_on_two(tmp_path, outside, "fails", "replay", scene, script, "--out", "a.vtkhdf")
    assert done.returncode == 1 and done.stderr.count("Traceback") == 1
    assert "ArithmeticError: this rank has had enough" in done.stderr
    assert "restshape replay: rank 1 has failed" in done.stderr
    with Recording(tmp_path / "a.vtkhdf") as kept:
        assert kept.status == "interrupted" and 0 < len(kept.times) <= 3


@pytest.mark.weekly
def test_ranks_that_see_unlike_files_are_refused_with_one_message(tmp_path, outside):
    for rank, size in ((0, 0.2), (1, 0.3)):
        (tmp_path / f"rank-{rank}").mkdir()
        write_scene(tmp_path / f"rank-{rank}", plate(size), "a.toml")
    done = run_on_two(tmp_path, outside, "apart", "replay", "a.toml")
    assert done.returncode == 2
    assert done.stderr.count("rank 1 has been given another scene than rank 0") == 1


@pytest.mark.weekly
def test_a_file_that_one_rank_does_not_see_is_named_with_the_rank(tmp_path, outside):
    for rank in (0, 1):
        (tmp_path / f"rank-{rank}").mkdir()
    write_scene(tmp_path / "rank-0", plate(0.2), "a.toml")
    done = run_on_two(tmp_path, outside, "apart", "replay", "a.toml")
    assert done.returncode == 2 and done.stderr.count("on rank 1: ") == 1 and "a.toml" in done.stderr


@pytest.mark.weekly
@pytest.mark.parametrize("count", ["0", "-1"])
def test_no_ranks(tmp_path, outside, count):
    """Open MPI starts as many ranks as there are cores, others refuse it; in no case is a scene replayed twice."""
    scene = write_scene(tmp_path, plate(0.2))
    command = ["mpiexec", "-n", count, sys.executable, "-m", "restshape", "replay", str(scene), "--json", "a.json"]
    done = subprocess.run(command, cwd=tmp_path, env=outside, capture_output=True, text=True, timeout=120)
    assert "Traceback" not in done.stderr
    if done.returncode:
        assert done.stderr.strip() and not (tmp_path / "a.json").exists()
    else:
        found = json.loads((tmp_path / "a.json").read_text())
        assert 1 <= found["ranks"] <= os.cpu_count() and done.stdout.count(" frames, ") <= 1
