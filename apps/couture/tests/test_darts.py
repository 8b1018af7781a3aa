"""Darts in outlines: their corners, what is cut, and what is refused."""

import json

import numpy as np
import pytest

from restshape.errors import UserError
from restshape.replay.sessions import session_of
from restshape.scene.edit_script import read_script
from restshape.scene.load import load_scene, revise
from restshape.shape.build import outline_from_spec

SHEET = """
format = "restshape-scene"
version = 1
app = "couture"
title = "a sheet with darts"
[parameters]
width = "3 cm"
[shape]
outline = ["bottom", "right", "top", "left"]
vertices = { sw = [0, 0], se = [0.4, 0], ne = [0.4, 0.3], nw = [0, 0.3] }
[shape.edges]
bottom = { line = ["sw", "se"] }
right = { line = ["se", "ne"] }
top = { line = ["ne", "nw"] }
left = { line = ["nw", "sw"] }
[darts]
[material.cloth]
E = "1 MPa"
nu = 0.3
rho = "500 kg/m^3"
thickness = "0.3 mm"
bending = "5e-6 N m"
[supports.pin]
on = "left"
fix = ["x", "y", "z"]
[effects.gravity]
[mesh]
size = "50 mm"
"""
DISC = """[shape]
outline = ["lower", "upper"]
vertices = { west = [-0.2, 0], east = [0.2, 0] }
[shape.edges]
lower = { arc = ["west", "east"], bulge = 1 }
upper = { arc = ["east", "west"], bulge = 1 }
[darts]
"""
FOLDED = """layout = "auto"
[panels.front]
outline = ["hem", "side", "top", "fold"]
mirror = "fold"
vertices = { a = [0, 0], b = [0.2, 0], c = [0.2, 0.4], d = [0, 0.4] }
[panels.front.edges]
hem = { line = ["a", "b"] }
side = { line = ["b", "c"] }
top = { line = ["c", "d"] }
fold = { line = ["d", "a"] }
[darts]
"""


def scene_of(folder, text, **darts):
    (folder / "scene.toml").write_text(text)
    scene = load_scene(folder / "scene.toml")
    return revise(scene, "darts", darts) if darts else scene


def sheet(folder, **darts):
    return scene_of(folder, SHEET, **darts)


def other(shape):
    begin, end = SHEET.index("[shape]"), SHEET.index("[material")
    text = SHEET[:begin] + shape + SHEET[end:]
    if "[panels" in shape:
        text = text.replace("[parameters]", 'layout = "auto"\n[parameters]').replace(shape, shape.split("\n", 1)[1])
        text = text.replace('on = "left"', 'on = "front.top"')
    else:
        text = text.replace('on = "left"', 'on = "lower"')
    return text


def corners(outline, name):
    points = dict(zip(outline.vertex_names, outline.points))
    return [points[f"{name}.{part}"] for part in ("mouth_left", "tip", "mouth_right")]


def legs(outline, name):
    lengths = dict(zip((edge.name for edge in outline.edges), outline.lengths()))
    return lengths[f"{name}.left"], lengths[f"{name}.right"]


def test_a_dart_across_a_straight_edge_is_a_triangle_on_it(tmp_path):
    scene = sheet(tmp_path, d={"edge": "bottom", "at": 0.25, "width": "width", "length": "8 cm"})
    outline = outline_from_spec(scene.shape)
    np.testing.assert_allclose(corners(outline, "d"), [[0.085, 0], [0.1, 0.08], [0.115, 0]], atol=1e-15)
    assert outline.area() == pytest.approx(0.12 - 0.03 * 0.08 / 2, rel=1e-14)
    assert scene.seams["d"].sides == (("d.left",), ("d.right",))


def test_a_dart_to_the_middle_of_a_disc_leaves_a_sector(tmp_path):
    scene = scene_of(tmp_path, other(DISC), d={"edge": "upper", "width": "8 cm", "length": "20 cm"})
    outline = outline_from_spec(scene.shape)
    assert np.hypot(*np.array(corners(outline, "d")).T) == pytest.approx([0.2, 0, 0.2], abs=1e-15)
    angle = 2 * np.arcsin(0.04 / 0.2)
    assert outline.area() == pytest.approx(0.04 * (np.pi - angle / 2), rel=1e-14)


@pytest.mark.parametrize("mouth", ["kept", "straight"])
def test_legs_of_a_slanted_dart_have_one_length_and_its_width_between_them(tmp_path, mouth):
    table = {"edge": "bottom", "at": 0.4, "angle": "25 deg", "width": "5 cm", "length": "12 cm", "mouth": mouth}
    outline = outline_from_spec(sheet(tmp_path, d=table).shape)
    left, tip, right = corners(outline, "d")
    assert legs(outline, "d")[0] == pytest.approx(legs(outline, "d")[1], rel=1e-14)
    assert np.hypot(*(left - right)) == pytest.approx(0.05, rel=1e-13)
    way = np.array([-np.sin(np.deg2rad(25)), np.cos(np.deg2rad(25))])
    np.testing.assert_allclose(tip, [0.16, 0] + 0.12 * way, atol=1e-15)


