"""Messages of frames leave out what the page has, and nothing that it may not have."""

from __future__ import annotations

import json

import numpy as np
import pytest

from restshape.live.frame_message import LENGTH, FrameEncoder
from restshape.live.shown_marks import Lines

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


@pytest.mark.parametrize("marks", [[], [LINE]])
def test_a_page_that_begins_again_has_all_marks_of_the_frame_and_none_of_those_before(marks):
    """Also where there are none: the page may show marks of the time before."""
    encoder = FrameEncoder()
    encoder({}, [], [LINE])
    encoder.forget()
    assert len(header_of(encoder({}, [], marks))["marks"]) == len(marks)
    # A process that takes the place of another one knows nothing of the page.
    assert len(header_of(FrameEncoder()({}, [], marks))["marks"]) == len(marks)
