"""Scenes of furniture: what they hold, and what is said of what is wrong in them."""

from dataclasses import replace

import numpy as np
import pytest
from furniture_scenes import BENCH, write_bench, write_edits
from plank_text import scene_text
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.pieces import PIECES, table
from restshape_apps.furniture.shape.plank_edits import removed
from restshape_apps.furniture.shape.plank_scene import piece_of, restated, weighing
from restshape_apps.furniture.shape.planks import SIDES

from restshape.application import application
from restshape.cli.main import main
from restshape.errors import UserError
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene, revise
from restshape.scene.plan import plan

DRAWN = "from = [-0.5, 0, 0]\nto = [-0.5, 0, 0.5]\nwidth = [0, 0.3, 0]"


def test_a_bench_has_the_planks_joints_and_feet_that_were_drawn(tmp_path):
    piece = piece_of(load_scene(write_bench(tmp_path)))
    assert [plank.name for plank in piece.planks] == ["top", "left", "right"]
    assert piece.planks[0].size == pytest.approx([1.2, 0.3, 0.02])
    assert [(j.i, SIDES[j.side], j.j, SIDES[j.face]) for j in piece.joints] == [(1, "+x", 0, "-z"), (2, "+x", 0, "-z")]
    assert [(f.plank, SIDES[f.side]) for f in piece.feet] == [(1, "-x"), (2, "-x")]
    assert piece.weights[0].force == pytest.approx((0.0, 0.0, -200.0))


def test_a_plank_by_its_middle_is_the_one_by_two_lines(tmp_path):
    turned = 'center = [-0.5, 0, 0.25]\nsize = [0.5, 0.3]\nturn = ["0 deg", "-90 deg", "0 deg"]'
    one, other = (piece_of(load_scene(write_bench(tmp_path, text))) for text in (BENCH, BENCH.replace(DRAWN, turned)))
    assert other.planks[1].corners() == pytest.approx(one.planks[1].corners())
    assert other.joints == one.joints and other.feet == one.feet


def test_formulas_of_parameters_place_planks(tmp_path):
    text = "[parameters]\nhigh = 0.4\n" + BENCH.replace("0.5]", '"high"]').replace("0.51]", '"high + 0.01"]')
    piece = piece_of(load_scene(write_bench(tmp_path, text), ["parameters.high=0.7"]))
    assert piece.planks[1].size[0] == pytest.approx(0.7)
    assert piece.planks[0].centre[2] == pytest.approx(0.71)


def test_named_joints_alone(tmp_path):
    joint = (
        '[joints]\nnear = false\n[joints.one]\nplank = "left"\nend = "+x"\nto = "top"\nface = "-z"\nfastener = "nail"\n'
    )
    piece = piece_of(load_scene(write_bench(tmp_path, BENCH + joint)))
    assert [(j.i, j.side, j.j, j.face, j.fastener) for j in piece.joints] == [(1, 1, 0, 4, "nail")]
    both = piece_of(load_scene(write_bench(tmp_path, BENCH + joint.replace("near = false", ""))))
    assert [(j.i, j.fastener) for j in both.joints] == [(1, "nail"), (2, "screw")]


def test_without_gravity_nothing_weighs_and_without_push_nothing_pushes(tmp_path):
    push = '[pushes.nudge]\non = "top"\nforce = ["30 N", 0, 0]\n'
    silent = load_scene(write_bench(tmp_path, BENCH.replace("[effects.gravity]\ng = [0, 0, -10]\n", "") + push))
    piece = piece_of(silent)
    assert piece.gravity == (0.0, 0.0, 0.0) and piece.weights[0].force == (0.0, 0.0, 0.0) and not piece.pushes
    pushed = piece_of(load_scene(write_bench(tmp_path, BENCH + push + "[effects.push]\n")))
    assert pushed.pushes[0].force == (30.0, 0.0, 0.0)


def test_weights_without_gravity_are_warned_of(tmp_path):
    silent = BENCH.replace("[effects.gravity]\ng = [0, 0, -10]\n", "")
    for text, warned in ((silent, True), (BENCH, False)):
        scene = load_scene(write_bench(tmp_path, text))
        assert (
            any("weights weigh nothing" in reported for reported in plan(scene, application("furniture")).warnings)
            is warned
        )


