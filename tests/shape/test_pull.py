"""Pin-and-pull: the pulled point follows the hand, pins stay, all is linear, and what makes no sense is refused."""

import numpy as np
import pytest
from shape_scenes import plate, scene_and_script, shape, square

from restshape.errors import UserError
from restshape.shape.chain import chain_of
from restshape.shape.hand.pull import pull
from restshape.shape.session import EditSession


def strip(kind="polyline"):
    """A strip of 2.5 by 1 whose lower edge has four inner points, evenly spaced."""
    inner = [[0.5 * i, 0.0] for i in range(1, 5)]
    corners = {"a": [0, 0], "b": [2.5, 0], "c": [2.5, 1], "d": [0, 1]}
    edges = {"low": {kind: ["a", "b"], "through": inner}}
    edges |= {name: {"line": list(name)} for name in ("bc", "cd", "da")}
    return shape(vertices=corners, edges=edges, outline=["low", "bc", "cd", "da"], groups={"chain": ["low", "bc"]})


def moves(outline, gesture, c=(0.0, 1.0)):
    return gesture.points(c) - outline.points


def test_points_between_hand_and_pin_follow_the_smooth_step():
    outline = strip()
    gesture, place = pull(outline, "low", (0.5, 0.0), None)
    assert place == pytest.approx((0.5, 0.0))
    # The hand holds a control point, so nothing is scaled: 1 - 3 r^2 + 2 r^3 at r = 1/4, 1/2, 3/4 of the way to b.
    step = moves(outline, gesture)[outline.layout.controls[0]]
    np.testing.assert_allclose(step[:, 1], [0, 1, 27 / 32, 1 / 2, 5 / 32, 0], atol=1e-12)
    np.testing.assert_array_equal(step[:, 0], 0.0)


@pytest.mark.parametrize("kind", ["polyline", "spline"])
@pytest.mark.parametrize("x", [0.31, 1.13, 1.9])
def test_the_pulled_point_follows_the_hand_and_pins_stay(kind, x):
    outline = strip(kind)
    gesture, place = pull(outline, "low", (x, -0.1), ["a", (2.02, 0.01)])
    moved = outline.moved(gesture.points((0.07, -0.2)))
    s = x / 2.5
    np.testing.assert_allclose(moved.point(0, s)[0], np.add(place, [0.07, -0.2]), atol=1e-8)
    controls = outline.layout.controls[0]
    np.testing.assert_array_equal(moved.points[controls[[0, 4, 5]]], outline.points[controls[[0, 4, 5]]])
    others = np.setdiff1d(np.arange(len(outline.points)), controls)
    np.testing.assert_array_equal(moved.points[others], outline.points[others])


def test_a_pull_is_linear_in_the_cursor():
    outline = plate()
    gesture, _ = pull(outline, "top", (1.0, 1.2), None)
    a, b = np.array([0.1, -0.2]), np.array([-0.05, 0.03])
    both = moves(outline, gesture, 2.0 * a + b)
    np.testing.assert_allclose(both, 2.0 * moves(outline, gesture, a) + moves(outline, gesture, b), atol=1e-15)
    assert gesture.linear and not gesture.whole.any()


def test_a_side_without_a_pin_goes_with_the_hand():
    outline = strip()
    gesture, _ = pull(outline, "low", (1.5, 0.0), ["a"])
    step = moves(outline, gesture)[outline.layout.controls[0]]
    np.testing.assert_allclose(step[3:, 1], 1.0)
    assert step[0, 1] == 0.0 and 0.0 < step[1, 1] < step[2, 1] < 1.0


def test_a_chain_of_edges_bends_across_their_common_vertex():
    outline = strip()
    assert chain_of(outline, "chain").length == pytest.approx(3.5)
    gesture, _ = pull(outline, "chain", (2.5, 0.0), None)
    step = moves(outline, gesture, (1.0, 0.0))
    r = 0.5 / 2.5
    assert step[outline.layout.controls[0][4], 0] == pytest.approx(1 - 3 * r**2 + 2 * r**3)
    assert step[outline.vertex_names.index("b"), 0] == pytest.approx(1.0)
    assert not step[[outline.vertex_names.index(name) for name in "acd"]].any()


def test_a_closed_curve_bends_between_its_pins_on_either_way_round():
    outline = square(holes={"gap": {"polygon": [[0.2, 0.2], [0.5, 0.2], [0.8, 0.2], [0.8, 0.8], [0.2, 0.8]]}})
    gesture, _ = pull(outline, "gap", (0.5, 0.2), ["gap.v4"])
    step = moves(outline, gesture)
    index = {name: outline.vertex_names.index(name) for name in outline.vertex_names}
    # v4 at (0.8, 0.8) is 0.9 on the one way and 1.5 on the other.
    for vertex, r in (("gap.v3", 0.3 / 0.9), ("gap.v1", 0.3 / 1.5), ("gap.v5", 0.9 / 1.5), ("gap.v4", 1.0)):
        assert step[index[vertex], 1] == pytest.approx(1 - 3 * r**2 + 2 * r**3, abs=1e-9), vertex
    assert step[index["gap.v2"], 1] == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("on", "at", "pins", "why"),
    [
        ("bottom", (1.0, 0.0), None, "no control point between its pins"),
        ("window", None, None, "is closed: a pull on it needs a pin"),
        ("top", None, ["a"], "a is not a vertex of top"),
        ("top", None, ["nobody"], "no entity named 'nobody'"),
        ("pair", None, None, "do not make one curve"),
        ("a", None, None, "a is not a curve"),
    ],
)
def test_what_cannot_be_pulled_is_refused(on, at, pins, why):
    with pytest.raises(UserError, match=why):
        pull(plate(), on, at, pins)


def test_a_session_pulls_undoes_and_refuses(tmp_path):
    events = [
        {"do": "pull", "on": "top", "at": [1.0, 1.136], "pins": ["d", [1.5, 1.1]]},
        {"do": "drag", "path": [[1.0, 1.2], [1.05, 1.3], [0.5, 0.1]]},
        {"do": "release"},
        {"do": "undo"},
        {"do": "pull", "on": "bottom"},
        {"do": "drag", "to": [0.0, 0.0]},
        {"do": "release"},
    ]
    frames = list(EditSession(*scene_and_script(tmp_path, events)).frames())
    kinds = ["start", "none", "move", "move", "none", "none", "move", "none", "none", "none"]
    assert [f.change for f in frames] == kinds
    assert frames[1].gesture is frames[3].gesture and frames[3].c == pytest.approx((0.05, 0.164))
    assert frames[4].refused.startswith("edge bottom would cross edge top")
    np.testing.assert_array_equal(frames[6].outline.points, frames[0].outline.points)
    assert "no control point" in frames[7].refused
    assert frames[8].refused == "nothing is grabbed"
