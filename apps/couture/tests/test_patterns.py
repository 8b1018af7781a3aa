"""Sewing patterns: GarmentCode's files, DXF by layers, and SVG, read, written and refused."""

import json

import ezdxf
import numpy as np
import pytest
from patterns_drawn import AREAS, TUNIC, changed, squares_dxf, written

from restshape.application import application
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.export.garmentcode_file import write_garmentcode
from restshape.export.pattern_drawings import write_pattern_dxf
from restshape.export.pattern_scene import pattern_of_scene, write_pattern_scene
from restshape.export.pattern_svg_file import write_pattern_svg
from restshape.scene.bodies import start_of
from restshape.scene.load import load_scene
from restshape.scene.panels import panels_of
from restshape.scene.space_values import evaluated
from restshape.shape.build import outline_from_spec
from restshape.shape.patterns.garmentcode import read_garmentcode
from restshape.shape.patterns.pattern_axes import angles_of, turned_up
from restshape.shape.patterns.pattern_drawing import read_pattern_dxf
from restshape.shape.patterns.pattern_svg import read_pattern_svg
from restshape.shape.placement import rotation

INCH = 25.4e-3
SHEET = application("couture").folder / "template" / "scene.toml"


def areas(pattern) -> dict[str, float]:
    return {piece.name: piece.outline().area() for piece in pattern.pieces}


def test_curves_of_every_kind_have_their_areas(tmp_path):
    assert areas(read_garmentcode(written(tmp_path))) == pytest.approx(AREAS, rel=1e-12)


def test_control_points_may_be_absolute(tmp_path):
    pattern = changed("properties", "curvature_coords", value="absolute")
    front, back = (pattern["pattern"]["panels"][name]["edges"] for name in ("front", "back"))
    front[1]["curvature"]["params"] = [[34, 30]]
    front[3]["curvature"]["params"] = [[-12, 45], [-12, 15]]
    back[1]["curvature"] = [34, 30]
    back[3]["curvature"]["params"] = [[6, 48], [-12, 6]]
    assert areas(read_garmentcode(written(tmp_path, pattern))) == pytest.approx(AREAS, rel=1e-12)


def test_pieces_lie_where_the_file_has_them(tmp_path):
    """Turned about x, then y, then z, then moved; in centimetres, y up."""
    back = read_garmentcode(written(tmp_path)).piece("back")
    a, b, c = np.radians([10.0, 150.0, -20.0])
    x = np.array([[1, 0, 0], [0, np.cos(a), -np.sin(a)], [0, np.sin(a), np.cos(a)]])
    y = np.array([[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]])
    z = np.array([[np.cos(c), -np.sin(c), 0], [np.sin(c), np.cos(c), 0], [0, 0, 1]])
    assert rotation(back.turn) == pytest.approx(z @ y @ x)
    assert back.move == pytest.approx((0.1, 0.2, -0.3))


def test_axes_turn_and_turn_back(tmp_path):
    pattern = read_garmentcode(written(tmp_path))
    upright = turned_up(pattern, "z")
    assert upright.piece("front").move == pytest.approx((0.1, -0.3, 0.2))
    again = turned_up(upright, "y").piece("back")
    assert rotation(again.turn) == pytest.approx(rotation(pattern.piece("back").turn))
    assert again.move == pytest.approx(pattern.piece("back").move)


@pytest.mark.parametrize("turn", [(0.3, -0.7, 2.0), (0.4, np.pi / 2, 0.9), (-1.0, -np.pi / 2, 0.2), (0.0, 0.0, 0.0)])
def test_angles_are_those_of_their_rotation(turn):
    """Also where a right angle about y leaves only the sum or the difference of the others."""
    assert rotation(angles_of(rotation(turn))) == pytest.approx(rotation(turn), abs=1e-9)