@pytest.mark.parametrize("name", sorted(PIECES))
def test_a_piece_written_as_a_scene_is_read_as_the_same_piece(tmp_path, name):
    piece = PIECES[name]()
    (tmp_path / "again.toml").write_text(scene_text(piece, "again", joints=True))
    again = piece_of(load_scene(tmp_path / "again.toml"))
    assert [(j.i, j.side, j.j, j.face, j.fastener) for j in again.joints] == [
        (j.i, j.side, j.j, j.face, j.fastener) for j in piece.joints
    ]
    corners = [np.concatenate([plank.corners() for plank in one.planks]) for one in (piece, again)]
    assert corners[0] == pytest.approx(corners[1], abs=1e-8)
    assert [load.force for load in again.weights] == [pytest.approx(load.force, abs=1e-6) for load in piece.weights]
    assert [f.plank for f in again.feet] == [f.plank for f in piece.feet]
    assert Furniture(again).test().words == Furniture(piece).test().words


def test_pieces_have_the_planks_and_joints_of_table_6_1():
    rows = {"shelf-1": (9, 13), "shelf-2": (10, 13), "bookshelf": (20, 33), "piece-28": (28, 49)}
    assert {name: (len(p.planks), len(p.joints)) for name in rows for p in [PIECES[name]()]} == rows
    assert table(slant=0.1).planks[4].axes[0, 0] == pytest.approx(-0.1 / np.hypot(0.1, 0.7), abs=1e-6)


WRONG = [
    ("unknown plank", ('on = "top"', 'on = "topp"'), ("weights.box.on (line", "did you mean 'top'")),
    ("no wood", ('"pine"', '"pien"'), ("wood.name (line", "no wood pien", "pine")),
    ("no fastener", ('"screw"', '"glue"'), ("fastener.name (line", "no fastener glue", "dowel")),
    ("flat", ("thickness = 0.02", "thickness = 0"), ("wood.thickness (line", "greater than 0", "number above 0")),
    ("unknown key", ("width = [0, 0.3, 0]", "widht = [0, 0.3, 0]"), ("planks.top.widht (line", "did you mean 'width'")),
    ("half drawn", (DRAWN, "from = [0, 0, 0]\nto = [0, 0, 1]"), ("planks.left (line", "'width' is missing")),
    ("both ways", (DRAWN, DRAWN + "\nsize = [1, 1]"), ("planks.left (line", "'size' stands beside 'from'")),
    ("nowhere", (DRAWN, 'wood = "oak"'), ("planks.left (line", "has no place")),
    ("no mass", ('"20 kg"', '"20 N"'), ("weights.box.mass (line", "a mass is wanted")),
    ("formula", ("[-0.6, 0, 0.51]", '["-lon/2", 0, 0.51]'), ("planks.top.from (line", "'lon'", "known names: pi")),
    (
        "parameter",
        ("thickness = 0.02", 'thickness = "thik"\n[parameters]\nthick = 0.02'),
        ("wood.thickness (line", "not in [parameters]\n  try: did you mean 'thick'?"),
    ),
    ("coordinates", ("[-0.6, 0, 0.51]", '["x/2", 0, 0.51]'), ("planks.top.from (line", "cannot name x or y")),
    ("mesh", ("[wood]", "[mesh]\nsize = 0.1\n[wood]"), ("mesh (line", "made of planks")),
    (
        "quantities",
        ("[wood]", "[quantities]\na = { area = true }\n[wood]"),
        ("quantities.a.area (line", "no quantity of"),
    ),
    (
        "no push",
        ("[effects.gravity]", "[effects.push]\n[effects.gravity]"),
        ("effects.push (line", "add [pushes.NAME]"),
    ),
    ("twice", ("[weights.box]", "[weights.left]"), ("weights.left (line", "used twice")),
    ("friction", ("[wood]", "[floor]\nfriction = -1\n[wood]"), ("floor.friction (line", "at least 0")),
    (
        "side",
        ("[wood]", '[joints.a]\nplank = "left"\nend = "x"\nto = "top"\nface = "-z"\n[wood]'),
        ("joints.a.end (line",),
    ),
    ("itself", ("[wood]", '[joints.a]\nplank = "top"\nend = "+x"\nto = "top"\nface = "-z"\n[wood]'), ("itself",)),
]


