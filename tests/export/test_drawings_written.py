"""Drawings and bodies hold the shape as it was edited: areas by ezdxf, by SVG's own words, by OpenCASCADE."""

import re
from itertools import pairwise
from xml.etree import ElementTree

import curve_areas
import ezdxf
import gmsh
import numpy as np
import pytest
from edited_shapes import edited

from restshape.export.dxf_drawing import write_dxf
from restshape.export.formats import write_shape
from restshape.export.step_body import write_step
from restshape.export.svg_drawing import write_svg
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline
from restshape.surroundings import start_gmsh

SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def outline(tmp_path_factory) -> Outline:
    return edited(tmp_path_factory.mktemp("shape")).outline


def signed(loop: str, kinds: dict[str, str]) -> float:
    """The sign with which a loop counts in the area of the material."""
    return {"outline": 1.0, "hole": -1.0, "region": 0.0}[kinds[loop]]


def of_dxf(entity) -> list[curve_areas.Piece]:
    """The curves of an entity, by ezdxf alone."""
    kind, dxf = entity.dxftype(), entity.dxf
    if kind == "LINE":
        return [curve_areas.line(dxf.start.vec2, dxf.end.vec2)]
    if kind == "LWPOLYLINE":
        corners = entity.get_points("xy")
        return [curve_areas.line(a, b) for a, b in pairwise(corners)]
    if kind in ("ARC", "CIRCLE"):
        first, last = (dxf.start_angle, dxf.end_angle) if kind == "ARC" else (0.0, 0.0)
        turn = (last - first) % 360.0 or 360.0
        return [curve_areas.arc(dxf.center.vec2, dxf.radius, np.radians(first), np.radians(turn))]
    assert kind == "SPLINE" and not len(entity.fit_points), "the B-spline, not points that it goes through"
    pieces = entity.construction_tool().bezier_decomposition()
    return [curve_areas.bezier(np.array([tuple(p)[:2] for p in controls])) for controls in pieces]


def test_a_dxf_holds_curves_as_they_are_and_layers_by_name(outline, tmp_path):
    assert write_dxf(outline, tmp_path / "plate.dxf") == []
    drawing = ezdxf.readfile(tmp_path / "plate.dxf")
    assert drawing.header["$INSUNITS"] == 4
    loops: dict[str, list] = {}
    kinds, points = {}, {}
    for entity in drawing.modelspace():
        layer = entity.dxf.layer
        if entity.dxftype() == "POINT":
            points[layer] = np.array(tuple(entity.dxf.location)[:2])
            continue
        own = "outline" if layer in ("bottom", "right", "top.1", "top.2", "left") else layer
        loops.setdefault(own, []).extend(of_dxf(entity))
        kinds.setdefault(layer, set()).add(entity.dxftype())
    round_ones = {v for e in drawn_as_circles(outline) for v in (outline.edges[e].start, outline.edges[e].end)}
    assert set(points) == {name for v, name in enumerate(outline.vertex_names) if v not in round_ones}
    for name, place in points.items():
        np.testing.assert_allclose(place, 1e3 * outline.points[outline.entity(name).vertices[0]], atol=1e-12)
    np.testing.assert_array_equal(points["gauge"], (1000.0, 800.0))
    names = ("bottom", "right", "top.1", "top.2", "left", "window", "bore", "slot", "region_core")
    forms = ("ARC", "ARC", "SPLINE", "SPLINE", "LWPOLYLINE", "CIRCLE", "CIRCLE", "LINE", "CIRCLE")
    assert kinds == {name: {form} for name, form in zip(names, forms)}
    areas = {name: curve_areas.enclosed(pieces, 1e-6) for name, pieces in loops.items()}
    found = areas["outline"] - areas["window"] - areas["bore"] - areas["slot"]
    assert 1e-6 * found == pytest.approx(outline.area(), rel=1e-9)
    assert areas["window"] == pytest.approx(np.pi * 200.0**2, rel=1e-9)


def drawn_as_circles(outline: Outline) -> set[int]:
    """Edges of the loops that the scene drew as circles."""
    return {e for name in ("window", "bore", "core") for e in outline.entity(name).edges}


