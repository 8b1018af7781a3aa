"""Curves, areas and names of outlines against closed forms."""

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from shape_scenes import PLATE, plate, shape, square

from restshape.errors import UserError
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.curves import bulge_through
from restshape.shape.pieces import distance_outside
from restshape.shape.validity import problem

S = np.linspace(0.0, 1.0, 41)


@pytest.mark.parametrize("angle", [1e-12, 1e-4, 0.5, np.pi / 2, np.pi, 5.5])
@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_arc_is_a_circle_of_even_speed(angle, turn):
    centre, radius, first = np.array([0.3, -0.2]), 1.7, 0.4
    at = first + turn * angle * S
    expected = centre + radius * np.stack([np.cos(at), np.sin(at)], axis=1)
    outline = square()
    points = outline.points.copy()
    points[0], points[1] = expected[0], expected[-1]
    bulges = np.array([turn * np.tan(angle / 4.0), 0.0, 0.0, 0.0])
    arc = outline.moved(points, bulges)
    np.testing.assert_allclose(arc.point(0, S), expected, atol=1e-12)
    rate = radius * turn * angle * np.stack([-np.sin(at), np.cos(at)], axis=1)
    np.testing.assert_allclose(arc.tangent(0, S), rate, atol=1e-9)


def test_all_edges_at_once_have_the_bits_of_each():
    drawn = outline_from_spec(
        ShapeSpec(
            vertices={"a": [0, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1]},
            edges={
                "low": {"spline": ["a", "b"], "through": [[0.3, -0.15], [0.6, 0.1]]},
                "right": {"arc": ["b", "c"], "bulge": 0.3},
                "top": {"line": ["c", "d"]},
                "back": {"polyline": ["d", "a"], "through": [[-0.1, 0.5]]},
            },
            outline=["low", "right", "top", "back"],
        )
    )
    s, first = np.concatenate([S, S[:7], S[3:20], S[::2]]), np.cumsum([0, 41, 7, 17, 21])
    each = [drawn.point(edge, s[first[edge] : first[edge + 1]]) for edge in range(4)]
    np.testing.assert_array_equal(drawn.points_on_all(first, s), np.concatenate(each))
    moved = np.random.default_rng(5).normal(size=drawn.points.shape)
    each = [drawn.point(edge, s[first[edge] : first[edge + 1]], moved) for edge in range(4)]
    np.testing.assert_array_equal(drawn.points_on_all(first, s, moved), np.concatenate(each))
    np.testing.assert_array_equal(drawn.lengths(), [drawn.length(edge) for edge in range(4)])


@pytest.mark.parametrize("angle", [0.3, 2.0, np.pi, 4.0, 6.0])
@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_bulge_through_a_point_of_a_known_circle(angle, turn):
    a, q, b = (np.array([np.cos(t), np.sin(t)]) for t in (0.7, 0.7 + 0.3 * turn * angle, 0.7 + turn * angle))
    assert bulge_through(a, q, b) == pytest.approx(turn * np.tan(angle / 4.0), rel=1e-12)


def test_arc_through_a_point_bulges_to_that_side():
    outline = plate()
    middle = outline.point(1, 0.5)[0]
    np.testing.assert_allclose(middle, [2.2, 0.5], atol=1e-14)


def test_spline_is_the_natural_cubic_of_scipy():
    outline = plate()
    edge = outline.edges[2]
    through = np.array([[2, 1], [1.5, 1.1], [0.8, 1.2], [0.5, 1.1], [0, 1]], dtype=float)
    knots = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(through, axis=0).T))])
    expected = CubicSpline(knots / knots[-1], through, bc_type="natural")
    np.testing.assert_allclose(edge.knots, knots / knots[-1], atol=1e-15)
    np.testing.assert_allclose(outline.point(2, S), expected(S), atol=1e-14)
    np.testing.assert_allclose(outline.tangent(2, S), expected(S, 1), atol=1e-12)
    fine = expected(np.linspace(0, 1, 200001))
    assert outline.length(2) == pytest.approx(np.hypot(*np.diff(fine, axis=0).T).sum(), rel=1e-9)


def test_lengths_of_lines_arcs_and_polylines():
    outline = plate()
    radius = (0.5**2 + 0.2**2) / (2 * 0.2)
    assert outline.length(0) == pytest.approx(2.0, rel=1e-15)
    assert outline.length(1) == pytest.approx(radius * 2 * np.arcsin(0.5 / radius), rel=1e-13)
    assert outline.length(3) == pytest.approx(2 * np.hypot(0.05, 0.3) + np.hypot(0.1, 0.4), rel=1e-14)
    assert sum(outline.length(e) for e in outline.entity("window").edges) == pytest.approx(0.4 * np.pi, rel=1e-14)


