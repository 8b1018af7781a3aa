"""STEP files made by OpenCASCADE: areas in closed form, whatever plane the part lies in, and files that are none."""

import math
import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline

from restshape.errors import UserError
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.drawings.geo_model import gmsh_model
from restshape.shape.drawings.imported_shape import imported_shape
from restshape.shape.drawings.plane_faces import step_curves
from restshape.shape.drawings.step_names import StepText
from restshape.shape.drawings.unordered_curves import shape_data
from restshape.shape.outline import Outline


def write(path: Path, draw: Callable[[Any], None], unit: str = "MM") -> None:
    """Has OpenCASCADE write what is drawn with its kernel."""
    with gmsh_model(path) as gmsh:
        draw(gmsh.model.occ)
        gmsh.model.occ.synchronize()
        gmsh.write(str(path))
    if unit != "MM":
        text = path.read_text()
        assert "SI_UNIT(.MILLI.,.METRE.)" in text
        path.write_text(text.replace("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)"))


def read(path: Path) -> tuple[Outline, str]:
    """The outline of a file, read in this process, and the note on what was chosen."""
    with gmsh_model(path) as gmsh:
        found = step_curves(gmsh, path)
    return outline_from_spec(ShapeSpec.model_validate(shape_data(found.curves, path.name)[0])), found.notes[0]


def plate(occ: Any, thickness: float = 5.0) -> None:
    box, bore = occ.addBox(0, 0, 0, 200, 100, thickness), occ.addCylinder(50, 50, -1, 0, 0, thickness + 2, 10)
    occ.cut([(3, box)], [(3, bore)])


@pytest.mark.parametrize(
    ("turn", "words"),
    [((1, 0, 0, 0), "z = "), ((1, 0, 0, 90), "y = "), ((0, 1, 0, 90), "x = "), ((1, 1, 0, 40), "normal")],
)
def test_a_plate_in_any_plane_is_its_largest_face(tmp_path, turn, words):
    def draw(occ: Any) -> None:
        plate(occ)
        occ.rotate(occ.getEntities(3), 0, 0, 0, *turn[:3], math.radians(turn[3]))

    write(tmp_path / "plate.step", draw)
    outline, note = read(tmp_path / "plate.step")
    assert 1e6 * outline.area() == pytest.approx(20_000 - 100 * math.pi, rel=1e-9)
    assert words in note and "of 7 faces" in note and "e-" not in note
    assert {edge.kind for edge in outline.edges} == {"line", "arc"} and len(outline.names("hole")) == 1


def test_the_header_gives_the_unit_and_coordinates_stay(tmp_path):
    write(tmp_path / "plate.step", plate, unit="M")
    outline, _ = read(tmp_path / "plate.step")
    np.testing.assert_allclose(outline.bounds(), [[0.0, 0.0], [200.0, 100.0]], atol=1e-6)


def test_faces_in_one_plane_are_one_shape_and_those_inside_are_regions(tmp_path):
    def draw(occ: Any) -> None:
        left, right = occ.addRectangle(0, 0, 0, 100, 100), occ.addRectangle(100, 0, 0, 50, 100)
        pad, away = occ.addDisk(50, 50, 0, 20, 10), occ.addRectangle(0, 0, 30, 10, 10)
        occ.fragment([(2, left), (2, right)], [(2, pad)])
        occ.translate([(2, away)], 0, 0, 1)

    write(tmp_path / "faces.step", draw)
    outline, note = read(tmp_path / "faces.step")
    assert 1e6 * outline.area() == pytest.approx(15_000, rel=1e-9)
    (region,) = (i for i, loop in enumerate(outline.loops) if loop.kind == "region")
    assert 1e6 * outline.loop_area(region) == pytest.approx(200 * math.pi, rel=1e-6)
    assert "3 of 4 faces" in note


def test_a_face_inside_is_a_region_by_the_name_of_its_product(tmp_path):
    def draw(occ: Any) -> None:
        occ.addRectangle(0, 0, 0, 100, 50)
        occ.addDisk(50, 25, 0, 10, 10)

    write(tmp_path / "pad.step", draw)
    assert read(tmp_path / "pad.step")[0].names("region") == ["region2"]
    text = (tmp_path / "pad.step").read_text()
    names = iter(["all of it", "plate", "soft pad"])
    named = re.sub(r"PRODUCT\('[^']*',\s*'[^']*'", lambda _: f"PRODUCT('{(name := next(names))}','{name}'", text)
    (tmp_path / "pad.step").write_text(named)
    outline, _ = read(tmp_path / "pad.step")
    assert outline.names("region") == ["soft_pad"] and 1e6 * outline.area() == pytest.approx(5000.0)


