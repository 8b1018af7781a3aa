"""The process of a live session that simulates: what is seen live is what replays."""

import json
import os
import random
import socket

import numpy as np
import pytest
from live_worker import BRACKET, COARSE, LocalSession, bracket, cut, remote_session, replayed

import restshape
from restshape.live import welcome
from restshape.replay.loop import Replay
from restshape.replay.recording.recorder import Recorder


@pytest.fixture(scope="module")
def scene():
    return bracket()


def drag(session, places):
    for x, y in places:
        session.event("drag", to=[x, y])


def path(count, step=0.003):
    return [(0.09 + step * i, 0.062 + 0.0005 * i) for i in range(1, count + 1)]


def test_the_script_of_a_session_replays_to_its_rows_and_its_picture(scene, tmp_path):
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    (welcome,) = session.of("welcome")
    assert (welcome["field"], welcome["dim"], welcome["predicts"]) == ("von_mises", 2, ["none", "linear", "gmls"])
    assert {"press", "drag", "hole", "undo"} <= welcome["events"].keys() and not any(welcome["events"].values())
    session.event("press", on="window", at=[0.09, 0.062])
    drag(session, path(8))
    assert session.of("frame")[-1]["held"] == {"on": "window", "at": list(path(8)[-1])}
    for do in ("release", "undo", "redo"):
        session.event(do)
    session.event("set", key="material.steel.thickness", value="6 mm", frames=3)
    assert session.of("frame")[-1]["held"] is None
    rows = [cut(row) for row in session.rows()]
    assert len(rows) == 16 and rows == replayed(scene, out)
    *_, last = (frame.keep() for frame in restshape.replay(scene, restshape.load_script(out, scene)))
    shape = {key: session.arrays["shape", key] for key in ("points", "cells", "displacement", "value")}
    assert np.array_equal(shape["points"][:, :2], last.mesh.points.astype("f4"))
    assert np.array_equal(shape["cells"], last.mesh.cells)
    assert np.array_equal(shape["displacement"][:, :2], last.displacement.astype("f4"))
    assert np.array_equal(shape["value"], last.von_mises.astype("f4"))
    session.end()


def test_what_is_no_message_and_no_event_is_answered_and_changes_nothing(scene, tmp_path):
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    bad = ["", "[]", "{", '{"type": "event", "id": 3}', '{"type": "dance", "id": 9}', '{"type": "pause", "id": -1}']
    bad += ['{"type": "show", "id": 11, "field": 7}', '{"type": "event", "id": 12, "event": []}']
    # No page says where a file is written.
    elsewhere = str(tmp_path / "elsewhere.jsonl")
    bad += [json.dumps({"type": "save", "id": 13, "path": elsewhere})]
    bad += [json.dumps({"type": "record", "id": 14, "on": True, "path": elsewhere})]
    answers = session.say_all(bad)
    assert [one["type"] for one in answers] == ["refused"] * len(bad)
    assert [one["id"] for one in answers] == [0, 0, 0, 3, 9, 0, 11, 12, 13, 14]
    assert [path.name for path in tmp_path.iterdir()] == [out.name]
    (one,) = session.event("drag", to=[1, 1])
    assert one["type"] == "refused" and "before a press" in one["message"] and one["todo"]
    (one,) = session.event("set", key="material.steel.E", value="1 GPa", wrong=1)
    assert one["type"] == "refused"
    assert len(out.read_text().splitlines()) == 1
    # A press that misses is a frame, and scripts let go of what it does not hold.
    assert [one["type"] for one in session.event("press", on="nowhere")] == ["frame"] * 2
    assert session.event("press", on="window")[0]["columns"]["event"] == "press"
    assert [cut(row) for row in session.rows()] == replayed(scene, out)
    session.end()


def test_a_disk_without_room_ends_no_session_and_what_is_missing_is_written_later(scene, tmp_path, monkeypatch):
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    session.event("press", on="window", at=[0.09, 0.062])
    with monkeypatch.context() as full:
        full.setattr(os, "pwrite", lambda *_: 0)
        drag(session, path(3))
        (note,) = session.of("note")
        assert "no space left" in note["message"] and str(out) in note["message"]
        assert len(out.read_text().splitlines()) == 2
        (refused,) = session.say("save")
        assert refused["type"] == "refused" and "make room" in refused["todo"]
    assert session.of("written")[-1]["count"] == 4
    session.event("release")
    assert session.say("save")[0]["events"] == 5
    assert [cut(row) for row in session.rows()] == replayed(scene, out)
    session.end()


