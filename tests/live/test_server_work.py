"""What the server says that the simulating process is at."""

from __future__ import annotations

import time

from restshape.live.server_work import WorkInProgress


def test_an_event_lasts_until_it_is_written_down_and_merged_ones_end_with_the_last():
    work = WorkInProgress()
    work.frame(0)
    assert not work.busy
    work.begin({"type": "event", "id": 1, "event": {"do": "drag"}})
    work.begin({"type": "event", "id": 2, "event": {"do": "drag"}})
    work.frame(2)
    assert work.busy and work.what == "drag"
    work.written(2)
    assert not work.busy
    work.begin({"type": "event", "id": 3, "event": {"do": "drag"}})
    work.begin({"type": "event", "id": 4, "event": {"do": "drag"}})
    work.written(0)
    assert work.busy
    # The last frame of an event comes after the line that it has in the script.
    work.written(4)
    work.frame(4)
    assert not work.busy and not work.has_shown


def test_an_event_of_many_frames_takes_long_though_each_is_quick(monkeypatch):
    clock = [0.0]
    monkeypatch.setattr(time, "monotonic", lambda: clock[0])
    work = WorkInProgress()
    work.frame(0)
    work.begin({"type": "event", "id": 1, "event": {"do": "idle"}})
    for clock[0] in (0.2, 0.4, 0.6):
        work.frame(1)
        assert work.seconds() == clock[0] and work.has_shown
    work.written(1)
    assert work.seconds() == 0.0 and not work.has_shown
    # Drags that follow each other are events of their own.
    for number in (2, 3, 4):
        work.begin({"type": "event", "id": number, "event": {"do": "drag"}})
    for clock[0], number in ((0.8, 2), (1.0, 3)):
        work.written(number)
        work.frame(number)
        assert work.seconds() == 0.0 and not work.has_shown


def test_what_is_no_event_ends_with_its_frame():
    work = WorkInProgress()
    work.begin({"type": "show", "id": 5})
    work.frame(5)
    assert not work.busy
    work.begin({"type": "rates", "id": 6})
    assert work.busy
    work.answer(6)
    assert not work.busy