@pytest.mark.parametrize(("change", "words"), [case[1:] for case in WRONG], ids=[case[0] for case in WRONG])
def test_errors_name_file_key_and_line(tmp_path, change, words):
    assert change[0] in BENCH
    with pytest.raises(UserError) as caught:
        load_scene(write_bench(tmp_path, BENCH.replace(*change, 1)))
    assert all(word in str(caught.value) for word in words), str(caught.value)


@pytest.mark.parametrize(
    ("change", "what", "do"),
    [
        (("0.3", "0"), "its width has no length", "draw a width across its middle line, as long as the plank is wide"),
        (
            ("0.5]", "0]"),
            "its middle line has no length: it ends where it begins",
            "let it go from one point to another one",
        ),
        (("0.3, 0", "0, 0.3"), "its width lies along its middle line", "draw its width across its middle line"),
    ],
)
def test_lines_that_make_no_plank_are_reported_with_their_place(tmp_path, capsys, change, what, do):
    path = write_bench(tmp_path, BENCH.replace(DRAWN, DRAWN.replace(*change)))
    line = path.read_text().split("\n").index("[planks.left]") + 1
    assert main(["check", str(path)]) == 2
    assert capsys.readouterr().err.endswith(f"bench.toml: planks.left (line {line}): {what}\n  try: {do}\n")


def test_a_joint_whose_ends_have_two_names_is_refused(tmp_path):
    joint = '[joints.NAME]\nplank = "left"\nend = "+x"\nto = "top"\nface = "-z"\n'
    text = BENCH + joint.replace("NAME", "a") + joint.replace("NAME", "b")
    with pytest.raises(UserError, match="has a joint already"):
        piece_of(load_scene(write_bench(tmp_path, text)))


def test_other_applications_know_no_planks_and_want_a_mesh(tmp_path):
    path = write_bench(tmp_path)
    path.write_text(path.read_text().replace('"furniture"', '"solid"').replace("g = [0, 0, -10]\n", ""))
    with pytest.raises(UserError, match=r"'solid' has no table 'wood'(.|\n)*furniture"):
        load_scene(path)
    path.write_text('format = "restshape-scene"\nversion = 1\napp = "solid"\n[material.a]\nE = 1\nnu = 0\n')
    with pytest.raises(UserError, match="'mesh' is missing"):
        load_scene(path)
    path.write_text('format = "restshape-scene"\nversion = 1\napp = "solid"\n[mesh]\nsize = 1\n')
    with pytest.raises(UserError, match="'material' is missing"):
        load_scene(path)


BAD_LINES = [
    ({"do": "hole", "name": "a", "center": [0, 0], "radius": 1}, "no event 'hole'"),
    ({"do": "press", "on": "top", "at": [0, 0]}, "at"),
    ({"do": "press", "on": "top", "at": [0, 0, 0], "parameter": "move x"}, "grabbed by its name"),
    ({"do": "press", "on": "top", "parameter": "move w"}, "'move x'"),
    ({"do": "choose", "number": 0}, "at least 1"),
    ({"do": "slide", "to": 1.5}, "at most 1"),
    ({"do": "weight", "name": "a", "on": "top", "mass": "-1 kg"}, "greater than 0"),
    ({"do": "plank", "name": "a", "from": [0, 0, 0], "to": [0, 0, 1]}, "'width' is missing"),
    ({"do": "drag", "to": [0, 0, 0]}, "before a press"),
    ({"do": "drag", "to": 600}, "to a point [x, y, z], not 600\n  try: use 'by' for a parameter"),
    ({"do": "drag", "path": [[0, 0, 0], "3 deg"]}, "not '3 deg'\n  try: use 'by' for a parameter"),
]


@pytest.mark.parametrize(("event", "words"), BAD_LINES, ids=[words for _, words in BAD_LINES])
def test_bad_lines_of_scripts_are_named(tmp_path, event, words):
    scene = load_scene(write_bench(tmp_path))
    with pytest.raises(UserError) as caught:
        load_script(write_edits(tmp_path, event), scene)
    assert "edits.jsonl: line 2" in str(caught.value) and words in str(caught.value)


