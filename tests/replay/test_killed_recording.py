"""However a run ends, its recording opens, is sound, and lacks at most its last half second."""

import os
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from restshape.replay.recording.recording import Recording

pytestmark = pytest.mark.cli

SCRIPT = Path(__file__).with_name("record_forever.py")
WRITTEN_BEHIND = 0.5


class Run:
    """A solver that records until it is killed, in a process group of its own."""

    def __init__(self, path: Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, str(SCRIPT), str(path)],
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
            start_new_session=True,
        )
        self.recorder = int(self.process.stdout.readline())
        self.handed: list[tuple[int, float]] = []
        self._listener = threading.Thread(target=self._listen)
        self._listener.start()

    def _listen(self) -> None:
        for line in self.process.stdout:
            if len(words := line.split()) == 2:
                self.handed.append((int(words[0]), float(words[1])))

    def end(self) -> None:
        """Waits until solver and recorder are gone."""
        self.process.kill()
        self.process.wait()
        self._listener.join()
        deadline = time.monotonic() + 10
        while _lives(self.recorder) and time.monotonic() < deadline:
            time.sleep(0.01)


def _lives(process: int) -> bool:
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except (FileNotFoundError, ProcessLookupError):
        return False


def _valid(path: Path) -> Recording:
    with Recording(path) as recording:
        assert recording.verify() == []
        assert recording.table["index"].tolist() == list(range(recording.n))
        return recording


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM])
def test_the_solver_is_killed(tmp_path, number):
    run = Run(tmp_path / "a.vtkhdf")
    time.sleep(0.5)
    run.process.send_signal(number)
    run.end()
    recording = _valid(tmp_path / "a.vtkhdf")
    assert recording.status == "interrupted"
    # The solver may have died between handing over a frame and printing it.
    assert recording.n >= len(run.handed) > 50


def test_ctrl_c_to_the_whole_group(tmp_path):
    run = Run(tmp_path / "a.vtkhdf")
    time.sleep(0.5)
    os.killpg(run.process.pid, signal.SIGINT)
    os.kill(run.recorder, signal.SIGINT)
    run.end()
    recording = _valid(tmp_path / "a.vtkhdf")
    assert recording.status == "interrupted" and recording.n >= len(run.handed) > 50


@pytest.mark.parametrize("wait", [0.31, *(pytest.param(wait, marks=pytest.mark.weekly) for wait in (0.52, 0.73))])
def test_both_are_killed(tmp_path, wait):
    run = Run(tmp_path / "a.vtkhdf")
    time.sleep(wait)
    killed = time.monotonic()
    os.kill(run.recorder, signal.SIGKILL)
    os.killpg(run.process.pid, signal.SIGKILL)
    run.end()
    if not (tmp_path / "a.vtkhdf").exists():
        # Nothing was safe yet.
        assert not run.handed or killed - run.handed[0][1] < WRITTEN_BEHIND
        return
    recording = _valid(tmp_path / "a.vtkhdf")
    assert recording.status == "killed" and "killed" in recording.summary
    lost = [handed for index, handed in run.handed if index >= recording.n]
    assert not lost or killed - lost[0] < WRITTEN_BEHIND


def test_the_recorder_alone_is_killed(tmp_path):
    run = Run(tmp_path / "a.vtkhdf")
    time.sleep(0.5)
    os.kill(run.recorder, signal.SIGKILL)
    assert run.process.wait(timeout=10) != 0
    run.end()
    assert _valid(tmp_path / "a.vtkhdf").n > 0