def test_the_edge_of_a_straight_mouth_is_straight_when_the_dart_is_sewn(tmp_path):
    table = {"edge": "bottom", "at": 0.3, "angle": "-10 deg", "width": "4 cm", "length": "15 cm", "mouth": "straight"}
    outline = outline_from_spec(sheet(tmp_path, d=table).shape)
    left, tip, right = corners(outline, "d")
    half = np.arcsin(0.02 / np.hypot(*(left - tip)))

    def turned(place, angle):
        c, s = np.cos(angle), np.sin(angle)
        return tip + np.array([[c, -s], [s, c]]) @ (place - tip)

    # Seen from the mouth, upwards, a is on the left; the parts turn towards each other.
    a, b = turned(np.zeros(2), half), turned(np.array([0.4, 0]), -half)
    one, same = turned(left, half), turned(right, -half)
    np.testing.assert_allclose(one, same, atol=1e-15)
    assert abs(np.cross(b - a, one - a)) < 1e-15


def test_a_folded_dart_keeps_its_cloth_as_regions(tmp_path):
    scene = sheet(tmp_path, d={"edge": "bottom", "width": "3 cm", "length": "8 cm", "folded": True})
    outline = outline_from_spec(scene.shape)
    assert outline.area() == pytest.approx(0.12, rel=1e-14)
    halves = [abs(outline.loop_area(i)) for i, loop in enumerate(outline.loops) if loop.kind == "region"]
    assert halves == pytest.approx([0.03 * 0.08 / 4] * 2, rel=1e-13)


def test_a_diamond_is_cut_out_along_its_line(tmp_path):
    scene = sheet(tmp_path, d={"line": [[0.1, 0.1], [0.1, 0.25]], "width": "2 cm", "widest": 0.4})
    outline = outline_from_spec(scene.shape)
    points = dict(zip(outline.vertex_names, outline.points))
    np.testing.assert_allclose(points["d.widest_left"], [0.09, 0.16], atol=1e-15)
    assert outline.area() == pytest.approx(0.12 - 0.02 * 0.15 / 2, rel=1e-14)


def test_darts_of_a_panel_on_the_fold_are_symmetric(tmp_path):
    darts = {
        "flank": {"edge": "front.side", "at": 0.5, "angle": "15 deg", "width": "2 cm", "length": "8 cm"},
        "neck": {"edge": "front.top", "at": 1, "width": "2 cm", "length": "8 cm"},
        "waist": {"panel": "front", "line": [[0, 0.1], [0, 0.2]], "width": "2 cm"},
        "hip": {"panel": "front", "line": [[0.05, 0.05], [0.08, 0.15]], "width": "1 cm"},
    }
    scene = scene_of(tmp_path, other(FOLDED), **darts)
    outline = outline_from_spec(scene.shape)
    fold = dict(zip(outline.vertex_names, outline.points))["front.a"][0]
    images = outline.points * [-1, 1] + [2 * fold, 0]
    away = np.hypot(*(outline.points[:, None] - images).transpose(2, 0, 1)).min(axis=1)
    assert away.max() < 1e-15
    assert sorted(scene.seams) == ["flank", "hip", "mirror_flank", "mirror_hip", "neck", "waist"]
    areas = {loop.name: abs(outline.loop_area(i)) for i, loop in enumerate(outline.loops)}
    assert areas["front.mirror"] - areas["front.mirror.hip"] == pytest.approx(outline.area() / 2, rel=1e-13)


@pytest.mark.parametrize(
    ("darts", "where", "said"),
    [
        ({"d": {"edge": "bottom", "width": "50 cm", "length": "8 cm"}}, "darts.d.width", "500 mm wide"),
        ({"d": {"edge": "bottom", "width": "2 cm", "length": "40 cm"}}, "darts.d", "reaches over the edge 'top'"),
        ({"d": {"line": [[0.1, 0.1], [0.1, 0.31]], "width": "2 cm"}}, "darts.d", "give it the `edge`"),
        ({"d": {"edge": "middle", "width": "2 cm", "length": "8 cm"}}, "darts.d.edge", "edges: bottom"),
        (
            {
                "d": {"edge": "bottom", "width": "4 cm", "length": "8 cm"},
                "e": {"line": [[0.15, 0.06], [0.3, 0.06]], "width": "2 cm"},
            },
            "darts.e",
            "the darts 'd' and 'e' meet near",
        ),
    ],
)
def test_a_dart_without_room_is_refused(tmp_path, darts, where, said):
    with pytest.raises(UserError, match=where) as reported:
        outline_from_spec(sheet(tmp_path, **darts).shape)
    assert said in str(reported.value)