def test_a_file_that_is_read_and_written_is_the_same(tmp_path):
    source, out = written(tmp_path), tmp_path / "again.json"
    assert write_garmentcode(read_garmentcode(source), out) == []
    again = json.loads(out.read_text())
    # A list in place of a table was the older way to write a quadratic curve.
    old = TUNIC["pattern"]["panels"]["back"]["edges"][1]["curvature"]
    new = again["pattern"]["panels"]["back"]["edges"][1].pop("curvature")
    assert new["type"] == "quadratic" and new["params"][0] == pytest.approx(old)
    assert again.pop("note") == "written by restshape export"
    wanted = json.loads(json.dumps(TUNIC))
    del wanted["pattern"]["panels"]["back"]["edges"][1]["curvature"]
    assert again == rounded(wanted)


def rounded(value):
    """The same plain value, equal to one whose numbers differ by rounding."""
    if isinstance(value, dict):
        return {key: rounded(inner) for key, inner in value.items()}
    if isinstance(value, list):
        return [rounded(inner) for inner in value]
    return pytest.approx(value, rel=1e-9, abs=1e-9) if isinstance(value, float | int) else value


def test_panels_with_names_of_their_own_stay(tmp_path):
    """A key `name` of two panels is theirs to keep; a panel's name that no piece can have comes back."""
    pattern = changed("pattern", "panels", "front", "name", value="bodice")
    panels = pattern["pattern"]["panels"]
    panels["back"]["name"] = "bodice"
    panels["left sleeve"] = {**panels["back"], "label": "sleeve"}
    write_garmentcode(read_garmentcode(written(tmp_path, pattern)), tmp_path / "again.json")
    again = json.loads((tmp_path / "again.json").read_text())["pattern"]["panels"]
    assert {name: panel["name"] for name, panel in again.items()} == dict.fromkeys(panels, "bodice")


def test_a_whole_number_of_thousands_of_digits_is_refused(tmp_path):
    path = written(tmp_path, '{"pattern": {"panels": ' + "1" * 5000 + "}}", "digits.json")
    with pytest.raises(UserError, match="a whole number has thousands of digits"):
        read_garmentcode(path)


@pytest.mark.parametrize("seams", [[["front", 0], ["back", 0]], [["front", 2], ["back", 2]]])
def test_stitches_go_by_panel_and_edge(tmp_path, seams):
    sides = [{"panel": panel, "edge": edge} for panel, edge in seams]
    pattern = read_garmentcode(written(tmp_path, changed("pattern", "stitches", value=[sides])))
    (stitch,) = pattern.stitches
    assert (stitch.first, stitch.second) == ((f"front.e{seams[0][1]}",), (f"back.e{seams[1][1]}",))


@pytest.mark.parametrize(
    ("write", "read", "name"),
    [(write_pattern_dxf, read_pattern_dxf, "tunic.dxf"), (write_pattern_svg, read_pattern_svg, "tunic.svg")],
)
def test_drawings_keep_pieces_and_areas(tmp_path, write, read, name):
    out = tmp_path / name
    (note,) = write(read_garmentcode(written(tmp_path)), out)
    assert "what the file says besides of front" in note
    found = read(out)
    assert areas(found) == pytest.approx(AREAS, rel=1e-9) and found.notes == () and found.doubt == ""


def test_edges_of_an_svg_keep_their_names(tmp_path):
    write_pattern_svg(read_garmentcode(written(tmp_path)), tmp_path / "tunic.svg")
    front = read_pattern_svg(tmp_path / "tunic.svg").piece("front")
    assert sorted(front.shape["edges"]) == ["e0", "e1", "e2", "e3"]


def test_layers_of_a_dxf_have_their_meanings(tmp_path):
    found = read_pattern_dxf(squares_dxf(tmp_path))
    front, back = found.pieces
    assert (front.name, back.name) == ("FRONT", "BACK")
    # The line of the seam, without the allowance, less a round opening.
    assert front.outline().area() == pytest.approx((100 - np.pi) * INCH**2, rel=1e-12)
    assert back.outline().area() == pytest.approx(20 * INCH**2, rel=1e-12)
    assert front.grain == pytest.approx(np.pi / 2) and back.grain is None
    assert list(front.shape["regions"]) == ["internal1"]
    assert front.shape["vertices"]["notch1"] == pytest.approx([10 * INCH, 10 * INCH])
    assert front.shape["points"] == {"notch2": pytest.approx([8 * INCH, 8 * INCH])}


