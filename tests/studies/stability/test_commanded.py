"""What the fuzz asks of the command itself: exit code, message, recording, JSON and CSV; what is wrong is reported."""

import json

import pytest
from restshape_studies.stability.commanded import command_problem
from restshape_studies.stability.example import Example
from restshape_studies.stability.player import Fault, play
from small_scenes import across, drag, plate, write_script

from restshape import _kernels
from restshape.cli import replay
from restshape.replay.recording.recorder import Recorder

PATH = [*across((0.5, 0.5), (0.54, 0.5), 3), (0.5, 5.0)]


@pytest.fixture
def example(tmp_path):
    """A drag of seven frames, the last one of the drag beyond the plate; its files are in tmp_path."""
    edits = write_script(tmp_path, drag("window", (0.5, 0.5), PATH)).read_text()
    made = Example("plane", plate(0.3), edits, "auto", "none", written=True)
    made.write(tmp_path)
    return made


@pytest.mark.slow
def test_what_a_command_writes_is_read(tmp_path, example):
    played = play(tmp_path, example)
    assert (played.message, played.frames, played.refused, played.written) == ("", 7, 1, True)
    assert {"frames.vtkhdf", "frames.csv", "summary.json"} <= {path.name for path in tmp_path.iterdir()}
    assert "ends with 0" in command_problem(tmp_path, example, "no such thing", 7, 1)
    assert "7 frames, 1 refused, not 7, 0" in command_problem(tmp_path, example, "", 7, 0)


@pytest.mark.slow
def test_refusals_as_a_whole_and_in_the_middle(tmp_path, example):
    torn = Example("plane", example.scene, example.edits + '{"t": 9, "do": "fly"}\n', "auto", "none", written=True)
    torn.write(tmp_path)
    played = play(tmp_path, torn)
    assert "fly" in played.message and (played.frames, played.written) == (7, True)
    assert "ends with 2" in command_problem(tmp_path, torn, "", 7, 1)
    none = Example("plane", "app = 3", example.edits, "auto", "none", written=True)
    none.write(tmp_path)
    played = play(tmp_path, none)
    assert played.message and (played.frames, played.written) == (0, True)


def test_how_long_a_frame_takes_is_judged_by_whoever_watches(tmp_path, example, monkeypatch):
    """The command's own limit would end the process that plays, on a busy machine within seconds of computing."""
    limits = []
    watch = _kernels.watch
    monkeypatch.setattr(_kernels, "watch", lambda seconds, *rest: (limits.append(seconds), watch(seconds, *rest)))
    assert command_problem(tmp_path, example, "", 7, 1) == "" and limits == [0.0]


@pytest.mark.slow
def test_wrong_files_are_faults(tmp_path, example, monkeypatch):
    def with_nan(args, data):
        args.json.write_text(json.dumps({**data, "unknowns": float("nan")}))

    with monkeypatch.context() as changed:
        changed.setattr(replay, "write_json", with_nan)
        with pytest.raises(Fault, match="NaN stands where null should"):
            play(tmp_path, example)
    close = Recorder.close
    with monkeypatch.context() as changed:
        changed.setattr(Recorder, "close", lambda self, status="done": close(self, "interrupted"))
        with pytest.raises(Fault, match=r"the recording \(interrupted\)"):
            play(tmp_path, example)
    with monkeypatch.context() as changed:
        changed.setattr(replay, "_print_and_write", lambda *_: 1)
        with pytest.raises(Fault, match="the command ends with 1"):
            play(tmp_path, example)


def test_a_table_that_lacks_a_row_is_a_fault(tmp_path, example, monkeypatch):
    write = replay._print_and_write

    def printed(args, request, summary):
        args.csv.write_text("".join(args.csv.read_text().splitlines(keepends=True)[:-1]))
        return write(args, request, summary)

    monkeypatch.setattr(replay, "_print_and_write", printed)
    with pytest.raises(Fault, match="the CSV file has 6 rows"):
        play(tmp_path, example)


def test_a_message_that_cannot_be_printed_is_an_error(tmp_path, example, monkeypatch):
    monkeypatch.setattr(replay, "print_summary", lambda summary, application: print("\udc80"))
    with pytest.raises(UnicodeEncodeError):
        play(tmp_path, example)