@pytest.mark.parametrize(
    ("darts", "where", "said"),
    [
        (
            {
                "d": {"edge": "bottom", "at": 0, "angle": "-70 deg", "width": "1 cm", "length": "8 cm"},
                "e": {"edge": "left", "at": 1, "angle": "70 deg", "width": "1 cm", "length": "8 cm"},
            },
            "darts.e",
            "away from the corner or the other dart",
        ),
        ({"d": {"edge": "bottom", "width": 1e-12, "length": "8 cm"}}, "darts.d", "make it wider"),
        ({"d": {"edge": "bottom", "width": 1e-5, "length": "8 cm"}}, "darts.d", "near (0.2, 0) m"),
        ({"d": {"edge": "bottom", "width": "3 cm", "length": 0.3 - 1e-12}}, "darts.d", "near (0.2, 0.3) m"),
        (
            {"d": {"edge": "bottom", "at": 0.0376, "width": "3 cm", "length": "8 cm"}},
            "darts.d",
            "bottom.1 would collapse",
        ),
        ({"d": {"line": [[1, 1], [1, 2]], "width": "2 cm"}}, "darts.d", "hole d would lie outside"),
        (
            {"d": {"edge": "bottom", "angle": "90 deg", "width": "3 cm", "length": "8 cm"}},
            "darts.d.angle",
            "out of the cloth",
        ),
        ({"d": {"edge": "bottom", "angle": "180 deg", "width": "3 cm", "length": "8 cm"}}, "darts.d.angle", "turn it"),
        (
            {"d": {"edge": "bottom", "angle": "80 deg", "width": "3 cm", "length": "8 cm"}},
            "darts.d.width",
            "or turn it",
        ),
        (
            {"d": {"edge": "bottom", "at": 0, "angle": "60 deg", "width": "3 cm", "length": "8 cm"}},
            "darts.d.angle",
            "out of the cloth",
        ),
        (
            {
                "d": {
                    "edge": "bottom",
                    "at": 0,
                    "angle": "-45 deg",
                    "width": "3 cm",
                    "length": "8 cm",
                    "mouth": "straight",
                }
            },
            "darts.d.mouth",
            "cannot be straight",
        ),
        ({"d": {"edge": "bottom", "line": [[0.1, 0.05], [0.1, 0]], "width": "2 cm"}}, "darts.d.line", "is its place"),
    ],
)
def test_a_dart_that_cannot_be_is_refused_with_its_key_and_what_to_do(tmp_path, darts, where, said):
    with pytest.raises(UserError) as reported:
        outline_from_spec(sheet(tmp_path, **darts).shape)
    assert reported.value.where == where
    assert said in str(reported.value)


def test_a_dart_beside_a_fold_is_sent_onto_it(tmp_path):
    darts = {"q": {"panel": "front", "line": [[0.001, 0.1], [0.001, 0.2]], "width": "2 cm"}}
    with pytest.raises(UserError, match="put its line on the fold"):
        outline_from_spec(scene_of(tmp_path, other(FOLDED), **darts).shape)
    near = {"edge": "front.top", "at": 1 - 1e-10, "width": "2 cm", "length": "8 cm"}
    assert scene_of(tmp_path, other(FOLDED), q=near).shape.darts[0].fold == "front.fold"


def test_the_name_of_a_corner_that_a_dart_takes_away_names_the_end_of_its_mouth_on_its_edge(tmp_path):
    dart = {"edge": "bottom", "at": 0, "angle": "-45 deg", "width": "3 cm", "length": "8 cm"}
    outline = outline_from_spec(scene_of(tmp_path, SHEET.replace('on = "left"', 'on = "sw"'), d=dart).shape)
    (vertex,) = outline.entity("sw").vertices
    assert vertex in {v for e in outline.entity("bottom").edges for v in outline.layout.ends[e]}


@pytest.mark.parametrize("part", ["d.tip", "d.mouth_left"])
def test_a_corner_of_a_dart_is_not_deleted_without_it(tmp_path, part):
    dart = {"do": "dart", "name": "d", "from": [0.1, -0.05], "to": [0.1, 0.05], "width": "2 cm"}
    frames = frames_of(tmp_path, sheet(tmp_path), dart, {"do": "delete", "on": part})
    assert "is a part of the dart 'd'" in frames[-1].refused


def test_a_long_line_across_a_panel_meets_both_of_its_sides(tmp_path):
    line = {"from": [0.1, -10], "to": [0.1, 10]}
    frames = frames_of(tmp_path, sheet(tmp_path), {"do": "dart", "name": "d", "width": "2 cm", **line})
    assert "meets 'bottom' and 'top'" in frames[-1].refused