def test_a_session_that_ends_does_not_wait_for_the_frames_that_an_event_has_left(scene, tmp_path):
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    session.link.send(session.message("event", event={"do": "idle", "frames": 100_000}))
    session.link._end.shutdown(socket.SHUT_WR)
    session.worker.run()
    session.drain()
    assert json.loads(out.read_text().splitlines()[1]) == {"t": 0.0, "do": "idle", "frames": 1}
    assert [cut(row) for row in session.rows()] == replayed(scene, out)
    session.end()


def test_edits_of_a_gesture_have_a_number_that_no_earlier_one_has(scene, tmp_path):
    session = LocalSession(scene, out := tmp_path / "session.jsonl")

    def scale(gesture):
        session.say("event", event={"do": "scale", "on": "window", "factor": 1.01}, gesture=gesture)

    for gesture in (1_001, 1_001, 0, 1_002):
        scale(gesture)
    other = LocalSession(scene)
    lines = out.read_text().partition("\n")[2]
    other.say_all([json.dumps({"type": "resume", "lines": lines}, separators=(",", ":"))])
    other.say("event", event={"do": "scale", "on": "window", "factor": 1.01}, gesture=7)
    session.event("undo")
    scale(1_003)
    found = [json.loads(line).get("gesture") for line in out.read_text().splitlines()[1:]]
    assert found == [1, 1, None, 2, None, 3] and json.loads(other.live.all_lines()[-1])["gesture"] == 3
    assert [cut(row) for row in session.rows()] == replayed(scene, out)
    session.end()
    other.end()


@pytest.mark.parametrize("at", ["header", "frame"])
def test_a_recording_for_which_the_disk_has_no_room_ends_and_the_session_goes_on(scene, tmp_path, monkeypatch, at):
    session = LocalSession(scene, out := tmp_path / "session.jsonl", record=tmp_path / "session.vtkhdf")
    session.event("press", on="window", at=[0.09, 0.062])

    def fail(self, *_):
        self._fail("the disk is full", "free space")

    with monkeypatch.context() as full:
        if at == "header":
            full.setattr(Recorder, "add_header", fail)
            answers = session.say("record", on=True)
        else:
            assert session.say("record", on=True)[-1]["type"] == "done" and session.of("frame")[-1]["records"]
            full.setattr(Recorder, "frame", fail)
            answers = session.event("drag", to=[0.1, 0.06])
    assert [one for one in answers if one["type"] == "refused" and "the disk is full" in one["message"]]
    assert session.live.recorder is None
    session.event("drag", to=[0.1, 0.062])
    session.event("release")
    assert session.say("record", on=False)[-1]["type"] == "done" and "records" not in session.of("frame")[-1]
    assert [cut(row) for row in session.rows()][-2:] == replayed(scene, out)[-2:]
    session.end()


def test_places_that_wait_are_merged_and_the_script_has_those_that_were_computed(scene, tmp_path):
    session = LocalSession(scene, out := tmp_path / "session.jsonl")

    def event(do, latest=False, **keys):
        return session.message("event", event={"do": do, **keys}, latest=latest)

    thick = {"key": "material.steel.thickness"}
    messages = [event("press", on="window", at=[0.09, 0.062])]
    messages += [event("drag", True, to=list(place)) for place in path(5)]
    messages += [event("set", True, value=0.008 + 1e-4 * i, **thick) for i in range(3)]
    messages += [event("drag", True, to=list(place)) for place in path(7)]
    messages += [event("release"), event("press", on="window")]
    messages += [event("drag", True, to=[0.1, 0.06]), event("drag", True, to=[0.1, 0.061]), event("release")]
    session.say_all(messages)
    frames = session.of("frame")[1:]
    assert [one["columns"]["event"] for one in frames] == [
        *("press", "set", "drag", "release", "press", "drag", "release")
    ]
    assert [one["id"] for one in frames] == [1, 9, 16, 17, 18, 20, 21]
    lines = [json.loads(line) for line in out.read_text().splitlines()]
    assert lines[3]["to"] == list(path(7)[-1]) and lines[6]["to"] == [0.1, 0.061]
    assert [cut(row) for row in session.rows()] == replayed(scene, out)
    session.end()