@pytest.mark.parametrize("edge", range(4))
def test_points_are_linear_and_homogeneous_in_the_control_points(edge):
    outline, random = plate(), np.random.default_rng(1)
    p, q = random.normal(size=(2, *outline.points.shape))
    both = outline.point(edge, S, 2.0 * p - 3.0 * q)
    np.testing.assert_allclose(both, 2.0 * outline.point(edge, S, p) - 3.0 * outline.point(edge, S, q), atol=1e-13)
    assert not outline.point(edge, S, np.zeros_like(p)).any()


def test_area_of_circles_segments_and_polygons():
    outline = square(holes={"h": {"circle": {"center": [0.4, 0.5], "radius": 0.25}}})
    assert outline.area() == pytest.approx(1.0 - np.pi * 0.25**2, rel=1e-14)
    lens = shape(
        vertices={"a": [-1, 0], "b": [1, 0]},
        edges={"up": {"arc": ["b", "a"], "bulge": 1.0}, "low": {"arc": ["a", "b"], "through": [0, -0.2]}},
        outline=["low", "up"],
    )
    radius = (1 + 0.2**2) / 0.4
    angle = 2 * np.arcsin(1 / radius)
    assert lens.area() == pytest.approx(np.pi / 2 + radius**2 / 2 * (angle - np.sin(angle)), rel=1e-13)


def test_area_below_a_spline_is_its_integral():
    outline = plate()
    through = np.array([[2, 1], [1.5, 1.1], [0.8, 1.2], [0.5, 1.1], [0, 1]], dtype=float)
    knots = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(through, axis=0).T))])
    x, y = (CubicSpline(knots, through[:, k], bc_type="natural") for k in (0, 1))
    fine = np.linspace(0, knots[-1], 400001)
    below = -np.trapz(y(fine) * x(fine, 1), fine)
    radius = (0.5**2 + 0.2**2) / 0.4
    angle = 2 * np.arcsin(0.5 / radius)
    # The two bumps of the polyline on the left cancel.
    expected = below + radius**2 / 2 * (angle - np.sin(angle)) - np.pi * 0.04
    assert outline.area() == pytest.approx(expected, abs=1e-9)


def test_loops_keep_the_material_on_their_left():
    outline = plate()
    signs = {loop.name: np.sign(outline.loop_area(i)) for i, loop in enumerate(outline.loops)}
    assert signs == {"outline": 1.0, "window": -1.0, "patch": 1.0}
    tables = {**PLATE, "outline": ["left", "top", "right", "bottom"]}
    turned = outline_from_spec(ShapeSpec.model_validate(tables))
    assert turned.loop_area(0) == pytest.approx(outline.loop_area(0), rel=1e-14)


def test_straight_pieces_stay_within_the_error():
    outline = plate()
    for e in range(len(outline.edges)):
        chain, fine = outline.polyline(e), outline.point(e, np.linspace(0, 1, 1001))
        a, ab = chain[:-1], np.diff(chain, axis=0)
        t = np.clip(((fine[:, None] - a) * ab).sum(2) / (ab * ab).sum(1), 0, 1)
        gaps = np.linalg.norm(fine[:, None] - a - t[..., None] * ab, axis=2).min(axis=1)
        assert gaps.max() <= 1.05e-3 * outline.size


def test_names_address_what_they_name():
    outline = plate()
    assert outline.entity("b").vertices == (1,)
    assert outline.entity("right").edges == (1,)
    assert outline.entity("window").edges == (4, 5, 6, 7)
    assert len(outline.entity("pair").loops) == 2
    assert outline.names("hole") == ["window"]
    assert outline.vertex_names[outline.embedded[0]] == "probe"
    with pytest.raises(UserError, match="did you mean 'window'"):
        outline.entity("windw")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"outline": ["bottom", "right", "top"]}, "open"),
        ({"outline": ["bottom", "top", "right", "left"]}, "open"),
        ({"outline": None}, "no outline"),
        ({"holes": {"window": {"circle": {"center": [5, 5], "radius": 0.2}}}}, "outside the outline"),
        ({"holes": {"window": {"circle": {"center": [2, 0.9], "radius": 0.2}}}}, "cross"),
        ({"holes": {"bottom": {"circle": {"center": [0.5, 0.5], "radius": 0.2}}}}, "used twice"),
        ({"points": {"probe": [0.5, 0.5]}}, "inside hole window"),
        ({"points": {"probe": [1.0, 0.5], "other": [1.0, 0.5001]}}, "points probe and other would come closer"),
        ({"holes": {"o": {"polygon": [[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.4]]}}}, "ends with its first corner"),
        ({"groups": {"pair": ["windoww"]}}, "no entity"),
        ({"vertices": {**PLATE["vertices"], "lone": [0.1, 0.1]}}, "belongs to no edge"),
        ({"vertices": {**PLATE["vertices"], "b": [0, 0]}}, "zero length"),
    ],
)
def test_shapes_that_cannot_be_are_refused(change, message):
    with pytest.raises(UserError, match=message):
        shape(**{**PLATE, **change})


