"""Drawings of patterns keep seams, names, places in space and allowances; what is not understood is counted."""

import math
from dataclasses import replace
from pathlib import Path

import ezdxf
import numpy as np
import pytest

from restshape.export.pattern_drawings import write_pattern_dxf
from restshape.export.pattern_scene import pattern_of_scene
from restshape.export.pattern_svg_file import write_pattern_svg
from restshape.export.seam_allowance import cut_lines, hole_cut_lines
from restshape.scene.load import load_scene
from restshape.shape.patterns.pattern import Pattern, PatternPiece, Stitch
from restshape.shape.patterns.pattern_drawing import CUT, CUTOUT, INTERNAL, NOTCH, SEW, read_pattern_dxf
from restshape.shape.patterns.pattern_notes import kept
from restshape.shape.patterns.pattern_pieces import is_in
from restshape.shape.patterns.pattern_svg import read_pattern_svg

PATTERNS = Path(__file__).parents[1] / "patterns"
KINDS = ((write_pattern_dxf, read_pattern_dxf, "p.dxf"), (write_pattern_svg, read_pattern_svg, "p.svg"))
BOTH = pytest.mark.parametrize(("write", "read", "name"), KINDS)


def square(name: str, side: float = 0.3, cut: float = 0.0) -> PatternPiece:
    """A square piece [m], of which a bay of this width and half the side's depth is cut out of the upper edge."""
    corners = [(0, 0), (side, 0), (side, side)]
    if cut:
        corners += [(0.5 * (side + cut), side), (0.5 * side, 0.5 * side), (0.5 * (side - cut), side)]
    corners.append((0, side))
    names = [f"v{k}" for k in range(len(corners))]
    edges = {f"e{k}": {"line": [names[k], names[(k + 1) % len(names)]]} for k in range(len(names))}
    vertices = {key: [float(x) for x in corner] for key, corner in zip(names, corners)}
    return PatternPiece(name, {"outline": list(edges), "vertices": vertices, "edges": edges})


TWO = Pattern(
    (square("front"), replace(square("back"), move=(0.1, 0.2, -0.3), turn=(0.1, 0.0, 3.0), grain=0.5)),
    (
        Stitch(("front.e1",), ("back.e3",), name="side", keys={"reverse": True, "ease": 0.1}),
        Stitch(("front.e2", "front.e3"), ("back.e1", "back.e2"), name="long"),
    ),
)


@BOTH
@pytest.mark.parametrize("allowance", [0.0, 0.01])
def test_seams_names_and_places_come_back(tmp_path, write, read, name, allowance):
    assert write(TWO, tmp_path / name, allowance) == []
    found = read(tmp_path / name)
    assert found.notes == () and found.doubt == ""
    assert {(one.name, one.first, one.second) for one in found.stitches} == {
        (one.name, one.first, one.second) for one in TWO.stitches
    }
    assert next(one.keys for one in found.stitches if one.name == "side") == {"reverse": True, "ease": 0.1}
    back = found.piece("back")
    assert back.move == pytest.approx((0.1, 0.2, -0.3)) and back.turn == pytest.approx((0.1, 0.0, 3.0))
    assert back.grain == pytest.approx(0.5)
    assert [piece.outline().area() for piece in found.pieces] == pytest.approx([0.09, 0.09])


@BOTH
def test_a_sloper_with_curves_keeps_its_edges_and_seams(tmp_path, write, read, name):
    before = pattern_of_scene(load_scene(PATTERNS / "bodice.toml"))
    write(before, tmp_path / name)
    found = read(tmp_path / name)
    assert {(s.name, s.first, s.second) for s in found.stitches} == {
        (s.name, s.first, s.second) for s in before.stitches
    }
    for piece in before.pieces:
        assert border_lengths(found.piece(piece.name)) == pytest.approx(border_lengths(piece), rel=1e-9)


def border_lengths(piece: PatternPiece) -> dict[str, float]:
    """Lengths of the edges around a piece [m], by name."""
    outline = piece.outline()
    return {outline.edges[e].name: outline.length(e) for e, _ in outline.loops[0].edges}


