"""Ellipses, blocks, layers and gaps of DXF drawings, by ezdxf, against closed forms."""

import math
from itertools import pairwise

import ezdxf
import pytest

from restshape.errors import UserError
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.drawings.imported_shape import imported_shape
from restshape.shape.outline import Outline


def plate():
    """A drawing in mm with a plate of 200 mm by 100 mm, and its model space."""
    drawing = ezdxf.new("R2010", units=4)
    space = drawing.modelspace()
    space.add_lwpolyline([(0, 0), (200, 0), (200, 100), (0, 100)], close=True, dxfattribs={"layer": "rim"})
    return drawing, space


def read(drawing, folder, **more) -> Outline:
    drawing.saveas(folder / "x.dxf")
    return outline_from_spec(ShapeSpec.model_validate({"file": "x.dxf", **more}), folder)


def areas(outline: Outline) -> dict[str, float]:
    """Areas of the holes and regions [mm^2]."""
    return {loop.name: 1e6 * abs(outline.loop_area(i)) for i, loop in enumerate(outline.loops) if i}


def test_ellipses_whole_half_and_round(tmp_path):
    drawing, space = plate()
    space.add_ellipse((50, 50), (20, 10), 0.5, dxfattribs={"layer": "egg"})
    space.add_ellipse((150, 50), (0, 20), 0.5, 0, math.pi, dxfattribs={"layer": "half"})
    space.add_line((150, 70), (150, 30), dxfattribs={"layer": "half"})
    space.add_ellipse((100, 50), (6, 8), 1.0, dxfattribs={"layer": "disc"})
    outline = read(drawing, tmp_path)
    found = areas(outline)
    assert found == {
        "egg": pytest.approx(0.5 * math.pi * 500, rel=1e-6),
        "half": pytest.approx(0.5 * math.pi * 200, rel=1e-6),
        "disc": pytest.approx(math.pi * 100, rel=1e-12),
    }
    assert {edge.kind for edge in outline.edges if edge.name.startswith("disc")} == {"arc"}


def test_blocks_within_blocks_are_placed_turned_scaled_and_mirrored(tmp_path):
    drawing, space = plate()
    slot = drawing.blocks.new("SLOT", base_point=(1, 0))
    slot.add_line((1, 0), (5, 0))
    slot.add_arc((5, 1), 1, -90, 90)
    slot.add_lwpolyline([(5, 2), (1, 2), (1, 0)])
    slot.add_text("a slot")
    pair = drawing.blocks.new("PAIR")
    pair.add_blockref("SLOT", (0, 0))
    pair.add_blockref("SLOT", (0, 10), dxfattribs={"xscale": -1, "rotation": 30})
    space.add_blockref("PAIR", (50, 30), dxfattribs={"xscale": 3, "yscale": 3, "layer": "slots"})
    space.add_blockref("SLOT", (150, 50), dxfattribs={"xscale": 4, "yscale": 2, "layer": "wide"})
    outline = read(drawing, tmp_path)
    one = 4 * 2 + math.pi / 2
    found = areas(outline)
    assert found.pop("wide") == pytest.approx(8 * one, rel=1e-6)
    assert list(found.values()) == [pytest.approx(9 * one, rel=1e-9)] * 2
    assert len(outline.entity("slots").edges) == 8


def test_a_block_in_rows_and_columns_is_as_many(tmp_path):
    drawing, space = plate()
    drawing.blocks.new("BORE").add_circle((0, 0), 3)
    grid = {"column_count": 5, "column_spacing": 30, "row_count": 3, "row_spacing": 25, "layer": "bores"}
    space.add_blockref("BORE", (30, 25), dxfattribs=grid)
    outline = read(drawing, tmp_path)
    assert len(outline.names("hole")) == 15
    assert 1e6 * outline.area() == pytest.approx(20_000 - 15 * math.pi * 9, rel=1e-12)


def test_a_mirrored_circle_lies_where_its_extrusion_says(tmp_path):
    drawing, space = plate()
    space.add_circle((-50, 50), 10, dxfattribs={"layer": "back", "extrusion": (0, 0, -1)})
    outline = read(drawing, tmp_path)
    assert outline.centroid(outline.entity("back")) == pytest.approx([0.05, 0.05])


def test_layers_are_chosen_and_renamed(tmp_path):
    drawing, space = plate()
    space.add_circle((50, 50), 10, dxfattribs={"layer": "Bohrung Ø20"})
    space.add_line((-50, 50), (250, 50), dxfattribs={"layer": "axes"})
    with pytest.raises(UserError, match=r"open at .*LINE on layer axes"):
        read(drawing, tmp_path)
    outline = read(drawing, tmp_path, layers={"rim": "border", "Bohrung Ø20": "bore"})
    assert outline.names("hole") == ["bore"] and len(outline.entity("border").edges) == 4
    with pytest.raises(UserError, match="no layer 'Rim'") as found:
        read(drawing, tmp_path, layers={"Rim": "border"})
    assert "'rim'" in found.value.do
    with pytest.raises(ValueError, match=r"says how shape\.file is read"):
        ShapeSpec.model_validate({"layers": {"rim": "border"}})