def test_what_a_dxf_has_besides_is_counted_and_named(tmp_path):
    (note,) = read_pattern_dxf(squares_dxf(tmp_path)).notes
    assert "2 POINT on layer 3 (curve points)" in note and "1 TEXT on layer 15 (annotation)" in note
    assert "1 LINE on layer 8 (lines inside) that closes no loop" in note
    assert "1 POINT on layer 4 (notches) at no vertex and in no piece" in note


def test_pieces_without_blocks_have_a_seam_or_are_cut(tmp_path):
    """Of a cut line around the line of a seam the seam counts; one around none is a piece by itself."""
    drawing = ezdxf.new("R2010", units=ezdxf.units.CM)
    space = drawing.modelspace()
    for x, side, layer in ((0, 12, "1"), (1, 10, "14"), (20, 5, "1")):
        corners = [(x, x), (x + side, x), (x + side, x + side), (x, x + side)]
        space.add_lwpolyline(corners, close=True, dxfattribs={"layer": layer})
    space.add_lwpolyline([(40, 0), (50, 0), (50, 5)], dxfattribs={"layer": "1"})
    drawing.saveas(tmp_path / "loose.dxf")
    found = read_pattern_dxf(tmp_path / "loose.dxf")
    assert sorted(areas(found).values()) == pytest.approx([25e-4, 100e-4])
    assert found.notes == ("not read: 2 LWPOLYLINE on layer 1 that closes no loop",)


def test_a_seam_in_the_notch_of_another_piece_is_not_its_seam(tmp_path):
    """A cut line of an L, without the line of a seam, has the sewn square of another piece in its notch."""
    drawing = ezdxf.new("R2010", units=ezdxf.units.CM)
    space = drawing.modelspace()
    ell = [(0, 0), (30, 0), (30, 10), (10, 10), (10, 30), (0, 30)]
    space.add_lwpolyline(ell, close=True, dxfattribs={"layer": "1"})
    space.add_lwpolyline([(15, 15), (25, 15), (25, 25), (15, 25)], close=True, dxfattribs={"layer": "14"})
    drawing.saveas(tmp_path / "notch.dxf")
    found = read_pattern_dxf(tmp_path / "notch.dxf")
    assert sorted(areas(found).values()) == pytest.approx([100e-4, 500e-4]) and found.notes == ()


@pytest.mark.parametrize("corners", [(), ((0, 0), (30, 0), (30, 20), (0, 20), (15, 20))])
def test_a_curve_of_short_lines_is_one_edge(tmp_path, corners):
    """By points of layer 2, which cut the upper edge in two, or by the angles: a sagging upper edge of 32 lines."""
    x = np.linspace(30.0, 0.0, 33)
    border = [(0, 0), (30, 0), *zip(x, 20.0 - 2.0 * np.sin(np.pi * x / 30.0) * (len(corners) == 0))]
    drawing = ezdxf.new("R2010", units=ezdxf.units.CM)
    drawing.modelspace().add_lwpolyline(border, close=True, dxfattribs={"layer": "1"})
    for corner in corners:
        drawing.modelspace().add_point(corner, dxfattribs={"layer": "2"})
    drawing.saveas(tmp_path / "curve.dxf")
    (piece,) = read_pattern_dxf(tmp_path / "curve.dxf").pieces
    kinds = sorted(kind for edge in piece.shape["edges"].values() for kind in edge if kind in ("line", "polyline"))
    assert kinds == ["line"] * 3 + ["polyline"] * (2 if corners else 1)
    (xs, ys) = np.array(border).T / 100
    area = 0.5 * float(np.sum(xs * np.roll(ys, -1) - np.roll(xs, -1) * ys))
    assert piece.outline().area() == pytest.approx(area, rel=1e-12)