def test_a_seam_whose_edge_has_gone_is_counted_and_named(tmp_path):
    write_pattern_svg(TWO, tmp_path / "p.svg")
    text = (tmp_path / "p.svg").read_text().replace('id="front.e1"', 'id="front.other"')
    (tmp_path / "p.svg").write_text(text)
    found = read_pattern_svg(tmp_path / "p.svg")
    assert [stitch.name for stitch in found.stitches] == ["long"]
    assert found.notes == ("not read: 1 the seam 'side', whose edge front.e1 is not there",)


def test_a_seam_with_one_side_is_counted_and_named(tmp_path):
    write_pattern_dxf(replace(TWO, stitches=TWO.stitches[:1]), tmp_path / "p.dxf")
    drawing = ezdxf.readfile(tmp_path / "p.dxf")
    for entity in [one for one in drawing.blocks.get("back") if one.dxf.layer == "14"]:
        entity.discard_xdata("RESTSHAPE")
    drawing.saveas(tmp_path / "p.dxf")
    found = read_pattern_dxf(tmp_path / "p.dxf")
    assert found.stitches == ()
    assert found.notes == ("not read: 1 the seam 'side', which has no edges on its side 'to'",)


def test_an_allowance_is_everywhere_as_wide(tmp_path):
    """Of a convex piece: its area, a strip along its border, and sectors of its corners."""
    (line,) = cut_lines(square("front").outline(), 0.01, "front")
    x, y = line.T
    area = 0.5 * abs(float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)))
    assert area == pytest.approx(0.09 + 1.2 * 0.01 + math.pi * 0.01**2, abs=5e-7)


def test_an_allowance_closes_a_narrow_bay():
    """A bay of 10 mm is filled where the allowance from both sides meets, 20 mm are not; all points are 10 mm away."""
    for cut, filled in ((0.01, True), (0.08, False)):
        outline = square("front", cut=cut).outline()
        line = cut_lines(outline, 0.01, "front")[0]
        assert is_in(np.array([0.15, 0.299]), [np.vstack([line, line[:1]])]) is filled
        border = np.concatenate([outline.polyline(e) for e in range(len(outline.edges))])
        assert np.hypot(*(line[:, None] - border).transpose(2, 0, 1)).min() > 0.01 - 2e-5


def test_a_dxf_with_an_allowance_has_a_cut_line_and_notches(tmp_path):
    write_pattern_dxf(TWO, tmp_path / "p.dxf", 0.01)
    block = list(ezdxf.readfile(tmp_path / "p.dxf").blocks.get("front"))
    (cut,) = [one for one in block if one.dxf.layer == CUT and one.dxftype() == "LWPOLYLINE"]
    xy = np.array(cut.get_points("xy"))
    assert np.ptp(xy, axis=0) == pytest.approx([320.0, 320.0], abs=0.03)
    notches = {tuple(np.round(tuple(one.dxf.location)[:2], 6)) for one in block if one.dxf.layer == NOTCH}
    assert notches == {(300.0, 0.0), (300.0, 300.0), (0.0, 0.0)}


@BOTH
def test_a_region_at_the_border_is_drawn_as_lines_and_noted(tmp_path, write, read, name):
    """Its inner edge is there with its name and seam; readers take the border as it is."""
    shape = square("front").shape
    inner = {"m": {"line": ["v0", "v2"]}}
    region = {"regions": {"half": {"loop": ["e0", "e1", "m"]}}, "edges": {**shape["edges"], **inner}}
    pattern = replace(TWO, pieces=(replace(TWO.pieces[0], shape=shape | region), TWO.pieces[1]))
    pattern = replace(pattern, stitches=(Stitch(("front.m",), ("back.e3",), name="inner"),))
    notes = write(pattern, tmp_path / name, 0.01)
    assert notes == ["drawn as lines, for they share edges with other loops: the regions front.half"]
    if name.endswith(".svg"):
        (line,) = [one for one in (tmp_path / name).read_text().splitlines() if 'id="front.m"' in one]
        assert 'data-seam="inner"' in line
    else:
        lines = [kept(one) for one in ezdxf.readfile(tmp_path / name).blocks.get("front") if one.dxf.layer == INTERNAL]
        assert [one["edge"] for one in lines] == ["front.m"]
    found = read(tmp_path / name)
    assert found.piece("front").outline().area() == pytest.approx(0.09)
    assert any("the seam 'inner', whose edge front.m is not there" in note for note in found.notes)


