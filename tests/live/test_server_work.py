"""What the server says that the simulating process is at."""

from __future__ import annotations

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
    assert not work.busy


def test_what_is_no_event_ends_with_its_frame():
    work = WorkInProgress()
    work.begin({"type": "show", "id": 5})
    work.frame(5)
    assert not work.busy
    work.begin({"type": "rates", "id": 6})
    assert work.busy
    work.answer(6)
    assert not work.busy
