"""What happens at signals, closed streams and full disks: each line of the table in docs/safety.md."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from small_scenes import drag, plate, write_scene, write_script

from restshape.cli.main import main
from restshape.cli.signals import ending_signals, exit_code, interrupt_if_asked
from restshape.replay.recording.recording import Recording

FRAMES = 6_000


def write_long(folder, frames):
    """The words of a replay of so many frames."""
    path = [(0.5 + 0.1 * np.sin(0.01 * k), 0.5) for k in range(frames)]
    scene, script = write_scene(folder, plate(0.2)), write_script(folder, drag("window", (0.5, 0.5), path))
    return ("replay", scene, "--edits", script, "--out", "a.vtkhdf")


@pytest.fixture(autouse=True)
def often(monkeypatch):
    """Progress is printed all the time."""
    monkeypatch.setenv("RESTSHAPE_PROGRESS", "0")


def wait_for_frames(stream, total):
    """Returns after the line of a hundred frames."""
    assert any(line.startswith(f"100 of {total} frames, about ") for line in stream)


@pytest.mark.parametrize("number", [signal.SIGHUP, signal.SIGQUIT, signal.SIGTERM])
def test_a_signal_keeps_the_frames(tmp_path, start_restshape, number):
    process = start_restshape(*write_long(tmp_path, FRAMES))
    wait_for_frames(process.stderr, FRAMES + 3)
    process.send_signal(number)
    _, reported = process.communicate(timeout=60)
    assert process.returncode == 128 + number
    assert reported.endswith("restshape replay: interrupted\n") and "MPI_ABORT" not in reported.upper()
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.status == "interrupted" and recording.n >= 100 and recording.verify() == []


def test_a_reader_of_the_progress_that_has_gone_does_not_stop_a_replay(tmp_path, outside):
    words = write_long(tmp_path, 250)
    process = subprocess.Popen(
        [sys.executable, "-m", "restshape.cli.main", *map(str, words)],
        cwd=tmp_path,
        env=outside | {"RESTSHAPE_PROGRESS": "0"},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    wait_for_frames(process.stdout, 253)
    process.stdout.close()
    assert process.wait(timeout=60) == 141
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.status == "done" and recording.n > 250


def test_closed_streams_are_as_those_that_nobody_reads(tmp_path, outside):
    words = " ".join(map(str, write_long(tmp_path, 3)))
    shell = f"{sys.executable} -m restshape.cli.main {words} --json a.json <&- >&- 2>&-"
    assert subprocess.run(["sh", "-c", shell], cwd=tmp_path, env=outside, timeout=60).returncode == 0
    assert (tmp_path / "a.json").exists()
    with Recording(tmp_path / "a.vtkhdf") as recording:
        assert recording.status == "done" and recording.verify() == []


def test_a_full_disk_is_a_message(tmp_path, outside):
    scene = write_scene(tmp_path, plate(), "plate.toml")
    for words in (["list"], ["script", scene, "idle 3"]):
        with open("/dev/full", "w") as full:
            done = subprocess.run(
                [sys.executable, "-m", "restshape.cli.main", *map(str, words)],
                cwd=tmp_path,
                env=outside,
                stdout=full,
                stderr=subprocess.PIPE,
                text=True,
            )
        assert done.returncode == 2
        assert done.stderr.startswith("restshape: ") and "no space left on device" in done.stderr
        assert done.stderr.count("\n") == 1


def test_a_full_disk_leaves_an_earlier_result(command, tmp_path, monkeypatch):
    scene = write_scene(tmp_path, plate(), "plate.toml")
    assert command("script", scene, "idle 3", "--out", "a.jsonl", "--json", "a.json").returncode == 0
    before = {path: path.read_bytes() for path in tmp_path.iterdir()}

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    for option in ("--out", "--json"):
        ended = command("script", scene, "idle 4", option, f"a.json{'l' * (option == '--out')}")
        assert ended.returncode == 2 and "cannot be written: no space left on device" in ended.stderr
    assert {path: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_ctrl_c_during_imports(monkeypatch, capsys):
    def interrupted(name, petsc):
        os.kill(os.getpid(), signal.SIGINT)
        time.sleep(1)

    monkeypatch.setattr("restshape.cli.main.named_command", interrupted)
    assert main(["list"]) == 130
    assert capsys.readouterr().err == "restshape list: interrupted\n"


INTERRUPTER = """
import os, signal, sys


class Interrupter:
    def find_spec(self, name, path=None, target=None):
        if name == os.environ["AT"]:
            os.kill(os.getpid(), signal.SIGINT)


sys.meta_path.insert(0, Interrupter())
"""
"""Has Python send Ctrl-C to itself where it is about to import a module."""


@pytest.mark.parametrize("at", ["restshape.surroundings", "restshape.cli", "restshape.cli.parser"])
@pytest.mark.parametrize("start", [["-m", "restshape.cli.main"], [str(Path(sys.executable).with_name("restshape"))]])
def test_ctrl_c_during_the_first_imports(tmp_path, outside, start, at):
    (tmp_path / "sitecustomize.py").write_text(INTERRUPTER)
    paths = f"{tmp_path}:{outside.get('PYTHONPATH', '')}".rstrip(":")
    done = subprocess.run(
        [sys.executable, *start, "list"],
        env=outside | {"PYTHONPATH": paths, "AT": at},
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "restshape: interrupted\n")


def test_a_program_that_imports_restshape_keeps_its_own_handling(outside):
    code = "import restshape, signal; assert signal.getsignal(signal.SIGINT) is signal.default_int_handler"
    assert subprocess.run([sys.executable, "-c", code], env=outside, timeout=60).returncode == 0


def test_a_signal_that_was_swallowed_still_ends_a_command():
    with ending_signals():
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), signal.SIGTERM)
            time.sleep(1)
        with pytest.raises(KeyboardInterrupt):
            interrupt_if_asked()
        assert exit_code() == 143
    with ending_signals():
        interrupt_if_asked()


def test_the_recorder_stays_on_the_cores_of_its_parent(tmp_path, monkeypatch):
    from restshape.replay.recording.recorder import Recorder

    for name in [name for name in os.environ if name.startswith(("OMPI_", "PMIX_", "PMI_"))]:
        monkeypatch.delenv(name)
    before = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(before)})
    try:
        with Recorder.start(tmp_path / "a.vtkhdf", {}, {}) as recorder:
            assert os.sched_getaffinity(recorder.process_id) == {min(before)}
    finally:
        os.sched_setaffinity(0, before)