def with_eye(radius: float) -> Pattern:
    """The pattern with a round hole in front, sewn on one of its four edges."""
    hole = {"holes": {"eye": {"circle": {"center": [0.1, 0.1], "radius": radius}}}}
    pieces = (replace(TWO.pieces[0], shape=TWO.pieces[0].shape | hole), TWO.pieces[1])
    return replace(TWO, pieces=pieces, stitches=(Stitch(("front.eye.1",), ("back.e3",), name="s"),))


@BOTH
def test_a_sewn_hole_comes_back_as_its_seam_with_and_without_an_allowance(tmp_path, write, read, name):
    narrow = "no cut line in sewn holes narrower than two allowances: front.eye"
    for allowance, notes in ((0.0, []), (0.01, []), (0.025, [narrow])):
        assert write(with_eye(0.02), tmp_path / name, allowance) == notes
        found = read(tmp_path / name)
        assert [one.name for one in found.pieces] == ["front", "back"] and found.notes == ()
        assert found.piece("front").outline().area() == pytest.approx(0.09 - math.pi * 0.02**2)
        assert [one.name for one in found.stitches] == ["s"]


def test_the_cut_line_of_a_sewn_hole_lies_inside_at_the_allowance(tmp_path):
    write_pattern_dxf(with_eye(0.02), tmp_path / "p.dxf", 0.008)
    block = list(ezdxf.readfile(tmp_path / "p.dxf").blocks.get("front"))
    (cut,) = [one for one in block if one.dxf.layer == CUTOUT]
    away = np.array(cut.get_points("xy")) - (100.0, 100.0)
    assert np.hypot(*away.T) == pytest.approx(12.0, abs=0.02)
    assert len([one for one in block if one.dxf.layer == SEW]) == 8
    outline = with_eye(0.02).pieces[0].outline()
    (hole,) = [loop for loop in outline.loops if loop.kind == "hole"]
    assert len(hole_cut_lines(outline, hole, 0.0185, "front")) == 1
    assert hole_cut_lines(outline, hole, 0.02, "front") == []


def test_a_dxf_has_no_error_and_its_pieces_are_on_the_standard_s_layers(tmp_path):
    """By ezdxf's audit; numbers of layers as ASTM D6673 has them."""
    write_pattern_dxf(with_eye(0.02), tmp_path / "p.dxf", 0.008)
    drawing = ezdxf.readfile(tmp_path / "p.dxf")
    audit = drawing.audit()
    assert not audit.errors and not audit.fixes
    used = {one.dxf.layer for block in ("front", "back") for one in drawing.blocks.get(block)}
    assert used == {"1", "4", "7", "11", "14", "15"} <= {one.dxf.name for one in drawing.layers}
    assert all(one.dxftype() in ("INSERT", "TEXT") for one in drawing.modelspace())


def test_a_closed_line_with_a_part_of_no_length_is_a_piece(tmp_path):
    """Other programs write such parts; both ends of one are one vertex."""
    drawing = ezdxf.new("R2010", units=4)
    points = [(0, 0), (200, 0), (200, 100), (199.9999, 100.0001), (0, 100.0001)]
    drawing.modelspace().add_lwpolyline(points, close=True, dxfattribs={"layer": CUT})
    drawing.saveas(tmp_path / "sheet.dxf")
    found = read_pattern_dxf(tmp_path / "sheet.dxf")
    assert [piece.outline().area() for piece in found.pieces] == [pytest.approx(0.02, rel=1e-5)] and not found.notes


def test_a_cut_line_has_no_arc_around_a_corner_that_is_none(tmp_path):
    """An edge bends by 0.02 mrad: around that corner the line turns within 0.2 um."""
    corners = [(0.0, 0.0), (0.15, -1.5e-6), (0.3, 0.0), (0.3, 0.2), (0.0, 0.2)]
    vertices = {f"v{k}": list(corner) for k, corner in enumerate(corners)}
    edges = {f"e{k}": {"line": [f"v{k}", f"v{(k + 1) % 5}"]} for k in range(5)}
    piece = PatternPiece("front", {"outline": list(edges), "vertices": vertices, "edges": edges})
    (line,) = cut_lines(piece.outline(), 0.01, "front")
    assert np.hypot(*(line - np.roll(line, 1, axis=0)).T).min() >= 1e-6
    write_pattern_dxf(Pattern((piece,)), tmp_path / "front.dxf", 0.01)
    assert not read_pattern_dxf(tmp_path / "front.dxf").notes
