"""What a frame of a live session does beside that of a replay, by counts of calls; short cuts lead to the same.

`live_more_ms` of `bench live` has the time.
"""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from counted_calls import called
from live_worker import BRACKET, LocalSession, bracket

import restshape
from restshape import _kernels
from restshape.interface.scripts import WrittenScript, _line_of
from restshape.live.frame_arrays import MessageBody
from restshape.live.grab_parts import OutlineParts
from restshape.live.shape_surface import Colours, ShapeSurface
from restshape.shape.build import outline_from_spec

FISH = Path(__file__).parents[1] / "scenes" / "fish.toml"
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
    assert 200 < np.median(more) <= 356


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


def test_displacements_go_on_from_those_of_a_frame_that_moved_nodes():
    class Space:
        X, cells = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.array([[0, 1, 2]])
        topology, geometry = 1, 1

    surface, colours = ShapeSurface(), Colours("value", "value", False)
    moved, values = np.array([[0.25, 0.0], [0.0, 0.5], [1.0, 1.0]]), np.arange(3.0)
    way = np.array([0.5, 0.25])
    first = surface(Space(), {"displacement": moved, "value": values}, {}, colours)
    rests = surface(Space(), {"displacement": moved + way, "value": values}, {}, colours)
    assert rests.arrays["displacement"] is first.arrays["displacement"] and rests.said["shift"] == [*way, 0.0]


NONE = [np.nan, np.inf, -np.inf]


@pytest.mark.parametrize("count", [0, 1, 7, 8, 9, 40])
@pytest.mark.parametrize("none", [[], NONE[:1], NONE])
def test_fields_that_travel_have_the_extremes_of_what_is_finite(count, none):
    random = np.random.default_rng(count)
    values, moved = random.normal(size=count), random.normal(size=(count, 2))
    values[: len(none)], moved[: len(none), 0] = none[:count], none[:count]
    points, displacement, value, low, high = _kernels.sent_fields(moved, moved, values)
    known = values[np.isfinite(values)]
    assert (low, high) == (known.min(initial=np.inf), known.max(initial=-np.inf))
    assert {one.dtype for one in (points, displacement, value)} == {np.dtype("<f4")}
    np.testing.assert_array_equal(points, moved.astype("<f4"))
    np.testing.assert_array_equal(value, values.astype("<f4"))
    np.testing.assert_array_equal(displacement, np.where(np.isfinite(moved), moved, 0.0).astype("<f4"))


def test_points_of_an_outline_lie_at_their_shares_of_the_way_between_its_control_points():
    """A share of i/2 beside it is the top of half a circle, whose ends are the two control points."""
    controls = np.array([[1.0, 2.0], [3.0, 2.0], [3.0, 6.0]])
    ends = np.array([[0, 0, 0, 1, 2], [1, 1, 1, 2, 0]], dtype=np.int32)
    lines, dots = _kernels.sent_outline(controls, ends, np.array([0.0, 1.0, 0.5 - 0.5j, 0.25, 1.0]), 2)
    np.testing.assert_array_equal(lines, [[1, 2], [3, 2], [2, 1], [3, 3], [1, 2]])
    np.testing.assert_array_equal(dots, controls[:2])
    assert lines.dtype == dots.dtype == np.dtype("<f4")


@pytest.mark.parametrize(
    ("controls", "ends", "shares", "vertices"),
    [
        (np.zeros((3, 3)), [[0], [1]], [0.5], 2),
        (np.zeros((3, 2)), [[0, 1], [1, 2]], [0.5], 2),
        (np.zeros((3, 2)), [[0], [3]], [0.5], 2),
        (np.zeros((3, 2)), [[-1], [1]], [0.5], 2),
        (np.zeros((3, 2)), [[0], [1]], [0.5], 4),
        (np.zeros((3, 2)), [[0], [1]], [0.5], -1),
    ],
)
def test_points_of_an_outline_that_do_not_belong_together_are_refused(controls, ends, shares, vertices):
    with pytest.raises(ValueError, match="control point"):
        _kernels.sent_outline(controls, np.array(ends, dtype=np.int32), np.array(shares, dtype=complex), vertices)


@pytest.mark.parametrize("scene", [BRACKET, FISH])
def test_the_outline_of_a_frame_is_where_its_edges_are(scene):
    """Arcs, straight edges and splines of a shape that has moved, cut as they were before."""
    outline = outline_from_spec(restshape.load(scene).shape)
    parts = OutlineParts()
    parts(outline)
    moved = outline.moved(outline.points * [1.1, 0.9] + [0.01, 0.02])
    edges, vertices, _ = parts(moved)
    starts = [*edges.arrays["starts"], len(edges.arrays["points"])]
    for edge, (first, last) in enumerate(pairwise(starts)):
        curve = moved.point(edge, np.linspace(0.0, 1.0, 2000))
        for point in edges.arrays["points"][first:last]:
            assert np.hypot(*(curve - point).T).min() < 1e-3 * moved.size
    np.testing.assert_array_equal(vertices.arrays["points"], moved.points[: len(moved.vertex_names)].astype("<f4"))
