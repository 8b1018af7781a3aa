"""Edited panels as scenes and patterns: what is written is what the edit has left."""

import pytest

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.export.edited_frame import frame_of_script
from restshape.export.garmentcode_file import write_garmentcode
from restshape.export.pattern_drawings import write_pattern_dxf
from restshape.export.pattern_scene import pattern_of_scene, write_pattern_scene
from restshape.export.pattern_svg_file import write_pattern_svg
from restshape.scene.edit_script import Script, load_script
from restshape.scene.load import load_scene, revise
from restshape.scene.panels import panels_of
from restshape.shape.build import outline_from_spec
from restshape.shape.patterns.garmentcode import read_garmentcode
from restshape.shape.patterns.pattern_drawing import read_pattern_dxf
from restshape.shape.patterns.pattern_svg import read_pattern_svg

SCENE = """
format = "restshape-scene"
version = 1
app = "couture"
[panels.front]
outline = ["hem", "side", "top", "left"]
move = [0.1, 0, 0.2]
angle = "20 deg"
[panels.front.vertices]
a = [0, 0]
b = ["30 cm", 0]
c = [0.3, 0.4]
d = [0, 0.4]
[panels.front.edges]
hem = { line = ["a", "b"] }
side = { arc = ["b", "c"], bulge = 0.2 }
top = { spline = ["c", "d"], through = [[0.2, 0.45], [0.1, 0.42]] }
left = { line = ["d", "a"] }
[panels.front.holes]
neck = { circle = { center = [0.15, 0.3], radius = 0.05 } }
window = { polygon = [[0.05, 0.05], [0.1, 0.05], [0.1, 0.1]] }
[panels.front.points]
mark = [0.2, 0.1]
[panels.front.groups]
both = ["hem", "neck"]
[panels.back]
outline = ["upper", "fold", "lower"]
mirror = "fold"
[panels.back.vertices]
a = [0, 0]
b = [0, 0.3]
c = [0.2, 0.1]
[panels.back.edges]
fold = { line = ["a", "b"] }
upper = { line = ["b", "c"] }
lower = { line = ["c", "a"] }
[supports.pin]
on = ["front.top", "back.b"]
fix = ["x", "y", "z"]
[seams.shoulder]
from = "front.side"
to = "back.upper"
[material.cloth]
name = "denim"
[effects.gravity]
[mesh]
size = "40 mm"
"""
PINS = """
[supports.pin]
on = ["front.top", "back.b"]
fix = ["x", "y", "z"]
"""
EDITS = """{"format": "restshape-edits", "version": 1}
{"t": 0.0, "do": "press", "on": "front.b", "at": [0, 0]}
{"t": 0.1, "do": "drag", "to": [0.04, 0.01], "frames": 3}
{"t": 0.3, "do": "release"}
"""


@pytest.fixture
def path(tmp_path):
    found = tmp_path / "two.toml"
    found.write_text(SCENE)
    return found


def areas(scene) -> dict[str, float]:
    return {piece.name: piece.outline().area() for piece in pattern_of_scene(scene).pieces}


def test_a_scene_of_panels_is_written_as_it_is(path, tmp_path):
    out = tmp_path / "again.toml"
    assert main(["export", str(path), "--as", "toml", "--out", str(out)]) == 0
    before, after = load_scene(path), load_scene(out)
    assert areas(after) == pytest.approx(areas(before), rel=1e-12)
    front, again = (panels_of(one)["front"] for one in (before, after))
    assert again.vertices["c"] == pytest.approx(front.vertices["c"])
    assert (again.move, again.angle, again.groups) == (front.move, front.angle, front.groups)
    assert again.vertices["neck.v1"] == pytest.approx((0.2, 0.3))
    assert again.points["mark"] == pytest.approx(front.points["mark"])
    assert after.seams == before.seams and after.supports == before.supports


def test_an_edit_moves_one_panel_in_its_own_coordinates(path, tmp_path):
    script = tmp_path / "edits.jsonl"
    script.write_text(EDITS)
    out = tmp_path / "edited.toml"
    assert main(["export", str(path), str(script), "--as", "toml", "--out", str(out)]) == 0
    scene, after = load_scene(path), load_scene(out)
    assert areas(after)["back"] == pytest.approx(areas(scene)["back"], rel=1e-12)
    frame = frame_of_script(scene, load_script(script, scene), -1)
    assert sum(areas(after).values()) == pytest.approx(frame.outline.area(), rel=1e-12)
    assert areas(after)["front"] != pytest.approx(areas(scene)["front"], rel=1e-3)
    moved, first = (panels_of(one)["front"].vertices["b"] for one in (after, scene))
    away = sum((a - b) ** 2 for a, b in zip(moved, first)) ** 0.5
    assert away == pytest.approx((0.04**2 + 0.01**2) ** 0.5)