def test_gaps_are_closed_the_smallest_first(tmp_path):
    drawing = ezdxf.new("R2010", units=4)
    space = drawing.modelspace()
    space.add_line((0, 0), (199.9, 0), dxfattribs={"layer": "bottom"})
    space.add_arc((200, 50), 50, -90, 90, dxfattribs={"layer": "tip"})
    space.add_line((200, 100), (0, 100), dxfattribs={"layer": "top"})
    space.add_line((0, 99.98), (0, 0.02), dxfattribs={"layer": "back"})
    outline = read(drawing, tmp_path, tolerance="0.2 mm")
    assert 1e6 * outline.area() == pytest.approx(20_000 + 1250 * math.pi, rel=1e-3)
    drawn = imported_shape(ShapeSpec(file="x.dxf", tolerance=2e-4), tmp_path)
    assert drawn is not None
    assert [gap.size for gap in drawn.gaps] == pytest.approx([1e-4, 2e-5, 2e-5])
    assert drawn.gaps[0].between == ("LINE on layer bottom", "ARC on layer tip")
    assert drawn.gaps[0].at == pytest.approx((0.19995, 0.0), abs=1e-12)


@pytest.mark.parametrize("gap", [0.0, 2e-4, 0.05])
def test_a_spline_that_ends_where_it_begins_is_a_loop(tmp_path, gap):
    drawing, space = plate()
    turn = 2 * math.pi - gap / 30
    points = [(100 + 30 * math.cos(turn * i / 24), 50 + 30 * math.sin(turn * i / 24)) for i in range(25)]
    space.add_spline(fit_points=points, dxfattribs={"layer": "round"})
    outline = read(drawing, tmp_path, tolerance="0.06 mm")
    assert areas(outline)["round"] == pytest.approx(900 * math.pi, rel=2e-3)
    assert len(outline.entity("round").edges) == 2
    drawn = imported_shape(ShapeSpec(file="x.dxf", tolerance=6e-5), tmp_path)
    assert drawn is not None and [one.size for one in drawn.gaps] == pytest.approx(
        [1e-3 * gap] * (gap > 1e-3), rel=1e-3
    )


@pytest.mark.parametrize("gap", [0.0, 0.002])
def test_a_gap_of_a_spline_is_closed_after_smaller_ones_to_its_neighbours(tmp_path, gap):
    """Two halves of an ellipse of 6 mm by 20 mm, each with its ends 6 mm apart, beside a whole one."""
    drawing, space = plate()
    space.add_ellipse((150, 50), (8, 0), 0.5, dxfattribs={"layer": "egg"})
    for sign in (1, -1):
        points = [
            (100 + 3 * math.cos(math.pi * i / 24), 50 + sign * (gap + 10 * math.sin(math.pi * i / 24)))
            for i in range(25)
        ]
        space.add_spline(fit_points=points, dxfattribs={"layer": "slit"})
    found = areas(read(drawing, tmp_path, tolerance="20 mm"))
    assert found == {
        "egg": pytest.approx(32 * math.pi, rel=1e-6),
        "slit": pytest.approx(30 * math.pi + 12 * gap, rel=2e-3),
    }
    drawn = imported_shape(ShapeSpec(file="x.dxf", tolerance=2e-2), tmp_path)
    assert drawn is not None and [one.size for one in drawn.gaps] == pytest.approx([2e-3 * gap] * (2 * (gap > 0)))


def test_blocks_without_end_are_refused_before_they_are_made(tmp_path):
    drawing, space = plate()
    names = [f"B{i}" for i in range(12)]
    for name, inner in pairwise(names):
        block = drawing.blocks.new(name)
        for i in range(10):
            block.add_blockref(inner, (i, 0))
    drawing.blocks.new(names[-1]).add_point((0, 0))
    space.add_blockref("B0", (0, 0))
    with pytest.raises(UserError, match=r"1e\+11 entities"):
        read(drawing, tmp_path)
    drawing, space = plate()
    drawing.blocks.new("LOOP").add_blockref("LOOP", (0, 0))
    space.add_blockref("LOOP", (0, 0))
    with pytest.raises(UserError, match="no block may hold itself"):
        read(drawing, tmp_path)
    drawing, space = plate()
    drawing.blocks.new("DOT").add_circle((0, 0), 1)
    grid = {"row_count": 30_000, "row_spacing": 1, "column_count": 30_000, "column_spacing": 1}
    space.add_blockref("DOT", (0, 0), dxfattribs=grid)
    with pytest.raises(UserError, match=r"9e\+08 entities"):
        read(drawing, tmp_path)


def test_more_points_than_a_shape_may_have_are_refused_as_they_come(tmp_path, monkeypatch):
    drawing, space = plate()
    for i in range(50):
        space.add_circle((2 + 4 * i, 50), 1)
    monkeypatch.setattr("restshape.shape.drawings.loose_curve.OUTLINE_PIECES", 100)
    with pytest.raises(UserError, match="more than 200 points") as found:
        read(drawing, tmp_path)
    assert found.value.where == "x.dxf"
