"""B-splines of drawings become edges that are the same curves, and cubic edges the same B-splines."""

import curve_areas
import ezdxf
import numpy as np
import pytest
from scipy.interpolate import BSpline

from restshape.export.dxf_drawing import write_dxf
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.curves import spline_weights
from restshape.shape.drawings.bsplines import beziers_of, cubic_between, cubic_of, edges_of_cubic

OPEN = [(0, 0), (1, 2), (3, -1), (4, 3), (6, 2), (7, 4)]
ROUND = [(5, 0), (4, 4), (-3, 5), (-5, 1), (-2, -4), (4, -3), (5, 0)]
PARAMETERS = np.linspace(0.0, 1.0, 101)


@pytest.mark.parametrize(
    ("ends", "knots"),
    [
        (("natural", "natural"), (0.0, 0.7, 1.0)),
        (("smooth", "natural"), (0.0, 0.2, 1.0)),
        (("natural", "smooth"), (0.0, 0.1, 0.5, 1.0)),
        (("smooth", "smooth"), (0.0, 0.3, 0.6, 0.8, 1.0)),
    ],
)
def test_a_spline_edge_is_one_cubic_and_comes_back(ends, knots):
    points = np.random.default_rng(len(knots)).normal(size=(len(knots), 2))
    edge = spline_weights(knots, ends, PARAMETERS) @ points
    curve = cubic_of(points, knots, ends)
    np.testing.assert_allclose(curve(PARAMETERS), edge, atol=1e-13)
    ((back, own, conditions),) = edges_of_cubic(curve.t, curve.c)
    np.testing.assert_allclose(spline_weights(own, conditions, PARAMETERS) @ back, edge, atol=1e-13)
    inside = np.array([curve_areas.bezier(piece)(np.array([0.25]))[0][0] for piece in beziers_of(points, knots, ends)])
    quarter = np.array(knots[:-1]) + 0.25 * np.diff(knots)
    np.testing.assert_allclose(inside, spline_weights(knots, ends, quarter) @ points, atol=1e-13)


def test_no_export_and_import_adds_points():
    """At "smooth" ends an edge goes through a point that is no knot of its polynomials."""
    knots, ends = (0.0, 0.3, 0.6, 0.8, 1.0), ("smooth", "smooth")
    points = np.random.default_rng(5).normal(size=(5, 2))
    for _ in range(5):
        curve = cubic_of(points, knots, ends)
        ((points, knots, ends),) = edges_of_cubic(curve.t, curve.c)
        assert len(points) == 5


def drawn(path, controls, degree=3, closing=()) -> float:
    """The area [m^2] in a drawing in metres of a spline and lines, by ezdxf's Bézier pieces."""
    drawing = ezdxf.new("R2010", units=6)
    space = drawing.modelspace()
    spline = space.add_open_spline([(x, y, 0) for x, y in controls], degree, dxfattribs={"layer": "curve"})
    for a, b in closing:
        space.add_line(a, b, dxfattribs={"layer": "rest"})
    drawing.saveas(path)
    if degree != 3:
        return np.nan
    pieces = [np.array([tuple(p)[:2] for p in one]) for one in spline.construction_tool().bezier_decomposition()]
    return curve_areas.enclosed([*map(curve_areas.bezier, pieces), *(curve_areas.line(a, b) for a, b in closing)], 1e-6)


@pytest.mark.parametrize(("controls", "edges"), [(OPEN, 1), (ROUND, 2), (OPEN[:4], 1)])
def test_a_cubic_of_another_program_is_read_exactly(tmp_path, controls, edges):
    closing = [(controls[-1], (-1, 6)), ((-1, 6), controls[0])] if edges == 1 else []
    area = drawn(tmp_path / "curve.dxf", controls, closing=closing)
    outline = outline_from_spec(ShapeSpec(file="curve.dxf"), tmp_path)
    assert outline.area() == pytest.approx(area, rel=1e-10)
    assert len(outline.entity("curve").edges) == edges
    write_dxf(outline, tmp_path / "again.dxf")
    again = outline_from_spec(ShapeSpec(file="again.dxf"), tmp_path)
    assert again.area() == pytest.approx(area, rel=1e-10)


def test_what_no_cubic_edge_can_be_is_approximated(tmp_path):
    drawn(tmp_path / "two.dxf", OPEN, degree=2, closing=[(OPEN[-1], (-1, 6)), ((-1, 6), OPEN[0])])
    outline = outline_from_spec(ShapeSpec(file="two.dxf"), tmp_path)
    (spline,) = ezdxf.readfile(tmp_path / "two.dxf").modelspace().query("SPLINE")
    x, y = np.array([*((p.x, p.y) for p in spline.construction_tool().approximate(20000)), (-1, 6)]).T
    area = 0.5 * abs(np.dot(x, np.roll(y, -1)) - np.dot(y, np.roll(x, -1)))
    assert outline.area() == pytest.approx(area, rel=1e-6)
    assert edges_of_cubic(np.array([0, 0, 0, 0, 1, 1, 2, 2, 2, 2.0]), np.array(OPEN, dtype=float)) == []
    assert edges_of_cubic(np.arange(10.0), np.array(OPEN, dtype=float)) == []


def test_a_region_with_edges_of_the_outline_is_left_out_of_a_dxf(tmp_path):
    spec = ShapeSpec.model_validate(
        {
            "vertices": {"a": [0, 0], "b": [1, 0], "c": [2, 0], "d": [2, 1], "e": [1, 1], "f": [0, 1]},
            "edges": {
                **{name: {"line": [name[0], name[1]]} for name in ("ab", "bc", "cd", "de", "ef", "fa")},
                "middle": {"line": ["b", "e"]},
            },
            "outline": ["ab", "bc", "cd", "de", "ef", "fa"],
            "regions": {"half": {"loop": ["ab", "middle", "ef", "fa"]}},
        }
    )
    outline = outline_from_spec(spec)
    assert write_dxf(outline, tmp_path / "two.dxf") == ["half"]
    back = outline_from_spec(ShapeSpec(file="two.dxf"), tmp_path)
    assert back.area() == pytest.approx(2.0) and set(back.names("edge")) == set(spec.outline)


def test_a_closed_curve_that_is_a_cubic_between_knots_becomes_two_edges():
    """By its points alone, of parameters from 2 to 5; with other knots it is none."""
    controls = np.array([(0, 0), (30, -12), (45, 20), (20, 22), (12, 55), (-20, 30), (0, 0)], dtype=float)
    knots = [2.0, 2.7, 3.9, 4.1, 5.0]
    curve = BSpline([2.0] * 3 + knots + [5.0] * 3, controls, 3)
    first, second = cubic_between(curve, 2.0, 5.0, knots)
    cuts = np.linspace(2.0, 3.9, 101), np.linspace(3.9, 5.0, 101)
    for (points, own, ends), s in zip((first, second), cuts):
        there = spline_weights(own, ends, (s - s[0]) / np.ptp(s)) @ points
        np.testing.assert_allclose(there, curve(s), atol=1e-12 * np.ptp(controls))
    assert cubic_between(curve, 2.0, 5.0, [2.0, 2.8, 3.9, 4.1, 5.0]) == []
    (part,) = cubic_between(curve, 2.1, 4.0, knots)
    assert len(part[1]) == 6