@pytest.mark.parametrize(("angle", "scale"), [(90, 1), (0, -1), (30, 2)])
def test_blocks_are_turned_mirrored_and_scaled(tmp_path, angle, scale):
    drawing = ezdxf.new("R2010", units=ezdxf.units.CM)
    block = drawing.blocks.new("P")
    block.add_lwpolyline([(0, 0), (30, 0), (30, 20)], close=True, dxfattribs={"layer": "1"})
    look = {"rotation": angle, "xscale": scale, "yscale": abs(scale)}
    drawing.modelspace().add_blockref("P", (500, 0), dxfattribs=look)
    drawing.saveas(tmp_path / "turned.dxf")
    (piece,) = read_pattern_dxf(tmp_path / "turned.dxf").pieces
    assert piece.outline().area() == pytest.approx(0.3 * 0.2 / 2 * scale**2)
    corners = np.array(list(piece.shape["vertices"].values()))
    assert np.abs(corners).max() < 1.0, "in coordinates of the block, not of where it is put"


def test_a_dxf_written_has_a_block_a_piece_and_numbered_layers(tmp_path):
    write_pattern_dxf(read_pattern_dxf(squares_dxf(tmp_path)), tmp_path / "again.dxf")
    drawing = ezdxf.readfile(tmp_path / "again.dxf")
    kinds = {(one.dxf.layer, one.dxftype()) for one in drawing.blocks.get("FRONT")}
    assert kinds >= {("1", "LINE"), ("14", "LINE"), ("11", "ARC"), ("8", "LINE"), ("7", "LINE"), ("4", "POINT")}
    again, before = (areas(read_pattern_dxf(tmp_path / name)) for name in ("again.dxf", "squares.dxf"))
    assert again == pytest.approx(before, rel=1e-12)


def test_an_entity_that_no_edge_can_be_is_named_with_its_layer(tmp_path):
    drawing = ezdxf.new("R2010")
    drawing.modelspace().add_3dface([(0, 0), (1, 0), (1, 1), (0, 1)], dxfattribs={"layer": "1"})
    drawing.saveas(tmp_path / "faces.dxf")
    with pytest.raises(UserError, match="3DFACE on layer '1'"):
        read_pattern_dxf(tmp_path / "faces.dxf")


def test_open_lines_of_an_svg_are_counted(tmp_path):
    path = tmp_path / "one.svg"
    path.write_text(
        '<svg xmlns="http://www.w3.org/2000/svg" width="100mm" height="100mm" viewBox="0 0 100 100">'
        '<rect id="pocket" x="10" y="10" width="50" height="40"/><path id="grain" d="M 20 20 L 20 40"/></svg>'
    )
    found = read_pattern_svg(path)
    assert areas(found) == {"pocket": pytest.approx(0.05 * 0.04)}
    assert found.notes == ("not read: 1 path 'grain' that closes no loop",)


@pytest.mark.parametrize(
    ("keys", "value", "message"),
    [
        (("pattern", "panels"), {}, "no panels"),
        (
            ("pattern", "panels", "front", "edges", 2, "curvature", "type"),
            "spiral",
            r"edge 2: .* kind 'spiral', line \d+",
        ),
        (("pattern", "panels", "front", "edges", 2, "curvature", "params", 0), 19.0, "does not reach"),
        (("pattern", "panels", "front", "edges", 2, "endpoints"), [2, 9], "endpoints"),
        (("pattern", "panels", "front", "edges", 0, "endpoints"), [0, 2], "open or branches"),
        (("pattern", "panels", "front", "vertices", 1), [40], "no list of points"),
        (("pattern", "panels", "front", "vertices", 1), ["40", 0], "no number"),
        (("pattern", "panels", "front", "translation"), [0, 0], "three numbers"),
        (("pattern", "stitches", 0, 0, "panel"), "sleeve", "'sleeve', which is not there"),
        (("pattern", "stitches", 0, 0, "edge"), 7, "front.e7, which is not there"),
        (("pattern", "stitches", 0, 1), {"panel": "front", "edge": 1}, "to itself"),
        (("pattern", "stitches", 1, 0), {"panel": "front", "edge": 1}, "both of the edge front.e1"),
        (("properties", "units_in_meter"), 0, "units in a metre"),
        (("properties", "curvature_coords"), "polar", "'polar'"),
    ],
)
def test_bad_files_are_refused_with_the_place(tmp_path, keys, value, message):
    with pytest.raises(UserError, match=message):
        read_garmentcode(written(tmp_path, changed(*keys, value=value)))


