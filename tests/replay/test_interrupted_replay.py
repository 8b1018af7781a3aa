"""However a replay ends, it says so, and its recording opens with the frames so far."""

import os
import resource
import signal
import time
from pathlib import Path

import numpy as np
import pytest
from small_scenes import drag, plate, write_scene, write_script

from restshape.outputs.si_numbers import counted
from restshape.replay.recording.recording import Recording

FRAMES = 5_000


@pytest.fixture
def words(tmp_path):
    """The words of a replay that takes far longer than any test waits."""
    path = [(0.5 + 0.1 * np.sin(0.01 * k), 0.5) for k in range(FRAMES)]
    scene, script = write_scene(tmp_path, plate(0.1)), write_script(tmp_path, drag("window", (0.5, 0.5), path))
    return ("replay", scene, "--edits", script, "--out", "a.vtkhdf")


@pytest.fixture(autouse=True)
def often(monkeypatch):
    """Progress is printed all the time."""
    monkeypatch.setenv("RESTSHAPE_PROGRESS", "0")


def wait_for_frames(process):
    """Returns after a hundred frames."""
    lines = []
    for line in process.stderr:
        lines.append(line)
        if line.startswith(f"100 of {FRAMES + 3} frames, about "):
            return
    raise AssertionError("".join(lines))


def children(parent):
    """The process numbers of a process's children."""
    found = []
    for entry in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = entry.read_text().rpartition(")")[2].split()
        except (FileNotFoundError, ProcessLookupError):
            continue
        if int(fields[1]) == parent:
            found.append(int(entry.parent.name))
    return found


def recorders(parent):
    """The recorder processes that a process has started."""
    named = b"restshape.replay.recording.recorder_process"

    def writes(child):
        folder = Path(f"/proc/{child}")
        return named in (folder / "cmdline").read_bytes() or (folder / "comm").read_text() == "recorder\n"

    return [child for child in children(parent) if writes(child)]


def opened(path):
    """The recording, once its writer has let go of it."""
    deadline = time.monotonic() + 10
    while True:
        with Recording(path) as recording:
            if recording.status != "killed" or time.monotonic() > deadline:
                assert recording.verify() == []
                assert recording.table["index"].tolist() == list(range(recording.n))
                return recording
        time.sleep(0.05)


@pytest.mark.slow
def test_ctrl_c(tmp_path, start_restshape, words):
    process = start_restshape(*words)
    wait_for_frames(process)
    process.send_signal(signal.SIGINT)
    printed, reported = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "policy auto" in printed and "time a frame" in printed
    assert reported.endswith("restshape replay: interrupted\n") and "Traceback" not in reported
    recording = opened(tmp_path / "a.vtkhdf")
    assert recording.status == "interrupted" and 100 <= recording.n < FRAMES


@pytest.mark.slow
@pytest.mark.parametrize("number", [pytest.param(signal.SIGKILL, marks=pytest.mark.weekly), signal.SIGTERM])
def test_the_solver_is_killed(tmp_path, start_restshape, words, number):
    process = start_restshape(*words)
    wait_for_frames(process)
    process.send_signal(number)
    process.communicate(timeout=20)
    assert process.returncode != 0
    recording = opened(tmp_path / "a.vtkhdf")
    assert recording.status == "interrupted" and 100 <= recording.n < FRAMES


@pytest.mark.slow
def test_everything_is_killed(tmp_path, start_restshape, words):
    process = start_restshape(*words)
    wait_for_frames(process)
    time.sleep(0.6)
    for number in (*recorders(process.pid), process.pid):
        os.kill(number, signal.SIGKILL)
    process.communicate(timeout=20)
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.status == "killed" and recording.n >= 100
        assert recording.verify() == []


@pytest.mark.slow
def test_a_full_disk(tmp_path, start_restshape, words):
    process = start_restshape(*words)
    wait_for_frames(process)
    (recorder,) = recorders(process.pid)
    resource.prlimit(recorder, resource.RLIMIT_FSIZE, (6 << 20, 6 << 20))
    _, reported = process.communicate(timeout=60)
    assert process.returncode == 2
    assert "the disk is full" in reported and "Traceback" not in reported
    recording = opened(tmp_path / "a.vtkhdf")
    assert recording.status == "disk full" and f"the first {counted(recording.n, 'frame')}" in reported


@pytest.mark.slow
@pytest.mark.mpi
@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.weekly), signal.SIGKILL])
def test_one_of_two_ranks_ends(tmp_path, start_restshape, words, number):
    process = start_restshape(*words, ranks=2)
    wait_for_frames(process)
    ranks = children(process.pid)
    assert len(ranks) == 2
    os.kill(ranks[-1], number)
    process.communicate(timeout=30)
    assert process.returncode != 0
    recording = opened(tmp_path / "a.vtkhdf")
    assert recording.status == "interrupted" and 100 <= recording.n < FRAMES


@pytest.mark.mpi
@pytest.mark.parametrize("number", [pytest.param(signal.SIGINT, marks=pytest.mark.weekly), signal.SIGTERM])
def test_a_signal_to_one_rank_ends_all_after_the_same_frame(tmp_path, start_restshape, words, number):
    process = start_restshape(*words, ranks=2)
    wait_for_frames(process)
    os.kill(children(process.pid)[-1], number)
    printed, reported = process.communicate(timeout=60)
    assert process.returncode == 128 + number, reported
    assert "restshape replay: interrupted" in reported and "Traceback" not in reported and "MPI_ABORT" not in reported
    assert "policy auto" in printed and "2 ranks" in printed
    assert opened(tmp_path / "a.vtkhdf").status == "interrupted"


@pytest.mark.mpi
def test_a_full_disk_ends_all_ranks(tmp_path, start_restshape, words):
    process = start_restshape(*words, ranks=2)
    wait_for_frames(process)
    (recorder,) = [found for rank in children(process.pid) for found in recorders(rank)]
    resource.prlimit(recorder, resource.RLIMIT_FSIZE, (6 << 20, 6 << 20))
    _, reported = process.communicate(timeout=60)
    assert process.returncode == 2, reported
    assert "the disk is full" in reported and "Traceback" not in reported
    assert opened(tmp_path / "a.vtkhdf").status == "disk full"


@pytest.mark.mpi
def test_ctrl_c_to_two_ranks(tmp_path, start_restshape, words):
    process = start_restshape(*words, ranks=2)
    wait_for_frames(process)
    process.send_signal(signal.SIGINT)
    _, reported = process.communicate(timeout=30)
    assert process.returncode != 0 and "Traceback" not in reported
    recording = opened(tmp_path / "a.vtkhdf")
    assert recording.status == "interrupted" and 100 <= recording.n < FRAMES