def frames_of(folder, scene, *events):
    lines = [{"format": "restshape-edits", "version": 1}, *({"t": t, **event} for t, event in enumerate(events))]
    script = read_script("\n".join(map(json.dumps, lines)) + "\n", folder / "edits.jsonl", scene)
    return list(session_of(scene, script).frames())


def test_a_drawn_dart_lies_where_it_is_drawn_on_an_edge_that_a_hand_has_moved(tmp_path):
    frames = frames_of(
        tmp_path,
        sheet(tmp_path),
        {"do": "press", "on": "bottom", "at": [0.2, 0]},
        {"do": "drag", "to": [0.2, -0.03]},
        {"do": "release"},
        {"do": "dart", "name": "d", "from": [0.1, -0.05], "to": [0.12, 0.05], "width": "2 cm"},
        {"do": "set", "key": "darts.d.width", "value": "3 cm", "frames": 2},
        {"do": "set", "key": "darts.d.at", "value": 0.6, "frames": 2},
        {"do": "delete", "on": "d"},
        {"do": "undo"},
    )
    assert [frame.refused for frame in frames] == [None] * len(frames)
    assert [frame.change for frame in frames[4:]] == ["shape", *["move"] * 4, "shape", "shape"]
    drawn = corners(frames[4].outline, "d")
    np.testing.assert_allclose(drawn[1], [0.12, 0.05], atol=1e-12)
    assert legs(frames[4].outline, "d")[0] == pytest.approx(legs(frames[4].outline, "d")[1], rel=1e-12)
    moved = corners(frames[8].outline, "d")
    assert moved[1][0] - drawn[1][0] == pytest.approx((0.6 - frames[4].scene.darts["d"].at) * 0.4, rel=1e-9)
    assert frames[9].outline.points.tolist() == frames[3].outline.points.tolist()


def test_a_line_from_beyond_an_edge_opens_there_and_one_inside_is_a_diamond(tmp_path):
    scene = sheet(tmp_path)
    frames = frames_of(
        tmp_path,
        scene,
        {"do": "dart", "name": "d", "from": [0.1, -0.05], "to": [0.1, 0.05], "width": "2 cm"},
        {"do": "dart", "name": "e", "from": [0.3, 0.1], "to": [0.3, 0.2], "width": "2 cm"},
        {"do": "dart", "name": "f", "from": [0.2, -0.1], "to": [0.2, 0.4], "width": "2 cm"},
        {"do": "dart", "name": "g", "from": [0.08, 0.03], "to": [0.12, 0.03], "width": "1 cm"},
    )
    darts = frames[-1].scene.darts
    assert darts["d"].edge == "bottom"
    assert (darts["d"].at, darts["d"].length) == (pytest.approx(0.25), pytest.approx(0.05))
    assert darts["e"].edge is None
    assert "meets 'bottom' and 'top'" in frames[3].refused
    assert "meets the dart 'd'" in frames[4].refused


WAIST = {"edge": "bottom", "at": 0.25, "width": "3 cm", "length": "9 cm"}


@pytest.mark.parametrize("on", ["top", "bottom"])
def test_a_dart_is_deleted_after_a_vertex_was_inserted_and_dragged(tmp_path, on):
    """The vertex stays where the hand has left it, on another edge and on that of the dart."""
    at = {"top": [0.1, 0.3], "bottom": [0.3, 0.0]}[on]
    there = {"top": [0.1, 0.32], "bottom": [0.3, -0.02]}[on]
    edits = [
        {"do": "insert", "on": on, "name": "own", "at": at},
        {"do": "press", "on": "own"},
        {"do": "drag", "to": there},
        {"do": "release"},
        {"do": "delete", "on": "waist"},
    ]
    frames = frames_of(tmp_path, sheet(tmp_path, waist=WAIST), *edits)
    assert not any(frame.refused for frame in frames)
    outline = frames[-1].outline
    assert sorted(outline.vertex_names) == ["ne", "nw", "own", "se", "sw"]
    assert outline.points[outline.vertex_names.index("own")] == pytest.approx(there)
    assert len(outline.entity(on).edges) == 2
    # The sheet, and the triangle that the hand has pulled out of one side.
    assert outline.area() == pytest.approx(0.12 + 0.5 * 0.4 * 0.02)


def test_a_dart_is_not_deleted_after_a_hole_was_cut_which_a_message_says(tmp_path):
    edits = [
        {"do": "hole", "name": "eye", "center": [0.3, 0.2], "radius": 0.02},
        {"do": "delete", "on": "waist"},
    ]
    last = frames_of(tmp_path, sheet(tmp_path, waist=WAIST), *edits)[-1]
    assert "edits by hand have changed those before" in last.refused and "undo these edits" in last.refused