def test_a_b_spline_keeps_its_area(tmp_path):
    """Below a cubic Bézier curve with control heights h lies the mean of h, over the width."""

    def draw(occ: Any) -> None:
        points = [occ.addPoint(x, y, 0) for x, y in ((0, 0), (30, 0), (30, 10), (20, 40), (10, 30), (0, 10))]
        sides = [occ.addLine(points[0], points[1]), occ.addLine(points[1], points[2])]
        sides += [occ.addBezier(points[2:]), occ.addLine(points[5], points[0])]
        occ.addPlaneSurface([occ.addCurveLoop(sides)])

    write(tmp_path / "hill.step", draw)
    outline, _ = read(tmp_path / "hill.step")
    assert 1e6 * outline.area() == pytest.approx(30 * (10 + 40 + 30 + 10) / 4, rel=1e-12)


@pytest.mark.parametrize("turned", [False, True])
def test_a_cubic_b_spline_is_read_as_it_is(tmp_path, turned):
    """Its edges have its knots, and the area is that of scipy's B-spline, by Green's theorem and Gauss's rule."""
    knots = [0.0, 0.23, 0.61, 0.7, 1.0]
    xy = [(30, 10), (28, 40), (19, 12), (12, 55), (11, 30), (2, 33), (0, 10)]

    def draw(occ: Any) -> None:
        points = [occ.addPoint(x, y, 0) for x, y in (*xy, (0, 0), (30, 0))]
        sides = [occ.addBSpline(points[:-2], -1, 3, [], knots, [4, 1, 1, 1, 4])]
        sides += [occ.addLine(*pair) for pair in pairwise((*points[-3:], points[0]))]
        occ.addPlaneSurface([occ.addCurveLoop(sides)])
        if turned:
            occ.rotate(occ.getEntities(2), 3, 1, 2, 1, 2, 3, 0.7)

    write(tmp_path / "hill.step", draw)
    outline, _ = read(tmp_path / "hill.step")
    curve = BSpline([0.0] * 3 + knots + [1.0] * 3, np.array(xy, dtype=float), 3)
    places, weights = np.polynomial.legendre.leggauss(6)
    steps = np.diff(knots)[:, None] / 2
    s, w = (steps * (1 + places) + np.array(knots[:-1])[:, None]).ravel(), (steps * weights).ravel()
    (x, y), (dx, dy) = curve(s).T, curve(s, 1).T
    area = 0.5 * w @ (x * dy - y * dx) + 0.5 * 30 * 10
    assert 1e6 * outline.area() == pytest.approx(area, rel=1e-10)
    (edge,) = (edge for edge in outline.edges if edge.kind == "spline")
    assert len(edge.knots) == len(knots) + 2, "two more in the spans at the ends, where it bends"


def test_a_b_spline_of_degree_2_is_fitted(tmp_path):
    """Its second derivative jumps, as no spline edge's does."""

    def draw(occ: Any) -> None:
        points = [occ.addPoint(x, y, 0) for x, y in ((30, 0), (20, 30), (10, 30), (0, 0))]
        side = occ.addBSpline(points, -1, 2, [], [0.0, 0.4, 1.0], [3, 1, 3])
        occ.addPlaneSurface([occ.addCurveLoop([side, occ.addLine(points[-1], points[0])])])

    write(tmp_path / "low.step", draw)
    outline, _ = read(tmp_path / "low.step")
    curve = BSpline([0, 0, 0, 0.4, 1, 1, 1], np.array([(30.0, 0.0), (20, 30), (10, 30), (0, 0)]), 2)
    x, y = curve(np.linspace(0, 1, 200_001)).T
    assert 1e6 * outline.area() == pytest.approx(-np.trapz(y, x), rel=1e-6)


@pytest.mark.slow
def test_a_file_is_read_in_a_process_of_its_own(tmp_path):
    write(tmp_path / "plate.stp", plate)
    found = imported_shape(ShapeSpec(file="plate.stp"), tmp_path)
    assert found is not None and found.notes == ("plate.stp: 1 of 7 faces, in the plane z = 0 mm",)
    assert len(found.tables["edges"]) == 6


