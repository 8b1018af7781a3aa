"""What of a garment's panels goes into each format and comes back: places, pleats, regions, formulas, the grain."""

import numpy as np
import pytest

from restshape.cli.main import main
from restshape.export.paper_tiles import TileGrid
from restshape.export.pattern_marks import notches
from restshape.export.pattern_scene import pattern_of_scene
from restshape.export.pattern_sheet import pattern_sheet
from restshape.export.pattern_tiles import _figures
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec
from restshape.shape.patterns.pattern_axes import turned_up
from restshape.shape.patterns.seam_parts import seam_parts

SCENE = """
format = "restshape-scene"
version = 1
app = "couture"
[parameters]
wide = "12 cm"
[panels.skirt]
outline = ["hem", "right", "waist", "left"]
turn = ["90 deg", 0, 0]
move = [0, 0, "-35 cm"]
vertices = { a = [0, 0], b = ["32 cm", 0], c = ["32 cm", "30 cm"], d = [0, "30 cm"] }
[panels.skirt.edges]
hem = { line = ["a", "b"] }
right = { line = ["b", "c"] }
waist = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[panels.skirt.regions]
place = { polygon = [["6 cm", "6 cm"], ["18 cm", "6 cm"], ["18 cm", "18 cm"], ["6 cm", "18 cm"]] }
[panels.band]
outline = ["bottom", "right", "top", "left"]
move = ["6 cm", 0, 0]
layer = 2
vertices = { a = [0, 0], b = ["20 cm", 0], c = ["20 cm", "4 cm"], d = [0, "4 cm"] }
[panels.band.edges]
bottom = { line = ["a", "b"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[panels.pocket]
outline = ["bottom", "right", "top", "left"]
vertices = { a = [0, 0], b = ["wide", 0], c = ["wide", "12 cm"], d = [0, "12 cm"] }
[panels.pocket.edges]
bottom = { arc = ["a", "b"], through = ["wide/2", "-wide/9"] }
right = { line = ["b", "c"] }
top = { line = ["c", "d"] }
left = { line = ["d", "a"] }
[panels.flap]
mirror = "fold"
outline = ["bottom", "fold", "top"]
vertices = { a = [0, 0], b = ["wide", 0], c = ["wide", "12 cm"] }
[panels.flap.edges]
bottom = { line = ["a", "b"] }
fold = { line = ["b", "c"] }
top = { line = ["c", "a"] }
[seams.waist]
from = "skirt.waist"
to = "band.bottom"
[seams.waist.pleats]
one = { at = 0.3, depth = "3 cm", toward = "start" }
two = { at = 0.7, depth = "3 cm" }
[material.cloth]
name = "denim"
grain = "90 deg"
[effects.gravity]
[supports.band]
on = "band.top"
fix = ["x", "y", "z"]
[mesh]
size = "40 mm"
"""


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "scene.toml"
    path.write_text(SCENE)
    return path


def corners(path) -> dict[str, np.ndarray]:
    """The lower and the upper corner in space of each panel, by its name."""
    found = {}
    for piece in turned_up(pattern_of_scene(load_scene(path)), "z").pieces:
        low, high = piece.outline().bounds()
        across = piece.turn[0] == pytest.approx(0.5 * np.pi)
        space = [[x, 0.0, y] if across else [x, y, 0.0] for x, y in (low, high)]
        found[piece.name] = np.array(space) + piece.move
    return found


@pytest.mark.parametrize("ending", ["svg", "dxf", "json", "toml"])
def test_panels_come_back_to_their_places_with_their_names(scene, tmp_path, capsys, ending):
    out, again = tmp_path / f"there.{ending}", tmp_path / "again.toml"
    assert main(["pattern", str(scene), "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "layers of cloth, band in 2" in said
    assert main(["pattern", str(out), "--out", str(again)]) == 0
    before, after = corners(scene), corners(again)
    assert before.keys() == after.keys()
    for name, places in before.items():
        assert after[name] == pytest.approx(places, abs=1e-9), name
    outline = outline_from_spec(load_scene(again).shape)
    if ending == "json":
        assert "no lines within: skirt.place" in said and "1 of 1 seam" in said
    else:
        assert "skirt.place" in outline.names("region")
        assert ("pleats of the seams waist" in said) == (ending != "toml")
    if ending == "toml":
        assert load_scene(again).seams["waist"].pleats.keys() == {"one", "two"}
        assert {*outline.names("vertex")} == {*outline_from_spec(load_scene(scene).shape).names("vertex")}


def test_formulas_of_panels_stay_where_they_give_the_shape(scene, tmp_path, capsys):
    out = tmp_path / "frame.toml"
    assert main(["export", str(scene), "--as", "toml", "--out", str(out)]) == 0
    said = capsys.readouterr().out
    assert "panel flap" in said and "panel pocket" not in said
    wide = load_scene(out, ['parameters.wide="20 cm"'])
    outline, places = outline_from_spec(wide.shape), wide.shape.vertices
    sides = {
        name: float(np.hypot(*np.subtract(places[f"{name}.b"], places[f"{name}.a"]))) for name in ("pocket", "flap")
    }
    assert sides == pytest.approx({"pocket": 0.20, "flap": 0.12})
    middle = outline.point(outline.entity("pocket.bottom").edges[0], 0.5)[0]
    assert places["pocket.a"][1] - middle[1] == pytest.approx(0.20 / 9.0)


def test_drawings_of_export_are_no_patterns(tmp_path, capsys, scene):
    for ending in ("svg", "dxf"):
        out = tmp_path / f"whole.{ending}"
        assert main(["export", str(scene), "--as", ending, "--out", str(out)]) == 0
        text = out.read_text()
        # As where parts of one edge have no end in common.
        if ending == "svg":
            out.write_text(text.replace("</svg>", '<path d="M 0,0 L 900,900"/></svg>'))
        assert main(["pattern", str(out), "--out", str(tmp_path / "no.toml")]) != 0
        assert f"restshape pattern SCENE --out FILE.{ending}" in capsys.readouterr().err


def test_sheets_name_those_that_are_there_and_arrows_follow_the_material(scene):
    pattern = pattern_of_scene(load_scene(scene))
    assert [piece.grain for piece in pattern.pieces] == pytest.approx([0.5 * np.pi] * 4)
    marked = notches(pattern.pieces[0].outline(), "skirt", seam_parts(pattern))
    assert sorted(round(float(notch.place[0]), 9) for notch in marked) == [0.0, 0.081, 0.111, 0.209, 0.239, 0.32]
    sheet = pattern_sheet(pattern, 0.0)
    grid = TileGrid("a4", *sheet.box)
    tiles = grid.tiles([line.points for line in sheet.lines])
    first, *pages = [
        [text.get_text() for text in figure.axes[0].texts] for figure in _figures(sheet, grid, tiles, pattern, "it")
    ]
    assert {"skirt", "band", "pocket", "flap"} <= set(first)
    named = [part.split(": ")[1] for page in pages for part in page[-1].split("; ")[0].split(", ") if ": " in part]
    assert named and set(named) <= {tile.name for tile in tiles}
