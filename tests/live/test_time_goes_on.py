"""Scenes that go on in time do so by themselves while that is switched on, and their scripts hold what was computed."""

import json

from live_worker import LocalSession, bracket, cut, replayed

import restshape
from restshape.application import applications

TEMPLATES = [one.folder / "template" / "scene.toml" for _, one in sorted(applications().items())]
(*_, IN_TIME) = [path for path in TEMPLATES if path.exists() and "[effects.dynamics]" in path.read_text("utf-8")]


def test_time_goes_on_until_it_shall_stand_still(tmp_path):
    scene = restshape.load(IN_TIME)
    session = LocalSession(scene, out := tmp_path / "session.jsonl")
    (welcome,) = session.of("welcome")
    assert welcome["goesOn"]
    frame, done = session.say("run", on=True)
    assert frame["runs"] and done["type"] == "done"
    before = session.of("frame")[-1]["number"]
    while session.of("frame")[-1]["number"] < before + 4:
        session.worker.next()
        session.drain()
    assert session.of("frame")[-1]["columns"]["time"] > frame["columns"]["time"]
    session.say("run", on=False)
    assert "runs" not in session.of("frame")[-1]
    count = session.of("frame")[-1]["number"] - before
    session.end()
    events = [json.loads(line) for line in out.read_text().splitlines()[1:]]
    assert [(one["do"], one["frames"]) for one in events] == [("idle", count)]
    assert [cut(row) for row in session.rows()] == replayed(scene, out)


def test_an_edit_comes_between_and_time_goes_on_after_it(tmp_path):
    session = LocalSession(restshape.load(IN_TIME), out := tmp_path / "session.jsonl")
    session.say("run", on=True)
    session.worker.next()
    session.event("analyse")
    for _ in range(3):
        session.worker.next()
    session.drain()
    assert session.of("frame")[-1]["runs"]
    session.end()
    done = [json.loads(line)["do"] for line in out.read_text().splitlines()[1:]]
    assert done == ["idle", "analyse", "idle"]


def test_what_stands_still_cannot_go_on(tmp_path):
    session = LocalSession(bracket())
    assert not session.of("welcome")[0]["goesOn"]
    (answer,) = session.say("run", on=True)
    assert answer["type"] == "refused" and "in time" in answer["message"]
    session.end()
