"""A recording in place of a scene: played from its frames, and taken over by the hand."""

import json
import socket

import numpy as np
import pytest
from live_worker import BRACKET, COARSE, LocalSession, Page, bracket, cut

import restshape
from restshape.live.frame_header import errors_of, header_of
from restshape.live.json_text import json_bytes
from restshape.live.link import Link
from restshape.live.recording_player import RecordingPlayer
from restshape.live.recording_session import RecordingSession
from restshape.replay.recording.recording import Recording

EVENTS = [
    {"do": "press", "on": "window", "at": [0.09, 0.062]},
    {"do": "drag", "to": [0.11, 0.062], "frames": 4},
    {"do": "release"},
]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """A session that was recorded from its third event on, and its rows."""
    path = tmp_path_factory.mktemp("recorded") / "session.vtkhdf"
    session = LocalSession(bracket(), record=path)
    for event in EVENTS[:2]:
        session.event(**event)
    assert [one["type"] for one in session.say("record", on=True)] == ["frame", "done"]
    session.event(**EVENTS[2])
    session.say("record", on=False)
    session.event("undo")
    session.end()
    return path, [cut(row) for row in session.rows()]


class Viewer(Page):
    """A page that looks at a recording."""

    def __init__(self, path):
        super().__init__()
        here, there = socket.socketpair()
        for end in (here, there):
            end.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 1 << 23)
        self.link = Link(here)
        self.recording = Recording(path)
        self.session = RecordingSession(Link(there), RecordingPlayer(self.recording), "")
        self.session.start()
        self.drain()

    def drain(self):
        return [self.take(content) for content in self.link.waiting()]

    def say(self, type, **keys):
        self.link.send(self.message(type, **keys))
        self.session.next()
        return self.drain()


def test_a_session_is_recorded_from_its_beginning_whenever_that_is_asked_for(recorded):
    path, rows = recorded
    with Recording(path) as recording:
        assert recording.n == 7 and recording.status == "done"
        assert recording.verify() == []
        for name in ("q_sag", "q_stress_at_window", "level"):
            assert recording.table[name].tolist() == [row[name] for row in rows[:7]]
        scene = bracket()
        assert [frame.row["q_sag"] for frame in restshape.replay(scene, RecordingPlayer(recording).script)] == (
            recording.table["q_sag"].tolist()
        )


def test_a_recording_is_played_from_its_frames(recorded):
    path, rows = recorded
    viewer = Viewer(path)
    (welcome,) = viewer.of("welcome")
    assert (welcome["player"], welcome["frames"], welcome["field"]) == (True, 7, "von_mises")
    assert not welcome["goals"]
    assert {one["name"] for one in welcome["quantities"]} == {"sag", "stress_at_window", "wall_force"}
    for number in (3, 6, 1):
        viewer.say("seek", frame=number)
        columns = viewer.of("frame")[-1]["columns"]
        assert columns["q_sag"] == rows[number]["q_sag"] and columns["event"] == rows[number]["event"]
        assert np.array_equal(viewer.arrays["shape", "value"], viewer.recording.field(number, "von_mises").astype("f4"))
        assert np.array_equal(viewer.arrays["shape", "points"][:, :2], viewer.recording.points(number).astype("f4"))
    assert len(viewer.arrays["outline", "starts"]) == 8
    (frame,) = viewer.say("show", field="displacement")
    assert frame["number"] == 1 and frame["parts"]
    (answer,) = viewer.say("event", event={"do": "undo"})
    assert answer["type"] == "refused" and "take" in answer["todo"]
    viewer.say("play", speed=1000.0)
    while viewer.session._controls.playing:
        viewer.session.idle()
    viewer.drain()
    assert viewer.of("frame")[-1]["number"] == 6


def test_a_recording_that_is_taken_over_names_the_frame(recorded):
    viewer = Viewer(recorded[0])
    viewer.say("seek", frame=4)
    viewer.link.send(viewer.message("take"))
    viewer.session.run()
    assert viewer.session.taken == 4


@pytest.mark.cli
def test_the_process_goes_on_from_the_frame_that_is_taken(recorded, tmp_path):
    from live_worker import remote_session, replayed

    out = tmp_path / "taken.jsonl"
    with remote_session(recorded[0], "--out", str(out)) as (session, _):
        session.until("frame")
        session.say("seek", frame=4)
        session.until("done")
        session.say("take")
        assert session.until("welcome")["player"] is False
        assert cut(session.until("frame")["columns"]) == recorded[1][4]
        number = session.say("event", event={"do": "drag", "to": [0.1, 0.06]})
        last = cut(session.until("frame", number)["columns"])
    assert replayed(restshape.load("docs/examples/bracket.toml", *COARSE), out) == [*recorded[1][:5], last]


def test_frames_of_a_recording_have_the_errors_and_limits_of_those_that_were_live(tmp_path):
    scene = restshape.load(BRACKET, *COARSE, "quantities.stress_at_window.max='1 Pa'")
    for frame in restshape.replay(scene, out=tmp_path / "one.vtkhdf"):
        live = header_of(frame.row, scene, None)
    assert live["limits"] == {"stress_at_window": "fails"} and live["errors"]["stress_at_window"] > 0
    (shown,) = Viewer(tmp_path / "one.vtkhdf").of("frame")
    assert (shown["limits"], shown["errors"]) == (live["limits"], live["errors"])


