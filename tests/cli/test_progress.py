"""How far a command is, off a terminal: a line every ten seconds, with the total and the time left."""

import pytest
from small_scenes import drag, plate, write_scene, write_script

from restshape.cli.main import main
from restshape.cli.progress import ProgressLines, duration, progress
from restshape.errors import UserError
from restshape.scene.edit_script import load_script


class Clock:
    """A clock that is set by hand."""

    def __init__(self):
        self.now = 0.0

    def __call__(self):
        return self.now


def test_a_line_every_ten_seconds_with_total_and_time_left(capsys):
    clock = Clock()
    count = ProgressLines("frames", 101, clock)
    for k in range(1, 101):
        # The first frame takes 5 s, each later one 0.5 s.
        clock.now = 5.0 + 0.5 * (k - 1)
        count(1)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "11 of 101 frames, about 45 s left"
    assert lines[1] == "31 of 101 frames, about 35 s left"
    assert len(lines) == 5


def test_nothing_is_printed_of_a_short_command_or_a_quiet_one(capsys):
    with progress(False, 10) as count, progress(True, 10) as silent:
        for _ in range(10):
            count(1)
            silent(1)
    assert capsys.readouterr().err == ""


def test_a_first_step_that_takes_long_has_no_time_left(capsys):
    clock = Clock()
    count = ProgressLines("runs", 20, clock)
    clock.now = 11.0
    count(0)
    assert capsys.readouterr().err == "0 of 20 runs\n"


@pytest.mark.parametrize(("seconds", "words"), [(0.2, "0 s"), (59.4, "59 s"), (200, "3 min 20 s"), (7500, "2 h 5 min")])
def test_durations(seconds, words):
    assert duration(seconds) == words


def test_the_total_is_the_plan_of_the_script(tmp_path, monkeypatch, capsys):
    monkeypatch.setenv("RESTSHAPE_PROGRESS", "0")
    scene = write_scene(tmp_path, plate(0.3))
    script = write_script(tmp_path, drag("window", (0.5, 0.5), [(0.52, 0.5), (0.54, 0.5)]))
    total = load_script(script).frame_count
    assert main(["replay", str(scene), str(script)]) == 0
    printed = capsys.readouterr()
    lines = [line for line in printed.err.splitlines() if " frames" in line and not line.startswith("note:")]
    assert lines[-1] == f"{total} of {total} frames, about 0 s left" and len(lines) == total
    assert printed.out.startswith(f"{total} frames, 0 refused")


def test_a_bad_number_of_seconds_is_refused(monkeypatch):
    monkeypatch.setenv("RESTSHAPE_PROGRESS", "often")
    with pytest.raises(UserError, match="no number of seconds"):
        ProgressLines("frames", 3)


def test_a_fine_first_frame_says_what_it_is_at(tmp_path, capsys):
    scene = write_scene(tmp_path, plate(0.02))
    assert main(["replay", str(scene), "--set", "mesh.order=1"]) == 0
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("first frame:")]
    assert lines[0].startswith("first frame: meshing, about 1") and lines[0].endswith(",000 triangles")
    assert [line.split(", ")[0] for line in lines[1:]][:2] == [
        "first frame: nonzero pattern",
        "first frame: assembling",
    ]
    assert {"first frame: factoring"} <= {line.split(", ")[0] for line in lines}
    # Each stage once, and the number of triangles as the mesh has it.
    assert len(lines) == len(set(lines)) and len({line.rpartition(", ")[2] for line in lines[1:]}) == 1


def test_a_coarse_first_frame_is_silent_unless_it_takes_long(tmp_path):
    from petsc4py import PETSc

    from restshape.application import application_of
    from restshape.calibration import Calibration
    from restshape.policy import policy
    from restshape.replay.first_steps import FirstSteps
    from restshape.replay.loop import Replay
    from restshape.replay.request import Request
    from restshape.scene.edit_script import Script
    from restshape.scene.load import load_scene

    scene = load_scene(write_scene(tmp_path, plate(0.3)), [])
    for now, said in ((0.0, 0), (3.0, 3)):
        found, clock = [], Clock()
        request = Request(scene, Script.empty(scene), application_of(scene), policy("auto"), Calibration.load())
        replay = Replay(request, PETSc.COMM_WORLD)
        FirstSteps(replay, found.append, clock)
        clock.now = now
        next(replay.frames())
        assert len(found) >= said and bool(found) == bool(said), found


@pytest.mark.slow
def test_a_report_says_how_many_pictures_are_drawn(tmp_path, monkeypatch, capsys):
    scene = write_scene(tmp_path, plate(0.3))
    script = write_script(tmp_path, drag("window", (0.5, 0.5), [(0.52, 0.5), (0.54, 0.5)]))
    recording = tmp_path / "a.vtkhdf"
    assert main(["replay", str(scene), str(script), "--out", str(recording)]) == 0
    monkeypatch.setenv("RESTSHAPE_PROGRESS", "0")
    capsys.readouterr()
    assert main(["report", str(recording)]) == 0
    printed = capsys.readouterr()
    lines = [line for line in printed.err.splitlines() if line.endswith("pictures drawn")]
    stills = sum(line.startswith("wrote ") and line.endswith(".png") for line in printed.out.splitlines())
    frames = load_script(script).frame_count
    assert lines == [f"{k + 1} pictures drawn" for k in range(stills + frames)]