def test_a_piece_cut_on_the_fold_is_drawn_whole(path, tmp_path):
    """Twice its half: 0.2 m times 0.3 m; its fold is a line inside that a DXF has, and nobody reads."""
    pattern = pattern_of_scene(load_scene(path))
    assert pattern.piece("back").outline().area() == pytest.approx(0.2 * 0.3)
    for write, read, name in (
        (write_pattern_dxf, read_pattern_dxf, "two.dxf"),
        (write_pattern_svg, read_pattern_svg, "two.svg"),
    ):
        write(pattern, tmp_path / name)
        found = read(tmp_path / name)
        assert found.piece("back").outline().area() == pytest.approx(0.2 * 0.3)
        front = outline_from_spec(panels_of(load_scene(path))["front"]).area()
        assert found.piece("front").outline().area() == pytest.approx(front, rel=1e-9)


@pytest.mark.parametrize("to", ['["front.left", "front.hem"]', '["front.hem", "front.left"]'])
def test_a_seam_of_several_edges_is_stitched_one_by_one(tmp_path, to):
    """Edges of one length go together, whichever way round the sides are named."""
    text = SCENE.replace("d = [0, 0.4]", "d = [0, 0.268]").replace('to = "back.upper"', f"to = {to}")
    text = text.replace('from = "front.side"', 'from = ["back.upper", "back.lower"]')
    text = text.replace("a = [0, 0]\nb = [0, 0.3]\nc = [0.2, 0.1]", "a = [0, 0]\nb = [0, 0.3]\nc = [0.24, 0.18]")
    (tmp_path / "several.toml").write_text(text)
    pattern = pattern_of_scene(load_scene(tmp_path / "several.toml"))
    write_garmentcode(pattern, tmp_path / "several.json")
    found = read_garmentcode(tmp_path / "several.json")
    lengths = {}
    for piece in found.pieces:
        outline = piece.outline()
        lengths |= {f"{piece.name}.{edge.name}": outline.length(e) for e, edge in enumerate(outline.edges)}
    pairs = [(lengths[one.first[0]], lengths[one.second[0]]) for one in found.stitches]
    assert sorted(first for first, _ in pairs) == pytest.approx([0.0720**0.5, 0.3], rel=1e-9)
    assert all(first == pytest.approx(second, rel=2e-3) for first, second in pairs)


def test_what_a_scene_says_of_seams_stays(path, tmp_path):
    said = 'to = "back.upper"\nreverse = true\nstitched = "flat"\nease = 0.5\nstiffness = "3 MPa"\n'
    path.write_text(SCENE.replace('to = "back.upper"\n', said))
    pattern = pattern_of_scene(load_scene(path))
    write_pattern_scene(pattern, tmp_path / "again.toml", "again")
    (tmp_path / "again.toml").write_text((tmp_path / "again.toml").read_text() + PINS)
    (seam,) = load_scene(tmp_path / "again.toml").seams.values()
    assert (seam.reverse, seam.stitched, seam.ease, seam.stiffness) == (True, "flat", 0.5, 3e6)
    notes = write_garmentcode(pattern, tmp_path / "again.json")
    assert any("ease, reverse, stiffness, stitched of seams" in note for note in notes)


def test_a_frame_of_no_script_is_the_first(path):
    scene = load_scene(path)
    assert frame_of_script(scene, Script.empty(scene), -1).outline.area() == pytest.approx(sum(areas(scene).values()))


@pytest.mark.parametrize("key", ["seams.side", "seams.side.stiffness"])
def test_a_seam_that_is_not_there_is_to_be_added_by_its_table(path, key):
    seams = SCENE[SCENE.index("[seams.shoulder]") : SCENE.index("[material.cloth]")]
    path.write_text(SCENE.replace(seams, ""))
    with pytest.raises(UserError, match=r"there is no seams\.side") as refused:
        revise(load_scene(path), key, 3.0)
    assert refused.value.do == "add it by its table, with from, to"