def test_names_of_points_come_back_from_a_dxf(outline, tmp_path):
    write_dxf(outline, tmp_path / "plate.dxf")
    back = outline_from_spec(ShapeSpec(file="plate.dxf"), tmp_path)
    round_ones = {v for e in drawn_as_circles(outline) for v in (outline.edges[e].start, outline.edges[e].end)}
    kept = [name for v, name in enumerate(outline.vertex_names) if v not in round_ones]
    assert len(kept) > 4 and set(kept) <= set(back.vertex_names)
    for name in kept:
        (i,), (j,) = back.entity(name).vertices, outline.entity(name).vertices
        np.testing.assert_allclose(back.points[i], outline.points[j], atol=1e-9)
    assert [back.vertex_names[v] for v in back.embedded] == [outline.vertex_names[v] for v in outline.embedded]


def test_points_of_a_drawing_that_name_nothing_are_left_out(tmp_path):
    drawing = ezdxf.new("R2010", units=ezdxf.units.MM)
    space = drawing.modelspace()
    corners = [(0, 0), (100, 0), (100, 50), (0, 50)]
    for i, a in enumerate(corners):
        space.add_line(a, corners[(i + 1) % 4], dxfattribs={"layer": f"side{i}"})
    space.add_circle((30, 25), 10, dxfattribs={"layer": "bore"})
    places = {"foot": (0, 0), "gauge": (70, 25), "p2": (100, 50), "in_bore": (31, 25), "far": (500, 0), "near": (50, 0)}
    for name, place in places.items():
        space.add_point(place, dxfattribs={"layer": name})
    for place in ((60, 10), (61, 12)):
        space.add_point(place, dxfattribs={"layer": "grid"})
    space.add_point((100, 0), dxfattribs={"layer": "side1"})
    drawing.saveas(tmp_path / "marked.dxf")
    outline = outline_from_spec(ShapeSpec(file="marked.dxf"), tmp_path)
    assert {"foot", "gauge", "p2"} <= set(outline.vertex_names)
    assert not {"in_bore", "far", "near", "grid", "side1"} & set(outline.vertex_names)
    assert [outline.vertex_names[v] for v in outline.embedded] == ["gauge"]
    np.testing.assert_allclose(outline.points[outline.entity("p2").vertices[0]], (0.1, 0.05), atol=1e-12)
    alone = outline_from_spec(ShapeSpec(file="marked.dxf", layers={f"side{i}": f"s{i}" for i in range(4)}), tmp_path)
    assert not {"foot", "gauge"} & set(alone.vertex_names) and not alone.loops[1:]


def test_a_dxf_is_read_back_by_the_program(outline, tmp_path):
    write_dxf(outline, tmp_path / "plate.dxf")
    back = outline_from_spec(ShapeSpec(file="plate.dxf"), tmp_path)
    assert back.area() == pytest.approx(outline.area(), rel=1e-11)
    assert set(back.names("hole")) == {"window", "bore", "slot"} and back.names("region") == ["region_core"]
    assert len(back.entity("left").edges) == 3
    for theirs, ours in (("bottom", "bottom"), ("right", "right"), ("top.1", "top.1"), ("top.2", "top.2")):
        (i,), (j,) = back.entity(theirs).edges, outline.entity(ours).edges
        assert back.edges[i].kind == outline.edges[j].kind
        assert back.length(i) == pytest.approx(outline.length(j), rel=1e-9)


def test_an_arc_that_is_almost_straight_keeps_its_bulge(tmp_path):
    square = {"a": [0, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1]}
    edges = {"low": {"arc": ["a", "b"], "bulge": 1e-7}, "top": {"line": ["c", "d"]}}
    edges |= {"right": {"line": ["b", "c"]}, "left": {"line": ["d", "a"]}}
    spec = ShapeSpec.model_validate({"vertices": square, "edges": edges, "outline": ["low", "right", "top", "left"]})
    flat = outline_from_spec(spec)
    write_dxf(flat, tmp_path / "flat.dxf")
    assert outline_from_spec(ShapeSpec(file="flat.dxf"), tmp_path).bulges.max() == pytest.approx(1e-7, rel=1e-6)
    # A segment of bulge b over a chord c has the area b c^2 / 3 and smaller terms.
    assert 1e-6 * step_area(flat, None, tmp_path)[0] - 1.0 == pytest.approx(1e-7 / 3.0, rel=1e-3)