def test_lengths_of_scripts_are_in_the_units_of_their_header(tmp_path):
    scene = load_scene(write_bench(tmp_path))
    press = {"do": "press", "on": "top", "at": [100, "1 m", 0]}
    script = load_script(write_edits(tmp_path, press, units="mm"), scene)
    assert script.events[0].at == pytest.approx((0.1, 1.0, 0.0))


def test_what_a_set_says_otherwise_goes_into_an_edited_piece(tmp_path):
    scene = load_scene(write_bench(tmp_path))
    piece = piece_of(scene)
    edited = piece.placed(
        np.array([plank.centre + np.array([0.0, 0.1, 0.0]) for plank in piece.planks]),
        np.array([plank.axes for plank in piece.planks]),
        np.array([plank.size for plank in piece.planks]),
    )
    for key, value, found in (
        ("wood.thickness", 0.03, lambda p: [plank.size[2] for plank in p.planks] == [0.03] * 3),
        ("wood.name", "oak", lambda p: {plank.wood for plank in p.planks} == {"oak"}),
        ("weights.box.mass", 7, lambda p: p.weights[0].force[2] == -70.0),
        ("fastener.name", "nail", lambda p: {joint.fastener for joint in p.joints} == {"nail"}),
        ("floor.friction", 0.1, lambda p: p.planes[0].mu == 0.1),
        ("effects.gravity.g", [0, 0, -1], lambda p: p.weights[0].force[2] == -20.0),
    ):
        after = restated(edited, scene, revise(scene, key, value))
        assert found(after), key
        assert [plank.centre[1] for plank in after.planks] == [0.1] * 3
    moved = restated(edited, scene, revise(scene, "planks.left.width", [0, 0.2, 0]))
    assert [plank.centre[1] for plank in moved.planks] == [0.1] * 3 and moved.planks[1].size[1] == 0.2


def test_what_a_session_has_put_weighs_what_gravity_makes_it(tmp_path):
    scene = load_scene(write_bench(tmp_path))
    put = [weighing(scene, name, 0, mass, (0.0, 0.0, 0.5)) for name, mass in (("box", 50.0), ("vase", 3.0))]
    piece = replace(piece_of(scene), weights=tuple(put))
    light = restated(piece, scene, revise(scene, "effects.gravity.g", [0, 0, -1]))
    assert [load.force[2] for load in light.weights] == pytest.approx([-50.0, -3.0])
    other = restated(piece, scene, revise(scene, "weights.box.mass", 7))
    assert [load.force[2] for load in other.weights] == pytest.approx([-70.0, -30.0])


def test_pushes_come_and_go_with_their_effect(tmp_path):
    push = '[pushes.nudge]\non = "right"\nforce = ["30 N", 0, 0]\n'
    scene = load_scene(write_bench(tmp_path, BENCH + push))
    pushed = revise(scene, "effects.push", {})
    piece = removed(piece_of(scene), 1)
    after = restated(piece, scene, pushed)
    assert [(load.plank, load.force) for load in after.pushes] == [(1, (30.0, 0.0, 0.0))]
    assert restated(after, pushed, scene).pushes == ()
    assert restated(removed(after, 1), pushed, revise(pushed, "floor.friction", 0.4)).pushes == ()


def test_the_reach_of_joints_goes_into_the_piece(tmp_path):
    scene = load_scene(write_bench(tmp_path, BENCH + '[joints]\nreach = "25 mm"\n'))
    piece = piece_of(scene)
    assert piece.reach == 0.025
    assert restated(piece, scene, revise(scene, "joints.reach", "30 mm")).reach == 0.03


def test_supports_of_others_are_refused_with_what_to_do(tmp_path):
    with pytest.raises(UserError, match="knows no direction 'x'") as caught:
        load_scene(write_bench(tmp_path, BENCH + '[supports.wall]\non = "left"\nfix = ["x"]\n'))
    assert caught.value.do.startswith("leave it out, or use app = ")