def test_numbers_things_fields_and_rates_are_said_and_follow_the_scene(scene, monkeypatch):
    session = LocalSession(scene)
    (greeting,) = session.of("welcome")
    thickness = next(one for one in greeting["numbers"] if one["key"] == "material.steel.thickness")
    assert (thickness["value"], thickness["text"], thickness["unit"]) == (0.008, "8 mm", "m")
    roles = {one["name"]: one["role"] for one in greeting["things"]}
    assert roles["window"] == "hole" and roles["a"] == "vertex" and roles["tip"] == "edge"
    session.worker._say_changes()
    (forms,) = session.drain()
    assert forms["type"] == "known" and forms["events"]["drag"]["properties"]
    session.event("set", key="material.steel.thickness", value=0.01)
    session.worker._say_changes()
    (known,) = [one for one in session.drain() if one["type"] == "known"]
    assert any(one["value"] == 0.01 for one in known["numbers"]) and "things" not in known
    session.event("hole", name="more", center=[0.2, 0.07], radius=0.01)
    monkeypatch.setattr(welcome, "NEWS", 1e3)
    soon = session.worker._say_changes()
    assert soon is not None and 0.0 < soon < 1e3
    monkeypatch.setattr(welcome, "NEWS", 0.0)
    assert session.worker._say_changes() is None
    assert any(one["name"] == "more" for one in session.drain()[-1]["things"])
    (rates,) = session.say("rates", of="window")
    found = session.live.sim.frame.derivative("window")
    assert rates["rates"] == {name: rate.tolist() for name, rate in found.items()}
    (frame,) = session.say("show", field="displacement")
    assert [one["name"] for one in frame["parts"]] == ["shape"]
    size = np.linalg.norm(session.live.sim.frame.displacement, axis=1)
    assert np.array_equal(session.arrays["shape", "value"], size.astype("f4"))
    assert session.say("show", field="colour")[0]["type"] == "refused"
    session.end()


def test_predicted_frames_are_those_of_a_replay_that_predicts_from_the_start(scene, tmp_path):
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    session.event("press", on="window", at=[0.09, 0.062])
    drag(session, path(3, 0.001))
    session.say("show", predict="linear")
    (last,) = session.event("drag", to=[0.0935, 0.063])[:1]
    assert last["columns"]["predicted"] == 1
    assert cut(last["columns"]) == replayed(scene, out, "linear")[-1]
    assert json.loads(out.read_text().splitlines()[0])["note"] == "recorded live with --predict linear"
    assert session.say("save")[-1]["options"] == "--predict linear"
    session.say("show", predict="none")
    (last,) = session.event("drag", to=[0.094, 0.063])[:1]
    assert cut(last["columns"]) == replayed(scene, out)[-1]
    assert "note" not in json.loads(out.read_text().splitlines()[0])
    session.end()


def test_a_session_that_begins_again_is_in_the_same_state(scene, tmp_path):
    session = LocalSession(scene, tmp_path / "session.jsonl")
    session.event("press", on="window", at=[0.09, 0.062])
    drag(session, path(12, 0.005))
    before = {key: value.copy() for key, value in session.arrays.items()}
    row = cut(session.rows()[-1])
    frame = session.say("restart")[0]
    assert cut(frame["columns"]) == row and frame["held"]["at"] == list(path(12, 0.005)[-1])
    assert before.keys() == session.arrays.keys()
    assert all(np.array_equal(value, session.arrays[key]) for key, value in before.items())
    other = LocalSession(scene)
    lines = (tmp_path / "session.jsonl").read_text().partition("\n")[2]
    other.say_all([json.dumps({"type": "resume", "lines": lines}, separators=(",", ":"))])
    assert cut(other.of("frame")[-1]["columns"]) == row
    a, b = (one.event("drag", to=[0.11, 0.07])[0]["columns"] for one in (session, other))
    assert cut(a) == cut(b)
    # After a refused edit, too: the marks are those of the answer before.
    marks = kinds_of_marks(session.of("frame"))
    assert (
        session.event("set", key="material.steel.thickness", value="-1 mm")[0]["columns"]["refused"]
        and "arrows" in marks
    )
    assert kinds_of_marks(session.say("restart")) == marks
    session.end()
    other.end()


def kinds_of_marks(frames):
    """Of the last marks that frames bring."""
    return [mark["kind"] for mark in [one for one in frames if "marks" in one][-1]["marks"]]


def test_a_fault_in_a_frame_leaves_the_event_out_and_the_session_goes_on(scene, tmp_path, monkeypatch):
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    session.event("press", on="window", at=[0.09, 0.062])
    drag(session, path(2))
    whole = Replay._frame

    def fail(self, edit):
        monkeypatch.setattr(Replay, "_frame", whole)
        raise MemoryError("no room")

    monkeypatch.setattr(Replay, "_frame", fail)
    answers = session.event("drag", to=[0.1, 0.06])
    assert [one["type"] for one in answers] == ["lost", "refused", "frame"]
    assert "no room" in answers[1]["message"] and answers[2]["held"]["at"] == list(path(2)[-1])
    session.event("drag", to=[0.1, 0.061])
    session.event("release")
    assert [cut(row) for row in session.rows()] == replayed(scene, out)
    session.end()


