"""A script that is played in a live session, and taken over by the hand at any frame."""

import json

import numpy as np
import pytest
from live_worker import LocalSession, bracket, cut, replayed

import restshape
from restshape.live.frame_arrays import PicturePart
from restshape.live.moment import HEADER_BYTES, KeptMoments, Moment
from restshape.live.played_events import played_events
from restshape.live.shown_marks import Lines, Words

EVENTS = [
    {"do": "press", "on": "window", "at": [0.09, 0.062]},
    {"do": "drag", "to": [0.11, 0.062], "frames": 5},
    {"do": "drag", "path": [[0.112, 0.063], [0.114, 0.064], [0.116, 0.063]]},
    {"do": "release"},
    {"do": "idle", "frames": 4},
    {"do": "set", "key": "material.steel.thickness", "value": "6 mm", "frames": 4},
    {"do": "undo"},
]


@pytest.fixture(scope="module")
def scene():
    return bracket()


@pytest.fixture(scope="module")
def script(scene):
    return restshape.new_script(scene, EVENTS)


def test_a_script_is_stepped_and_scrubbed_to_the_frames_of_its_replay(scene, script):
    session = LocalSession(scene, script=script)
    (welcome,) = session.of("welcome")
    assert welcome["player"] and welcome["frames"] == script.frame_count == 20
    rows = [cut(frame.row) for frame in restshape.replay(scene, script)]
    shown = {}
    for number in (4, 12, 2, 19, 7, 7):
        session.say("seek", frame=number)
        frame = session.of("frame")[-1]
        assert cut(frame["columns"]) == rows[number]
        picture = {key: value.copy() for key, value in session.arrays.items()}
        known = shown.setdefault(number, picture)
        assert all(np.array_equal(known[key], value) for key, value in picture.items())
    assert session.of("player")[-1] == {"type": "player", "playing": False, "frame": 7, "frames": 20}
    (answer,) = session.event("release")
    assert answer["type"] == "refused" and "take" in answer["todo"]
    session.end()


def test_the_first_frame_is_gone_back_to_after_another_field_was_chosen(scene, script):
    session = LocalSession(scene, script=script)
    session.say("seek", frame=5)
    session.say("show", field="displacement")
    for number in (0, 3):
        session.say("seek", frame=number)
        assert session.of("frame")[-1]["number"] == number == session.of("player")[-1]["frame"]
    session.end()


def test_a_script_plays_at_its_pace_until_its_end_or_a_pause(scene, script):
    session = LocalSession(scene, script=script)
    session.say("play", speed=1000.0)
    for _ in range(100):
        session.worker.next()
        session.drain()
        if session.of("frame")[-1]["number"] == 9:
            break
    assert session.of("player")[-1]["playing"]
    assert not [one for one in session.say("pause") if one["type"] == "player"][-1]["playing"]
    session.say("play", speed=1000.0)
    while session.worker.player.playing:
        session.worker.next()
        session.drain()
    assert [cut(row) for row in session.rows()] == [cut(frame.row) for frame in restshape.replay(scene, script)]
    session.end()


@pytest.mark.parametrize("back", [False, True])
@pytest.mark.parametrize(("at", "ends"), [(3, 3), (8, 8), (11, 11), (15, 18), (0, 0)])
def test_the_hand_takes_over_at_any_frame(scene, script, tmp_path, at, ends, back):
    """An event of several frames that is no drag and no rest is carried out to its end first."""
    session = LocalSession(scene, out := tmp_path / "taken.jsonl", script)
    if back:
        session.say("seek", frame=19)
    session.say("seek", frame=at)
    answers = session.say("take")
    assert answers[-2]["type"] == "welcome" and not answers[-2]["player"]
    assert answers[-1]["number"] == ends
    # A page begins with an empty picture where it is welcomed.
    assert {part["name"] for part in answers[-1]["parts"]} == {name for name, _ in session.arrays}
    rows = [cut(frame.row) for frame in restshape.replay(scene, script)][: ends + 1]
    assert replayed(scene, out) == rows
    held = answers[-1]["held"]
    if held:
        session.event("drag", to=[0.1, 0.06])
        session.event("release")
    session.event("press", on="window")
    session.event("drag", to=[0.1, 0.061])
    new = [cut(row) for row in session.rows() if row["index"] > ends][-2 - 2 * bool(held) :]
    assert replayed(scene, out) == rows + new
    session.end()


def test_a_script_in_millimetres_is_one_in_metres_once_it_is_taken(scene, tmp_path):
    lines = [
        {"format": "restshape-edits", "version": 1, "units": "mm"},
        {"t": 0.0, "do": "press", "on": "window", "at": [90, 62], "along": [2, 1]},
        {"t": 0.016, "do": "drag", "to": [95.3, "6.4 cm"]},
        {"t": 0.02, "do": "release"},
        {"t": 0.1, "do": "hole", "name": "more", "center": [200, 70], "radius": 7},
    ]
    (tmp_path / "mm.jsonl").write_text("\n".join(map(json.dumps, lines)) + "\n")
    script = restshape.load_script(tmp_path / "mm.jsonl", scene)
    session = LocalSession(scene, out := tmp_path / "taken.jsonl", script)
    session.say("seek", frame=4)
    session.say("take")
    assert replayed(scene, out) == replayed(scene, tmp_path / "mm.jsonl")
    assert "units" not in out.read_text()
    session.end()


def test_events_keep_their_times_and_their_room(script):
    events = played_events(script)
    assert [event.frames for event in events] == [1, 5, 3, 1, 4, 4, 1]
    assert [event.t for event in events] == [event.t for event in script.events]
    assert events[-1].room == float("inf") and events[1].room == pytest.approx(events[2].t - events[1].t)


def test_kept_frames_are_bounded_and_count_shared_arrays_once():
    shared, kept = np.zeros(100), KeptMoments(3 * 800 + 2 * HEADER_BYTES)
    for number in range(6):
        arrays = {"cells": shared, "points": np.zeros(100)}
        part = PicturePart("shape", "surface", "shape", arrays)
        kept.add(Moment({"number": number}, [part], (), 0.0))
    assert [number for number in range(6) if kept.get(number)] == [4, 5]


def test_kept_frames_are_bounded_by_their_marks_too():
    """A recording is simulated beside itself for its marks alone."""
    kept = KeptMoments(2 * 80_000 + 2 * HEADER_BYTES)
    for number in range(6):
        kept.add(Moment({"number": number}, (), [Lines("seams", np.zeros((5000, 2))), Words("here")], 0.0))
    assert [number for number in range(6) if kept.get(number)] == [4, 5]