@pytest.mark.parametrize(
    "text", ["", "[]", "{", '{"pattern": 3}', '{"pattern": {"panels": {"a": 1}}}', "\x00", "[" * 9999]
)
def test_what_is_no_pattern_is_refused(tmp_path, text):
    with pytest.raises(UserError, match=r"tunic\.json"):
        read_garmentcode(written(tmp_path, text))


def test_a_file_without_a_unit_is_doubted(tmp_path):
    pattern = changed("properties", value={})
    assert "centimet" in read_garmentcode(written(tmp_path, pattern)).doubt


@pytest.mark.cli
def test_the_command_goes_from_format_to_format(tmp_path, capsys):
    source = written(tmp_path)
    for ending in ("dxf", "svg", "json", "toml"):
        out = tmp_path / f"out.{ending}"
        assert main(["pattern", str(source), "--out", str(out)]) == 0
        assert f"wrote {out}: 2 pieces of {sum(AREAS.values()):.6g} m^2" in capsys.readouterr().out
    assert main(["pattern", str(source), "--out", str(tmp_path / "out.png")]) == 2
    assert main(["pattern", str(tmp_path / "none.json"), "--out", str(tmp_path / "b.svg")]) == 2


def pinned(path) -> None:
    """Adds pins to the scene of a tunic, without which nothing holds it."""
    path.write_text(path.read_text() + '\n[supports.pins]\non = ["front.v2", "front.v3"]\nfix = ["x", "y", "z"]\n')


@pytest.fixture
def scene(tmp_path):
    """The scene of the tunic, and its path."""
    path = tmp_path / "tunic.toml"
    write_pattern_scene(read_garmentcode(written(tmp_path)), path, "tunic")
    assert load_scene(path).title == "tunic"
    pinned(path)
    return load_scene(path)


def test_a_scene_has_the_panels_where_they_are(scene, tmp_path):
    """What goes up along y in the file goes up along z in the scene."""
    assert {name: outline_from_spec(panel).area() for name, panel in panels_of(scene).items()} == pytest.approx(AREAS)
    start = evaluated(start_of(scene), {})
    assert rotation(start.turn) @ (0, 1, 0) == pytest.approx((0, 0, 1))
    assert panels_of(scene)["front"].move == pytest.approx((0.1, 0.2, 0.3))


def test_a_scene_has_the_seams(scene):
    assert {seam.sides for seam in scene.seams.values()} == {
        (("front.e1",), ("back.e3",)),
        (("front.e3",), ("back.e1",)),
    }


def test_the_pattern_of_a_scene_is_that_of_its_file(scene, tmp_path):
    write_garmentcode(pattern_of_scene(scene), tmp_path / "again.json")
    before, after = (read_garmentcode(tmp_path / name) for name in ("tunic.json", "again.json"))
    assert areas(after) == pytest.approx(areas(before), rel=1e-9)
    for piece in before.pieces:
        again = after.piece(piece.name)
        assert again.move == pytest.approx(piece.move)
        assert rotation(again.turn) == pytest.approx(rotation(piece.turn))
    assert [(one.first, one.second) for one in after.stitches] == [(one.first, one.second) for one in before.stitches]


def test_a_sheet_placed_by_its_start_is_one_piece(tmp_path):
    """In a scene that is not upright the start is part of where pieces lie."""
    text = SHEET.read_text() + '\n[start]\nturn = [0, 0, "90 deg"]\nmove = [0.1, 0, 0.2]\n'
    (tmp_path / "sheet.toml").write_text(text)
    pattern = pattern_of_scene(load_scene(tmp_path / "sheet.toml"))
    (piece,) = pattern.pieces
    assert (piece.name, pattern.up) == ("sheet", "z")
    assert rotation(piece.turn) @ (1, 0, 0) == pytest.approx((0, 1, 0)) and piece.move == pytest.approx((0.1, 0, 0.2))