def of_path(words: str) -> list[curve_areas.Piece]:
    """The curves of SVG's words M, L, C and A, by the formulas of its standard (F.6.5)."""
    pieces, at = [], np.zeros(2)
    for letter, text in re.findall(r"([MLCA]) ([^MLCA]*)", words):
        numbers = np.array([float(number) for number in re.split(r"[ ,]+", text.strip())])
        if letter == "A":
            radius, large, sweep, end = numbers[0], numbers[3], numbers[4], numbers[5:]
            middle, half = 0.5 * (at + end), 0.5 * (at - end)
            off = np.sqrt(max(radius**2 - half @ half, 0.0) / (half @ half)) * (1.0 if large != sweep else -1.0)
            centre = middle + off * np.array([half[1], -half[0]])
            first, last = (np.arctan2(*(p - centre)[::-1]) for p in (at, end))
            turn = (last - first) % (2.0 * np.pi) - (0.0 if sweep else 2.0 * np.pi)
            pieces.append(curve_areas.arc(centre, radius, first, turn))
            at = end
            continue
        points = numbers.reshape(-1, 2)
        if letter == "L":
            pieces += [curve_areas.line(a, b) for a, b in zip([at, *points], points)]
        elif letter == "C":
            for controls in points.reshape(-1, 3, 2):
                pieces.append(curve_areas.bezier(np.array([at, *controls])))
                at = controls[-1]
        at = points[-1]
    return pieces


def test_an_svg_is_exact_and_in_true_size(outline, tmp_path):
    write_svg(outline, tmp_path / "plate.svg")
    root = ElementTree.parse(tmp_path / "plate.svg").getroot()
    box = [float(number) for number in root.get("viewBox").split()]
    assert root.get("width") == f"{box[2]:.6f}mm" and root.get("height") == f"{box[3]:.6f}mm"
    total, names = 0.0, set()
    for group in root.findall(f"{SVG}g"):
        pieces = [piece for path in group for piece in of_path(path.get("d"))]
        area = curve_areas.enclosed(pieces, 1e-6)
        total += signed(group.get("id"), {group.get("id"): group.get("class")}) * area
        names |= {path.get("id") for path in group}
    assert names == {edge.name for edge in outline.edges}
    assert 1e-6 * total == pytest.approx(outline.area(), rel=1e-9)


def of_gmsh(curve: int) -> list[curve_areas.Piece]:
    """A curve of gmsh's model in many pieces, each smooth but where a knot is in it."""
    (lower,), (upper,) = gmsh.model.getParametrizationBounds(1, curve)

    def piece(a: float, b: float) -> curve_areas.Piece:
        def at(s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
            places = a + (b - a) * s
            points = np.reshape(gmsh.model.getValue(1, curve, places), (-1, 3))
            rates = np.reshape(gmsh.model.getDerivative(1, curve, places), (-1, 3))
            return points[:, :2], (b - a) * rates[:, :2]

        return at

    return [piece(a, b) for a, b in pairwise(np.linspace(lower, upper, 41))]


def test_an_svg_is_read_back_by_the_program(outline, tmp_path):
    write_svg(outline, tmp_path / "plate.svg")
    back = outline_from_spec(ShapeSpec(file="plate.svg"), tmp_path)
    assert back.area() == pytest.approx(outline.area(), rel=1e-11)
    np.testing.assert_allclose(back.bounds(), outline.bounds(), atol=1e-3)
    assert set(back.names("hole")) == set(outline.names("hole"))
    assert back.names("region") == outline.names("region")
    for name in ("bottom", "right", "top.1", "window.1"):
        (i,), (j,) = back.entity(name).edges, outline.entity(name).edges
        assert back.edges[i].kind == outline.edges[j].kind
        assert back.length(i) == pytest.approx(outline.length(j), rel=1e-9)


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.1])
def test_half_a_circle_stays_half_a_circle_in_an_svg(tmp_path, turn):
    """Two edges with a bulge of 1 are a circle of area pi, wherever and however they lie."""
    place = 1e3 * np.array([0.3, 0.2]) + np.array([[np.cos(turn), np.sin(turn)]]) * [[1.0], [-1.0]]
    edges = {"one": {"arc": ["a", "b"], "bulge": 1}, "other": {"arc": ["b", "a"], "bulge": 1}}
    vertices = dict(zip("ab", place.tolist()))
    round_one = outline_from_spec(ShapeSpec(vertices=vertices, edges=edges, outline=["one", "other"]))
    write_svg(round_one, tmp_path / "round.svg")
    back = outline_from_spec(ShapeSpec(file="round.svg"), tmp_path)
    assert back.area() == pytest.approx(np.pi, rel=1e-12)