def some_message(dice, session):
    """A message of a page that knows no shame."""
    names = ["window", "a", "c", "tip", "nowhere", 7]
    numbers = [0.0, 0.1, -3.0, 1e300, "3 mm", "x", None]
    kinds = ["event", "event", "event", "event", "show", "rates", "strike", "play", "seek", "take", "record", "save"]
    keys = {
        "press": {"on": dice.choice(names), "at": [dice.uniform(0, 0.3), dice.uniform(0, 0.12)]},
        "drag": {"to": [dice.uniform(0, 0.3), dice.choice([0.05, 0.06, *numbers])]},
        "set": {"key": dice.choice(["material.steel.thickness", "loads", "x.y"]), "value": dice.choice(numbers)},
        "hole": {"name": dice.choice(names), "center": [0.2, 0.07], "radius": dice.choice(numbers)},
        "rotate": {"on": dice.choice(names), "by": dice.choice(numbers), "frames": dice.choice([1, 2, 0])},
    }
    do = dice.choice([*keys, "release", "undo", "redo", "dance", "idle"])
    kind = dice.choice(kinds)
    message = session.message(kind)
    if kind == "event":
        message |= {"event": {"do": do, **keys.get(do, {})}, "latest": dice.choice([True, False, False])}
    elif kind == "show":
        message |= {"field": dice.choice(["von_mises", "displacement", "x"]), "marks": dice.choice([True, False])}
    elif kind == "rates":
        message |= {"of": dice.choice(["window", "material.steel.thickness", "x"])}
    elif kind == "seek":
        message |= {"frame": dice.choice([0, 5, -1])}
    elif kind == "record":
        message |= {"on": dice.choice([True, False, 1])}
    if dice.random() < 0.1:
        text = json.dumps(message)
        return text[: dice.randrange(len(text))]
    return message


@pytest.mark.parametrize("count", [150, pytest.param(10_000, marks=pytest.mark.weekly)])
def test_random_messages_are_answered_and_the_script_replays(scene, tmp_path, count):
    session, dice = LocalSession(scene, out := tmp_path / "session.jsonl"), random.Random(count)
    while count > 0:
        several = dice.randint(1, 4)
        session.say_all([some_message(dice, session) for _ in range(several)])
        count -= several
    assert not session.of("lost") and len(session.of("refused")) > 10 and len(session.of("frame")) > 10
    assert [cut(row) for row in session.rows()] == replayed(scene, out)
    session.end()


@pytest.mark.cli
def test_the_process_answers_resumes_and_ends_as_the_server_says(tmp_path):
    words = [word for value in COARSE for word in ("--set", value)]
    out = tmp_path / "session.jsonl"
    with remote_session(BRACKET, *words, "--out", str(out), "--resume") as (session, process):
        line = json.dumps({"t": 0.0, "do": "press", "on": "window", "at": [0.09, 0.062]})
        session.link.send({"type": "resume", "lines": f"{line}\n"})
        assert session.next()["type"] == "welcome"
        assert session.next()["columns"]["event"] == "press"
        number = session.say("event", event={"do": "drag", "to": [0.1, 0.062]})
        assert session.until("written")["count"] == 2
        assert session.until("frame", number)["held"]["at"] == [0.1, 0.062]
        process.kill()
        process.wait()
    assert len(out.read_text().splitlines()) == 3
    restshape.load_script(out, bracket())


@pytest.mark.cli
def test_a_scene_that_is_bad_ends_the_process_with_a_message(tmp_path):
    (tmp_path / "bad.toml").write_text("format = 1")
    with remote_session(tmp_path / "bad.toml") as (_, process):
        assert process.wait(60) == 2
        assert "bad.toml" in process.stderr.read().decode()


def test_an_event_that_the_server_cannot_end_is_cancelled_after_a_frame(scene, tmp_path):
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    session.live.shared = True
    session.event("scale", on="window", factor=1.1)
    before, script = session.rows()[-1], out.read_text()
    turn = {"do": "rotate", "on": "window", "by": 0.1, "frames": 1000}
    later = session.message("event", event={"do": "undo"})
    cancel = session.message("cancel")
    heard = session.say_all([session.message("event", event=turn), later, cancel])
    assert [one["id"] for one in heard if one["type"] == "refused"] == [session.number, later["id"]]
    assert heard[-1] == {"type": "done", "id": cancel["id"]}
    assert out.read_text() == script and cut(session.rows()[-1]) == cut(before)
    session.event("undo")
    session.end()
    assert [cut(row) for row in session.rows()] == replayed(scene, out)