@pytest.mark.parametrize(("first", "second"), [("p", "q"), ("q", "p")])
def test_edges_that_lie_along_each_other_cross_where_they_do(first, second):
    """A region's edge lies on a part of the outline's bottom, 0.4 to 0.7 m from where that begins."""
    tables = {
        "vertices": {"a": [0, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1], "p": [0.4, 0], "q": [0.7, 0], "r": [0.5, 0.3]},
        "edges": {
            "bottom": {"line": ["a", "b"]},
            "right": {"line": ["b", "c"]},
            "top": {"line": ["c", "d"]},
            "left": {"line": ["d", "a"]},
            "on": {"line": [first, second]},
            "up": {"line": [second, "r"]},
            "down": {"line": ["r", first]},
        },
        "outline": ["bottom", "right", "top", "left"],
        "regions": {"inlay": {"loop": ["on", "up", "down"]}},
    }
    with pytest.raises(UserError, match=r"bottom would cross edge on near \(0\.[47], 0\)"):
        shape(**tables)


@pytest.mark.parametrize(("gap", "wrong"), [(3e-5, False), (1e-6, False), (-1e-6, True), (-3e-5, True)])
@pytest.mark.parametrize("place", [1.47, 1.55, 1.6])
def test_a_vertex_that_pokes_through_an_arc_of_its_neighbours_is_seen(place, gap, wrong):
    # All three edges share vertices with each other, so that no clearance keeps them apart: the tip lies beside the
    # unit circle by less than the straight pieces of its arc know.
    def at(angle, radius=1.0):
        return [radius * np.cos(angle), radius * np.sin(angle)]

    tip = at(place, 1.0 + gap)
    tables = {
        "vertices": {"a": at(2.1), "b": at(1.0), "tip": tip},
        "edges": {
            "round": {"arc": ["a", "b"], "through": at(1.4)},
            "there": {"arc": ["b", "tip"], "through": at(0.5 * (1.0 + place), 1.2)},
            "back": {"arc": ["tip", "a"], "through": at(0.5 * (2.1 + place), 1.2)},
        },
        "outline": ["round", "there", "back"],
    }
    if not wrong:
        assert problem(shape(**tables)) is None
        return
    with pytest.raises(UserError, match=r"edge round would cross edge (there|back)"):
        shape(**tables)


@pytest.mark.parametrize("first", [0.1, 1.3, np.pi / 2, 4.0])
@pytest.mark.parametrize("turn", [1.0, -1.0])
def test_the_box_of_a_disc_is_its_diameter(first, turn):
    centre, radius = np.array([0.3, -0.2]), 1.7
    at = first + turn * np.array([0.0, 1.0, 2.1, 3.5, 4.4, 5.5])
    points = (centre + radius * np.stack([np.cos(at), np.sin(at)], axis=1)).tolist()
    vertices = dict(zip("abc", points[::2]))
    edges = {name: {"arc": [*name], "through": on} for name, on in zip(("ab", "bc", "ca"), points[1::2])}
    disc = shape(vertices=vertices, edges=edges, outline=[*edges])
    np.testing.assert_allclose(disc.bounds(), [centre - radius, centre + radius], atol=1e-14)


def test_the_box_of_an_arc_and_a_spline_is_exact():
    outline = plate()
    lower, upper = outline.bounds()
    assert upper[0] == pytest.approx(2.2, abs=1e-15)
    spline = outline.edges[2]
    cubic = CubicSpline(spline.knots, outline.points[outline.layout.controls[2]], bc_type="natural")
    tops = [cubic(s)[1] for s in cubic.derivative().roots()[1] if 0.0 <= s <= 1.0]
    assert upper[1] == pytest.approx(max(tops), abs=1e-14)
    assert upper[1] > np.max(outline.points[:, 1]) + 1e-4
    np.testing.assert_allclose(lower, [-0.05, 0.0], atol=1e-15)


@pytest.mark.parametrize(
    ("place", "distance"),
    [
        ((1.0, 0.5), 0.0),
        ((1.5, 0.4), 0.0),
        ((0.5, 0.5), 0.2),
        ((0.5, 0.65), 0.05),
        ((1.0, -0.3), 0.3),
        ((-0.3, -0.4), 0.5),
        ((2.3, 0.5), 0.1),
    ],
)
def test_places_outside_are_as_far_as_the_nearest_edge(place, distance):
    assert distance_outside(plate(), np.array(place)) == pytest.approx(distance, abs=3e-3)