def test_an_error_without_a_limit_is_said_and_one_that_is_not_estimated_is_not():
    row = {"a_error": np.inf, "b_error": np.nan, "c_error": 2.0}
    found = errors_of(row, ["a", "b", "c", "d"])
    assert found == {"a": np.inf, "c": 2.0}
    assert json.loads(json_bytes(found)) == {"a": None, "c": 2.0}


def test_a_recording_has_the_marks_of_its_scene_where_the_session_had_them(recorded):
    path, _ = recorded
    live = LocalSession(bracket())
    for event in EVENTS[:2]:
        live.event(**event)
    viewer = Viewer(path)
    viewer.say("seek", frame=5)
    frame, shown = viewer.of("frame")[-1], live.of("frame")[-1]
    assert frame["number"] == shown["number"] == 5
    there, here = ({one["name"]: one for one in of["marks"] if one["kind"] != "words"} for of in (shown, frame))
    conditions = {name for name in there if name.startswith(("support", "load")) or name == "gravity"}
    assert len(conditions) == 3 and conditions <= here.keys()
    for name in conditions:
        one, other = ((of[name]["kind"], {*of[name].get("words", ())} - {""}) for of in (here, there))
        assert one == other, name
        assert here[name].keys() & {"moved", "nodes"}
    # Extremes are said at the same places.
    said = [[one for one in of["marks"] if one["kind"] == "value"] for of in (frame, shown)]
    assert said[0] and all(one in said[1] for one in said[0])
    viewer.say("show", marks=False)
    assert viewer.of("frame")[-1]["marks"] == []
    live.end()


def known_marks(viewer, number):
    """The marks of a frame, once there is nothing left to find out about it."""
    viewer.say("seek", frame=number)
    while viewer.session._beside.wants(number):
        viewer.session.idle()
    viewer.drain()
    return next(one["marks"] for one in reversed(viewer.of("frame")) if "marks" in one)


def test_a_recording_shows_what_the_application_says_beside_it(recorded):
    path, _ = recorded
    live = LocalSession(bracket())
    there = {frame["number"]: frame for event in EVENTS for frame in live.event(**event) if frame["type"] == "frame"}
    viewer = Viewer(path)
    for number in (5, 2):
        marks = known_marks(viewer, number)
        assert viewer.of("frame")[-1]["number"] == number
        # All but where their arrays lie in the message.
        said = ("kind", "name", "text", "meaning", "words", "node", "unit")
        pair = (marks, there[number]["marks"])
        plain = [[{key: one.get(key) for key in said} for one in of] for of in pair]
        assert plain[0] == plain[1] and len(plain[0]) > 3
    assert not viewer.of("note")
    viewer.say("show", marks=False)
    assert viewer.of("frame")[-1]["marks"] == []
    live.end()
    viewer.session._beside.close()


def test_a_recording_of_other_frames_says_that_they_are_others(recorded, monkeypatch):
    viewer = Viewer(recorded[0])
    points = viewer.recording.points
    monkeypatch.setattr(viewer.recording, "points", lambda number: points(number) + 1e-4 * (number == 3))
    known_marks(viewer, 2)
    assert not viewer.of("note")
    known_marks(viewer, 3)
    (note,) = viewer.of("note")
    assert "frame 3" in note["message"] and "take the recording over" in note["message"]
    assert not viewer.session._beside.wants(2)


def test_another_frame_is_one_whose_quantities_differ_by_more_than_rounding(tmp_path, monkeypatch):
    """The force at the wall has no part across the load, but for what the solver leaves."""
    path, across = tmp_path / "session.vtkhdf", 'quantities.across={reaction="x",at="wall"}'
    scene = restshape.load(BRACKET, *COARSE, across)
    for _ in restshape.replay(scene, restshape.new_script(scene, EVENTS), out=path):
        pass
    viewer = Viewer(path)
    table = viewer.recording.table
    assert 0.0 < np.abs(table["q_across"]).max() < 1e-6 * np.abs(table["q_wall_force"]).max()
    monkeypatch.setitem(table, "q_across", -table["q_across"])
    known_marks(viewer, 2)
    assert not viewer.of("note")
    monkeypatch.setitem(table, "q_sag", table["q_sag"] * (1.0 + 1e-4))
    known_marks(viewer, 3)
    assert "frame 3" in viewer.of("note")[0]["message"]


@pytest.mark.parametrize(("first", "said"), [(4e3, ""), (9e3, "its first frame took 9.0 s")])
def test_a_first_frame_that_takes_long_is_not_computed_again(recorded, monkeypatch, first, said):
    """Nothing of the page interrupts it."""
    viewer = Viewer(recorded[0])
    monkeypatch.setitem(viewer.recording.table, "ms", np.array([first, *viewer.recording.table["ms"][1:]]))
    known_marks(viewer, 0)
    assert [said in one["message"] for one in viewer.of("note")] == [True] * bool(said)
    viewer.session._beside.close()
