"""What a frame of a live session does beside that of a replay, by counts of calls; short cuts lead to the same.

`live_more_ms` of `bench live` has the time.
"""

from __future__ import annotations

import json

import numpy as np
import pytest
from counted_calls import called
from live_worker import LocalSession, bracket

import restshape
from restshape import _kernels
from restshape.interface.scripts import WrittenScript, _line_of
from restshape.live.frame_arrays import MessageBody
from restshape.live.shape_surface import Colours, ShapeSurface

PLACES = [(0.09 + 0.0005 * step, 0.062) for step in range(10)]


def test_a_frame_of_a_page_calls_little_beside_that_of_a_replay(tmp_path):
    session = LocalSession(bracket(), out := tmp_path / "session.jsonl")
    session.event("press", on="window")
    live = []
    for place in PLACES:
        event = {"do": "drag", "to": [*place]}
        session.link.send(session.message("event", event=event, latest=True))
        live.append(called(session.worker.next))
        session.drain()
    session.end()
    run = restshape.replay(bracket(), restshape.load_script(out))
    for _ in range(2):
        next(run)
    more = np.subtract(live, [called(lambda: next(run)) for _ in PLACES])
    assert 200 < np.median(more) <= 545


@pytest.mark.parametrize(
    "table",
    [
        {"t": 0.1, "do": "drag", "to": [1e-7, 0.25]},
        {"t": 1.0, "do": "drag", "to": [0.1, -2e22, 0.0]},
        {"t": 0.1, "do": "drag", "to": ["1 mm", "2 mm"]},
        {"t": "1 s", "do": "drag", "to": [1.0, 2.0]},
        {"t": 1, "do": "drag", "to": [1, 2]},
        {"t": 0.1, "to": [1.0, 2.0], "do": "drag"},
    ],
)
def test_the_line_of_an_event_is_that_of_json(table):
    assert _line_of(table) == json.dumps(table)


def test_a_drag_that_goes_on_is_the_event_that_would_be_read():
    written, read = (WrittenScript(bracket()) for _ in range(2))
    for one in (written, read):
        one.add("press", {"on": "window"})
        one.add("drag", {"to": [0.1, 0.06]})
    quick, slow = written.moved_on([0.2, 0.07]), read.follow({"t": read.t, "do": "drag", "to": [0.2, 0.07]})
    assert quick == slow and quick.model_dump() == slow.model_dump() and written.text() == read.text()


def test_arrays_of_a_message_lie_where_its_header_says():
    body = MessageBody()
    given = [
        np.arange(5.0),
        np.arange(6, dtype=np.uint16).reshape(2, 3)[:, ::-1],
        np.empty((0, 2)),
        np.arange(3),
        np.array([[1.5, np.nan]], dtype=np.float32),
    ]
    places, whole = [body.add(one) for one in given], body.packed()
    assert [one["type"] for one in places] == ["f4", "u2", "f4", "u4", "f4"] and len(whole) == body.size
    for one, place in zip(given, places):
        assert place["at"] % 8 == 0
        found = np.frombuffer(whole, f"<{place['type']}", one.size, place["at"]).reshape(place["shape"])
        np.testing.assert_array_equal(found, one)
    with pytest.raises(ValueError, match="larger"):
        _kernels.packed(given, body.size - 8)


def test_one_pass_over_fields_gives_what_each_array_by_itself_does():
    class Space:
        X, cells = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]]), np.array([[0, 1, 2], [1, 3, 2]])
        topology, geometry = 1, 1

    moved = np.array([[0.1, np.nan], [np.inf, 0.2], [0.0, 0.3], [1e-9, 0.0]])
    for values in (np.array([3.0, np.nan, -1.0, 2.0]), np.full(4, np.nan)):
        one, other, space = ShapeSurface(), ShapeSurface(), Space()
        for surface in (one, other):
            surface(space, {"displacement": moved, "value": values}, {}, Colours("value", "value", False))
        space.geometry, space.X = 2, space.X + 0.1
        quick = one(space, {"displacement": moved, "value": values}, {}, Colours("value", "value", False))
        # Cells have a way of their own, and vectors are reduced to their size first.
        vectors = np.stack([np.abs(values), 0.0 * values], axis=1)
        slow = other(space, {"displacement": moved, "value": vectors}, {}, Colours("value", "value", False))
        for name in ("points", "displacement"):
            np.testing.assert_array_equal(quick.arrays[name], slow.arrays[name])
        np.testing.assert_array_equal(quick.arrays["value"], values.astype(np.float32))
        assert quick.said["range"] == ([-1.0, 3.0] if np.isfinite(values).any() else None)
        assert (slow.said["range"] is None) == (quick.said["range"] is None)
