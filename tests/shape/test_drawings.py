"""DXF and .geo outlines: lengths, areas and names against what was drawn."""

import ezdxf
import numpy as np
import pytest
from drawn import write_dxf
from shape_scenes import plate, shape

from restshape.errors import UserError
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline

GEO = """
SetFactory("{kernel}");
Point(1) = {{0, 0, 0}}; Point(2) = {{3, 0, 0}}; Point(3) = {{3, 1, 0}}; Point(4) = {{0, 1, 0}};
Line(1) = {{1, 2}}; Line(2) = {{2, 3}}; Line(3) = {{3, 4}}; Line(4) = {{4, 1}};
Point(5) = {{0.5, 0.5, 0}}; Point(6) = {{0.7, 0.5, 0}}; Point(7) = {{0.5, 0.7, 0}}; Point(8) = {{0.3, 0.5, 0}};
Point(9) = {{0.5, 0.3, 0}};
Circle(5) = {{6, 5, 7}}; Circle(6) = {{7, 5, 8}}; Circle(7) = {{8, 5, 9}}; Circle(8) = {{9, 5, 6}};
Point(10) = {{2, 0.4, 0}}; Point(11) = {{2.4, 0.4, 0}}; Point(12) = {{2.2, 0.8, 0}};
Line(9) = {{10, 11}}; Line(10) = {{11, 12}}; Line(11) = {{12, 10}};
Curve Loop(1) = {{1, 2, 3, 4}}; Curve Loop(2) = {{5, 6, 7, 8}}; Curve Loop(3) = {{9, 10, 11}};
Plane Surface(1) = {{1, 2, 3}}; Plane Surface(2) = {{3}};
Physical Curve("clamp") = {{4}}; Physical Curve("sides") = {{1, 3}}; Physical Curve("window") = {{5, 6, 7, 8}};
Physical Surface("patch") = {{2}};
"""


def read(path, **more) -> Outline:
    return outline_from_spec(ShapeSpec.model_validate({"file": path.name, **more}), path.parent)


def drawing(path, unit: int, scale: float) -> None:
    found = ezdxf.new("R2010", units=unit)
    space = found.modelspace()
    for name in ("clamp", "sides", "region_patch", "ring"):
        found.layers.add(name)
    w, h = 2 * scale, scale
    space.add_line((0, h), (0, 0), dxfattribs={"layer": "clamp"})
    space.add_line((0, 0), (w, 0), dxfattribs={"layer": "sides"})
    space.add_arc((w, h / 2), h / 2, -90, 90)
    space.add_line((0, h), (w, h), dxfattribs={"layer": "sides"})
    space.add_circle((0.5 * scale, 0.5 * scale), 0.2 * scale, dxfattribs={"layer": "ring"})
    corners = [(1.2, 0.3), (1.6, 0.3), (1.6, 0.6)]
    space.add_lwpolyline([(x * scale, y * scale) for x, y in corners], close=True, dxfattribs={"layer": "region_patch"})
    space.add_text("not a part of the shape")
    found.saveas(path)


@pytest.mark.parametrize(("unit", "scale"), [(6, 1.0), (4, 1000.0), (5, 100.0), (0, 1000.0), (1, 1 / 0.0254)])
def test_a_drawing_in_any_unit_comes_in_metres(tmp_path, unit, scale):
    drawing(tmp_path / "plate.dxf", unit, scale)
    outline = read(tmp_path / "plate.dxf", points={"probe": [1.0, 0.5]})
    assert outline.area() == pytest.approx(2.0 + np.pi * 0.25 / 2 - np.pi * 0.04, rel=1e-9)
    assert outline.names("hole") == ["ring"] and outline.names("region") == ["region_patch"]
    assert outline.length(outline.entity("clamp").edges[0]) == pytest.approx(1.0, rel=1e-9)
    assert sum(outline.length(e) for e in outline.entity("sides").edges) == pytest.approx(4.0, rel=1e-9)
    assert outline.entity("probe").vertices == outline.embedded


def test_what_is_written_is_read_back(tmp_path):
    outline = shape(
        vertices={"a": [0, 0], "b": [2, 0], "c": [2, 1], "d": [0, 1]},
        edges={
            "bottom": {"line": ["a", "b"]},
            "right": {"arc": ["b", "c"], "through": [2.2, 0.5]},
            "top": {"arc": ["d", "c"], "through": [1, 0.9]},
            "left": {"polyline": ["d", "a"], "through": [[0.05, 0.7], [-0.05, 0.3]]},
        },
        outline=["bottom", "right", "top", "left"],
        holes={"window": {"circle": {"center": [0.5, 0.5], "radius": 0.2}}},
    )
    write_dxf(outline, tmp_path / "out.dxf")
    back = read(tmp_path / "out.dxf")
    assert back.area() == pytest.approx(outline.area(), rel=1e-12)
    for name in ("bottom", "right", "top", "left", "window"):
        lengths = [sum(o.length(e) for e in o.entity(name).edges) for o in (outline, back)]
        assert lengths[1] == pytest.approx(lengths[0], rel=1e-12)
    splined = plate()
    write_dxf(splined, tmp_path / "spline.dxf")
    assert read(tmp_path / "spline.dxf").area() == pytest.approx(splined.area(), rel=1e-3)


def test_open_outlines_and_strange_entities_are_named(tmp_path):
    found = ezdxf.new("R2010", units=6)
    found.modelspace().add_line((0, 0), (1, 0), dxfattribs={"layer": "clamp"})
    found.saveas(tmp_path / "open.dxf")
    with pytest.raises(UserError, match=r"open at \(0, 0\).*LINE on layer clamp"):
        read(tmp_path / "open.dxf")
    found.modelspace().add_solid([(0, 0), (1, 0), (0, 1)], dxfattribs={"layer": "egg"})
    found.saveas(tmp_path / "egg.dxf")
    with pytest.raises(UserError, match="SOLID on layer 'egg'"):
        read(tmp_path / "egg.dxf")
    (tmp_path / "bad.dxf").write_text("nonsense")
    with pytest.raises(UserError, match="cannot be read as DXF"):
        read(tmp_path / "bad.dxf")


@pytest.mark.parametrize("kernel", ["Built-in", "OpenCASCADE"])
def test_geo_files_give_exact_arcs_and_physical_names(tmp_path, kernel):
    (tmp_path / "plate.geo").write_text(GEO.format(kernel=kernel))
    outline = read(tmp_path / "plate.geo")
    assert outline.area() == pytest.approx(3.0 - np.pi * 0.04, rel=1e-12)
    assert outline.names("hole") == ["window"] and outline.names("region") == ["patch"]
    assert outline.length(outline.entity("clamp").edges[0]) == pytest.approx(1.0)
    assert len(outline.entity("sides").edges) == 2
    assert outline.loop_area(next(i for i, loop in enumerate(outline.loops) if loop.name == "patch")) == pytest.approx(
        0.08
    )


def test_bad_geo_files_are_named(tmp_path):
    (tmp_path / "bad.geo").write_text("Point(1) = {0, 0")
    with pytest.raises(UserError, match=r"bad\.geo"):
        read(tmp_path / "bad.geo")
    (tmp_path / "open.geo").write_text("Point(1) = {0,0,0}; Point(2) = {1,0,0}; Line(1) = {1,2};")
    with pytest.raises(UserError, match="open"):
        read(tmp_path / "open.geo")