@pytest.mark.parametrize(("kind", "write"), [("dxf", write_dxf), ("svg", write_svg)])
def test_edges_that_had_a_layer_together_have_its_name_again(tmp_path, kind, write):
    """Lines of one layer are read as `rim-1`, ...; exported with these names they are the group `rim` again."""
    corners = [(0, 0), (100, 0), (100, 50), (0, 50)]
    drawing = ezdxf.new("R2010", units=ezdxf.units.MM)
    for i, layer in enumerate(("foot", "rim", "rim", "rim")):
        drawing.modelspace().add_line(corners[i], corners[(i + 1) % 4], dxfattribs={"layer": layer})
    drawing.saveas(tmp_path / "first.dxf")
    first = outline_from_spec(ShapeSpec(file="first.dxf"), tmp_path)
    write(first, tmp_path / f"again.{kind}")
    back = outline_from_spec(ShapeSpec(file=f"again.{kind}"), tmp_path)
    names = [{one.edges[e].name for e in one.entity("rim").edges} for one in (first, back)]
    assert names == [{"rim-1", "rim-2", "rim-3"}] * 2


@pytest.mark.slow
@pytest.mark.parametrize("thickness", [None, 0.02])
def test_a_step_file_is_read_back_by_the_program(outline, thickness, tmp_path):
    write_step(outline, thickness, tmp_path / "plate.step")
    back = outline_from_spec(ShapeSpec(file="plate.step"), tmp_path)
    assert back.area() == pytest.approx(outline.area(), rel=1e-11)
    np.testing.assert_allclose(back.bounds(), outline.bounds(), atol=1e-3)
    assert set(back.names("hole")) == set(outline.names("hole"))
    for name in ("bottom", "right", "top.1", "window"):
        lengths = [sum(one.length(e) for e in one.entity(name).edges) for one in (outline, back)]
        assert lengths[1] == pytest.approx(lengths[0], rel=1e-9)
    assert {edge.kind for edge in back.edges} == {"line", "arc", "spline"}


def step_area(outline: Outline, thickness: float | None, folder) -> tuple[float, float]:
    """What gmsh reads from a STEP file of one face or solid: area by its curves [mm^2], and OpenCASCADE's own mass.

    That mass is good to about 1e-6 only for this shape, and to 1e-3 for one with long splines: see docs/formats.md.
    """
    write_step(outline, thickness, folder / "body.step")
    start_gmsh()
    gmsh.model.add("read")
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        ((dim, tag),) = gmsh.model.occ.importShapes(str(folder / "body.step"))
        gmsh.model.occ.synchronize()
        assert dim == (2 if thickness is None else 3)
        boxes = {face: gmsh.model.getBoundingBox(2, face) for _, face in gmsh.model.getEntities(2)}
        (face,) = (face for face, box in boxes.items() if abs(box[2]) < 1e-5 and abs(box[5]) < 1e-5)
        _, loops = gmsh.model.occ.getCurveLoops(face)
        areas = [curve_areas.enclosed([p for c in loop for p in of_gmsh(abs(c))], 1e-6) for loop in loops]
        return 2.0 * max(areas) - sum(areas), gmsh.model.occ.getMass(dim, tag)
    finally:
        gmsh.model.remove()


@pytest.mark.slow
def test_a_step_face_and_solid_have_the_area_of_the_shape(outline, tmp_path, capfd):
    area, mass = step_area(outline, None, tmp_path)
    assert 1e-6 * area == pytest.approx(outline.area(), rel=1e-9)
    assert 1e-6 * mass == pytest.approx(outline.area(), rel=1e-6)
    area, mass = step_area(outline, 0.02, tmp_path)
    assert 1e-6 * area == pytest.approx(outline.area(), rel=1e-9)
    assert 1e-9 * mass == pytest.approx(0.02 * outline.area(), rel=1e-6)
    assert b"written by restshape export" in (tmp_path / "body.step").read_bytes()[:200]
    capfd.readouterr()
    write_step(outline, None, tmp_path / "quiet.step")
    assert capfd.readouterr().out == ""


@pytest.mark.parametrize("kind", ["svg", "step", "dxf", "toml"])
def test_points_that_are_left_out_are_noted(tmp_path, kind):
    notes = write_shape(kind, edited(tmp_path), None, tmp_path / f"plate.{kind}")
    assert any("gauge" in note for note in notes) == (kind in ("svg", "step")), notes
    assert any("regions: core" in note for note in notes) == (kind == "step"), notes
