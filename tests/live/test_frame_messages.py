"""Messages of frames leave out what the page has, and nothing that it may not have."""

from __future__ import annotations

import json

import numpy as np
import pytest

from restshape.live.frame_message import LENGTH, FrameEncoder
from restshape.live.server_frames import BadFrame, KeptFrames
from restshape.live.shown_marks import Lines, Words

LINE = Lines("goal", points=np.zeros((2, 2)), meaning="goal")


def header_of(pieces) -> dict:
    whole = b"".join(bytes(one) for one in pieces)
    (length,) = LENGTH.unpack_from(whole)
    return json.loads(whole[LENGTH.size : LENGTH.size + length])


def test_marks_that_rest_are_left_out_and_those_that_are_gone_are_said():
    encoder = FrameEncoder()
    assert len(header_of(encoder({}, [], [LINE]))["marks"]) == 1
    assert "marks" not in header_of(encoder({}, [], [LINE]))
    assert header_of(encoder({}, [], []))["marks"] == []
    assert "marks" not in header_of(encoder({}, [], []))


def test_a_mark_that_rests_among_others_that_change_is_left_out():
    encoder = FrameEncoder()
    encoder({}, [], [LINE, Words("1 N"), Words("2 N")])
    first, second = header_of(encoder({}, [], [LINE, Words("3 N")]))["marks"]
    assert first is None and second["text"] == "3 N"
    more = header_of(encoder({}, [], [LINE, Words("3 N"), LINE]))["marks"]
    assert more[0] is None and [one["kind"] for one in more[1:]] == ["words", "lines"]


def test_lines_at_nodes_travel_without_places():
    (said,) = header_of(FrameEncoder()({}, [], [LINE.at_nodes(np.array([[4, 5], [5, 6]], dtype=np.int32))]))["marks"]
    assert said["nodes"]["shape"] == [2, 2] and said["nodes"]["type"] == "u4"
    assert not said.keys() & {"points", "moved"}


def test_the_server_keeps_each_mark_with_the_arrays_of_its_frame():
    encoder, kept = FrameEncoder(), KeptFrames()
    frames = [[LINE, Words("1 N")], [LINE, Words("2 N")], [LINE, Words("3 N")], [LINE], [LINE, Words("4 N")]]
    for marks in frames:
        kept.add(b"".join(bytes(one) for one in encoder({}, [], marks)))
    whole = header_of([kept.since(0)])["marks"]
    assert [one["kind"] for one in whole] == ["lines", "words"] and whole[0]["points"]["shape"] == [2, 2]
    assert header_of([kept.since(1)])["marks"][0] is None
    assert header_of([kept.since(1)])["marks"][1]["text"] == "4 N"
    # A page of the third frame has "3 N" in the second place, and not what is there now.
    assert header_of([kept.since(3)])["marks"][1]["text"] == "4 N"
    kept.add(b"".join(bytes(one) for one in encoder({}, [], frames[-1])))
    assert "marks" not in header_of([kept.since(5)])
    bad = FrameEncoder()
    bad({}, [], [LINE, LINE, LINE])
    with pytest.raises(BadFrame):
        kept.add(b"".join(bytes(one) for one in bad({}, [], [LINE, Words("1 N"), LINE])))


@pytest.mark.parametrize("marks", [[], [LINE]])
def test_a_page_that_begins_again_has_all_marks_of_the_frame_and_none_of_those_before(marks):
    """Also where there are none: the page may show marks of the time before."""
    encoder = FrameEncoder()
    encoder({}, [], [LINE])
    encoder.forget()
    assert len(header_of(encoder({}, [], marks))["marks"]) == len(marks)
    # A process that takes the place of another one knows nothing of the page.
    assert len(header_of(FrameEncoder()({}, [], marks))["marks"]) == len(marks)