@pytest.mark.slow
def test_what_is_no_plate_is_refused(tmp_path):
    (tmp_path / "none.step").write_text("nonsense")
    with pytest.raises(UserError, match="no STEP file"):
        imported_shape(ShapeSpec(file="none.step"), tmp_path)
    write(tmp_path / "ball.step", lambda occ: occ.addSphere(0, 0, 0, 10))
    with pytest.raises(UserError, match="no plane face"):
        read(tmp_path / "ball.step")
    write(tmp_path / "cut.step", plate)
    text = (tmp_path / "cut.step").read_text()
    (tmp_path / "cut.step").write_text(text[: len(text) // 2])
    with pytest.raises(UserError, match=r"cut\.step"):
        imported_shape(ShapeSpec(file="cut.step"), tmp_path)
    with pytest.raises(UserError, match="no layer 'x'"):
        imported_shape(ShapeSpec(file="cut.step", layers={"x": "y"}), tmp_path)


def test_a_name_that_may_be_of_either_of_two_edges_is_of_none(tmp_path):
    """Two arcs from the same point to the same point."""

    def draw(occ: Any) -> None:
        low, high = occ.addPoint(0, 0, 0), occ.addPoint(40, 0, 0)
        lens = [occ.addCircleArc(low, occ.addPoint(20, y, 0), high, center=False) for y in (-20, 20)]
        face = occ.addPlaneSurface([occ.addCurveLoop([lens[0], -lens[1]])])
        occ.extrude([(2, face)], 0, 0, 5)

    write(tmp_path / "lens.step", draw)
    text = (tmp_path / "lens.step").read_text()
    edges = StepText(text).edges.values()
    assert len(edges) == 6 and not any(edge.name for edge in edges)
    flat = [edge for edge in edges if np.ptp(edge.ends, axis=0)[0] > 1.0 and edge.ends[0, 2] == 0.0]
    assert len(flat) == 2 and {edge.kind for edge in flat} == {"Circle"}
    at = max(edge.at for edge in flat)
    (tmp_path / "lens.step").write_text(f"{text[:at]}half{text[at:]}")
    outline, _ = read(tmp_path / "lens.step")
    assert outline.names("edge") == ["edge1", "edge2"]


@pytest.mark.parametrize(("filler", "known"), [("NONE", False), ("", False), ("left side", True)])
def test_a_name_that_is_none_names_nothing(tmp_path, filler, known):
    write(tmp_path / "plate.step", plate)
    text = (tmp_path / "plate.step").read_text()
    left = [e for e in StepText(text).edges.values() if not e.ends[:, [0, 2]].any()]
    assert len(left) == 1
    (tmp_path / "plate.step").write_text(f"{text[: left[0].at]}{filler}{text[left[0].at :]}")
    outline, _ = read(tmp_path / "plate.step")
    assert ("left_side" in outline.names("edge")) == known
    (edge,) = (e for e in outline.edges if not outline.points[[e.start, e.end], 0].any())
    assert (edge.name == "left_side") == known


@pytest.mark.parametrize(
    ("unit", "factor"),
    [
        ("( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )", 1.0),
        ("( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.) )", 1e3),
        ("(CONVERSION_BASED_UNIT('INCH',#9) LENGTH_UNIT() NAMED_UNIT(#8))", 25.4),
    ],
)
def test_ends_of_edges_are_in_the_unit_of_the_file(unit, factor):
    text = (
        f"#1=EDGE_CURVE('a /* b */',#2,#3,#4,.T.);#2=VERTEX_POINT('',#5);#3=VERTEX_POINT('',#6);#7={unit};"
        "#4=SURFACE_CURVE('',#8,(),.PCURVE_S1.);#8=LINE('',#5,#9);#5=CARTESIAN_POINT('',(0.,0.,1.E0));"
        "#6=CARTESIAN_POINT('', (2., -.5,\n 0.)) ;"
    )
    (edge,) = StepText(text).edges.values()
    np.testing.assert_allclose(edge.ends, factor * np.array([[0, 0, 1], [2, -0.5, 0]]))
    assert edge.kind == "Line" and not StepText(text.replace("'INCH'", "'YARD'").replace("METRE", "GRAM")).edges


def test_faces_have_the_names_of_the_file(tmp_path):
    def draw(occ: Any) -> None:
        sheet, patch = occ.addRectangle(0, 0, 0, 100, 100), occ.addRectangle(20, 20, 0, 30, 30)
        occ.fragment([(2, sheet)], [(2, patch)])

    write(tmp_path / "sheet.step", draw)
    text = (tmp_path / "sheet.step").read_text()
    number, faces = 0, re.findall(r"ADVANCED_FACE\(''", text)
    assert len(faces) == 2

    def name(match: re.Match[str]) -> str:
        nonlocal number
        number += 1
        return f"ADVANCED_FACE('region {number}'"

    (tmp_path / "sheet.step").write_text(re.sub(r"ADVANCED_FACE\(''", name, text))
    outline, _ = read(tmp_path / "sheet.step")
    assert len(outline.names("region")) == 1 and outline.names("region")[0] in ("region_1", "region_2")
