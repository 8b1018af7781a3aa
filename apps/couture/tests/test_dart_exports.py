"""Patterns with darts in each format: what is cut has them, and seams are of edges that are drawn."""

import shutil
from pathlib import Path

import pytest

from restshape.export.garmentcode_file import write_garmentcode
from restshape.export.pattern_drawings import write_pattern_dxf
from restshape.export.pattern_scene import pattern_of_scene, write_pattern_scene
from restshape.export.pattern_sheet import pattern_sheet
from restshape.export.pattern_svg_file import write_pattern_svg
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec
from restshape.shape.patterns.garmentcode import read_garmentcode
from restshape.shape.patterns.pattern import edge_names
from restshape.shape.patterns.pattern_drawing import read_pattern_dxf
from restshape.shape.patterns.pattern_svg import read_pattern_svg

PATTERNS = Path(__file__).parents[1] / "patterns"
FORMATS = {
    ".dxf": (write_pattern_dxf, read_pattern_dxf),
    ".svg": (write_pattern_svg, read_pattern_svg),
    ".json": (write_garmentcode, read_garmentcode),
    ".toml": (
        lambda pattern, path: write_pattern_scene(pattern, path, "again"),
        lambda p: pattern_of_scene(load_scene(p)),
    ),
}


def total_area(pattern) -> float:
    return sum(piece.outline().area() for piece in pattern.pieces)


@pytest.fixture(scope="module")
def skirt():
    # Panels begin about the body: a coarse grid of it says where that is.
    scene = load_scene(PATTERNS / "skirt.toml", ['bodies.body.mesh.spacing="20 mm"'])
    return scene, pattern_of_scene(scene)


@pytest.mark.parametrize("ending", FORMATS)
def test_darts_of_a_skirt_are_cut_and_sewn_in_each_format(skirt, tmp_path, ending):
    scene, pattern = skirt
    write, read = FORMATS[ending]
    path = tmp_path / f"skirt{ending}"
    notes = write(pattern, path)
    assert not any("seams do not join" in note for note in notes)
    found = read(path)
    assert total_area(found) == pytest.approx(outline_from_spec(scene.shape).area(), rel=1e-9)
    there = edge_names(found.pieces)
    assert all(edge in there for stitch in found.stitches for edge in (*stitch.first, *stitch.second))
    if ending == ".json":
        # Darts; two edges a side, one stitch each; the band's sides and its eighths of the waist.
        assert len(found.stitches) == 4 + 2 * 2 + 2 + 8
    else:
        assert {(s.name, s.first, s.second) for s in found.stitches} == {
            (s.name, s.first, s.second) for s in pattern.stitches
        }


def test_the_sheet_of_a_skirt_has_the_legs_of_its_darts_in_the_colours_of_their_seams(skirt):
    _, pattern = skirt
    sheet = pattern_sheet(pattern, 0.0)
    drawn = [line for line in sheet.lines if line.colour == sheet.seams["front_dart"] and line.width == 0.8]
    # Two legs, and a notch at each of their four ends. Colours come again: another seam of two edges has this one.
    alike = [name for name, colour in sheet.seams.items() if colour == sheet.seams["front_dart"]]
    assert len(drawn) == len(alike) * (2 + 4) and len(alike) == 2


def test_a_seam_of_an_edge_that_a_dart_parts_names_its_pieces_in_order(tmp_path):
    text = (PATTERNS / "skirt.toml").read_text()
    shutil.copy(PATTERNS / "standard.obj", tmp_path)
    begin, end = text.index("[darts.front_dart]"), text.index("[darts.back_dart]")
    dart = '[darts.front_dart]\nedge = "front.side"\nat = 0.5\nwidth = "2 cm"\nlength = "8 cm"\n'
    (tmp_path / "side.toml").write_text(text[:begin] + dart + text[end:])
    scene = load_scene(tmp_path / "side.toml")
    pattern = pattern_of_scene(scene)
    left = next(stitch for stitch in pattern.stitches if stitch.name == "left")
    outline = outline_from_spec(scene.shape)
    pieces = [outline.edges[e].name for e in outline.entity("front.side").edges]
    assert len(pieces) == 2 and left.first == ("front.side_hip", *pieces)
    assert set(left.first) <= edge_names(pattern.pieces)


def test_a_dart_inside_is_left_out_of_a_file_without_holes_and_named(tmp_path):
    pattern = pattern_of_scene(load_scene(PATTERNS / "dress.toml"))
    notes = write_garmentcode(pattern, tmp_path / "dress.json")
    assert any("do not join edges one by one: front.front_dart.left.1" in note for note in notes)
    # Two sides of three edges, and two shoulders.
    assert len(read_garmentcode(tmp_path / "dress.json").stitches) == 2 * 3 + 2
