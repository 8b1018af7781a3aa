"""Edits of what a piece is made of: units, planks as scenes have them, what goes with what, keys of drawn planks."""

import json
import warnings

import numpy as np
import pytest
from furniture_scenes import BENCH, write_bench, write_edits
from restshape_apps.furniture.physics.furniture import APART
from restshape_apps.furniture.pieces import SCENES
from restshape_apps.furniture.session.plank_language import PlankInterpreter
from restshape_apps.furniture.session.plank_session import PlankSession
from restshape_apps.furniture.shape.plank_scene import piece_of

from restshape.errors import UserError
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.shape.script_language import interpreted

SHELF = {"do": "plank", "name": "shelf", "from": [-0.49, 0, 0.2], "to": [0.49, 0, 0.2], "width": [0, 0.2, 0]}
SAME = "from = [-0.49, 0, 0.2]\nto = [0.49, 0, 0.2]\nwidth = [0, 0.2, 0]\n"
PUSH = '[pushes.wind]\non = "top"\nforce = [5, 0, 0]\n[effects.push]\n'


@pytest.fixture
def play(tmp_path):
    """Frames of events on the bench."""

    def played(*events, text=BENCH, **header):
        scene = load_scene(write_bench(tmp_path, text))
        return list(PlankSession(scene, load_script(write_edits(tmp_path, *events, **header), scene)).frames())

    return played


def plank(frame, name):
    """A plank as a frame shows it."""
    return next(one for one in frame.design.furniture.moved(frame.gamma).planks if one.name == name)


def drag(parameter, by, on="top"):
    return {"do": "press", "on": on, "parameter": parameter}, {"do": "drag", "by": by}


@pytest.mark.parametrize(
    ("by", "units", "way"), [(50, "mm", 0.05), (5, "cm", 0.05), (0.05, "m", 0.05), ("5 cm", "mm", 0.05)]
)
def test_a_parameter_is_dragged_in_the_units_of_the_header(play, by, units, way):
    frames = play(*drag("length x", by), units=units)
    assert frames[-1].c[0] == pytest.approx(way)
    assert plank(frames[-1], "top").size[0] == pytest.approx(1.2 + way)


@pytest.mark.parametrize(("by", "units"), [(0.1, "mm"), (0.1, "m"), ("5.729577951 deg", "mm")])
def test_a_turn_is_dragged_by_an_angle_whatever_the_units(play, by, units):
    frames = play(*drag("turn z", by), units=units)
    assert plank(frames[-1], "top").axes[1, 0] == pytest.approx(np.sin(0.1))


def test_units_of_the_other_kind_are_refused(play):
    assert play(*drag("turn z", "5 mm"))[-1].refused == "turn z is dragged by an angle, not by a length"
    assert play(*drag("length x", "5 deg"))[-1].refused == "length x is dragged by a length, not by an angle"


def test_turns_too_far_for_their_direction_to_be_known_are_refused(play, tmp_path):
    assert "ten turns" in play(*drag("turn z", 1e9))[-1].refused
    scene = load_scene(write_bench(tmp_path))
    with pytest.raises(UserError, match="ten turns"):
        load_script(write_edits(tmp_path, {"do": "rotate", "on": "top", "by": 1e9, "about": "z"}), scene)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        frames = play({"do": "rotate", "on": "top", "by": 6 * np.pi + 0.1, "about": "z", "frames": 7})
    assert plank(frames[-1], "top").axes[1, 0] == pytest.approx(np.sin(0.1))


def test_a_plank_that_goes_reports_what_goes_with_it(play):
    frames = play({"do": "delete", "on": "top"}, text=BENCH + PUSH)
    assert frames[-1].note == "with top go weight box and push wind"
    assert play({"do": "delete", "on": "left"})[-1].note == ""


def test_what_a_deletion_leaves_apart_is_reported(play):
    result = play({"do": "delete", "on": "top"})[-1].design.furniture.test()
    assert result.flaws == APART and result.words == ("in two parts: left, right",)


def test_a_weight_beside_its_plank_is_refused_with_where_the_plank_is(play):
    frames = play({"do": "weight", "name": "vase", "on": "top", "mass": 3, "at": [0.7, 0, 0.5]})
    assert "is beside top, a plank of (1.2, 0.3, 0.02) m with its middle at (0, 0, 0.51) m" in frames[-1].refused
    assert len(frames[-1].design.piece.weights) == 1
    edge = play({"do": "weight", "name": "vase", "on": "top", "mass": 3, "at": [-0.5, 0.5, 0.5]})
    assert edge[-1].refused is None


@pytest.mark.parametrize("table", ["weights", "pushes"])
def test_scenes_with_a_load_beside_its_plank_are_refused(tmp_path, table):
    text = BENCH + PUSH
    mark = 'mass = "20 kg"\n' if table == "weights" else "force = [5, 0, 0]\n"
    with pytest.raises(UserError, match=rf"{table}\.\w+\.at \(line \d+\): .*is beside the plank top"):
        load_scene(write_bench(tmp_path, text.replace(mark, mark + "at = [0, -0.51, 0]\n")))


def test_a_weight_without_gravity_is_reported_to_weigh_nothing(play):
    silent = BENCH.replace("[effects.gravity]\ng = [0, 0, -10]\n", "")
    put = {"do": "weight", "name": "vase", "on": "top", "mass": 3}
    assert "vase weighs nothing" in play(put, text=silent)[-1].note
    assert play(put)[-1].note == ""


MADE = {"thickness": 15, "wood": "oak", "fastener": "dowel"}


def test_a_drawn_plank_has_what_a_scene_may_say_of_it(play, tmp_path):
    mm = {key: [1e3 * x for x in SHELF[key]] for key in ("from", "to", "width")}
    piece = play(SHELF | mm | MADE, units="mm")[-1].design.piece
    joints = "".join(
        f'[joints.{on}]\nplank = "shelf"\nend = "{end}"\nto = "{on}"\nface = "{face}"\nfastener = "dowel"\n'
        for end, on, face in (("-x", "left", "-z"), ("+x", "right", "+z"))
    )
    drawn = f'[planks.shelf]\n{SAME}thickness = "15 mm"\nwood = "oak"\n{joints}'
    other = piece_of(load_scene(write_bench(tmp_path, BENCH + drawn)))
    assert {(j.i, j.side, j.j, j.face, j.fastener) for j in piece.joints} == {
        (j.i, j.side, j.j, j.face, j.fastener) for j in other.joints
    }
    assert piece.planks[3].wood == other.planks[3].wood == "oak"
    assert piece.planks[3].size == pytest.approx(other.planks[3].size) and piece.planks[3].size[2] == 0.015


def test_a_drawn_plank_is_as_thick_as_the_scene_says_of_all(play):
    thin = BENCH.replace("[planks.left]\n", "[planks.left]\nthickness = 0.03\n")
    thin = thin.replace("[planks.right]\n", "[planks.right]\nthickness = 0.03\n")
    assert play(SHELF, text=thin)[-1].design.piece.planks[3].size[2] == 0.02


def test_an_unknown_fastener_of_an_event_is_refused(play):
    assert "no fastener glue" in play(SHELF | {"fastener": "glue"})[-1].refused
    assert "no wood balsa" in play(SHELF | {"wood": "balsa"})[-1].refused


def set_(key, value, **more):
    return {"do": "set", "key": key, "value": value, **more}


def test_keys_of_a_drawn_plank_are_set_as_those_of_others(play):
    frames = play(
        SHELF, set_("planks.shelf.thickness", "30 mm", frames=2), set_("planks.shelf.wood", "oak"), {"do": "undo"}
    )
    assert [frame.refused for frame in frames] == [None] * 6
    shelf = [plank(frame, "shelf") for frame in frames[1:]]
    assert [one.size[2] for one in shelf] == pytest.approx([0.02, 0.025, 0.03, 0.03, 0.03])
    assert [one.wood for one in shelf] == ["pine", "pine", "pine", "oak", "pine"]
    assert all(len(frame.design.piece.joints) == 4 for frame in frames[1:])


def test_drawn_lines_of_a_plank_go_to_others_in_even_steps(play):
    frames = play(set_("planks.top.from", [-0.8, 0, 0.51], frames=2), set_("planks.top.width", [0, 0.4, 0], frames=2))
    assert [frame.refused for frame in frames] == [None] * 5
    assert [plank(frame, "top").size[:2].tolist() for frame in frames] == [
        pytest.approx(size) for size in ([1.2, 0.3], [1.3, 0.3], [1.4, 0.3], [1.4, 0.35], [1.4, 0.4])
    ]


def test_a_drawn_plank_that_was_moved_keeps_its_place_when_something_else_of_it_is_set(play):
    move = {"do": "press", "on": "shelf"}, {"do": "drag", "to": [0, 0, 0.3]}, {"do": "release"}
    frames = play(SHELF, *move, set_("planks.shelf.thickness", 0.03))
    assert plank(frames[-1], "shelf").centre == pytest.approx([0, 0, 0.3], abs=1e-9)
    assert plank(frames[-1], "shelf").size[2] == pytest.approx(0.03)


def test_keys_of_a_weight_that_was_put_are_set_too(play):
    put = {"do": "weight", "name": "vase", "on": "top", "mass": 3, "at": [0.25, 0, 0.5]}
    frames = play(SHELF, put, set_("weights.vase.mass", "4 kg"), set_("weights.vase.on", "shelf"))
    loads = [{w.name: w for w in frame.design.piece.weights}["vase"] for frame in frames[2:]]
    assert [load.force[2] for load in loads] == pytest.approx([-30.0, -40.0, -40.0])
    assert [load.plank for load in loads] == [0, 0, 3] and loads[2].place == (0.25, 0.0, 0.5)


def test_keys_of_a_suggested_plank_are_set_too(tmp_path):
    scene = load_scene(SCENES / "table.toml")
    suggestion_list = PlankSession(scene, load_script(write_edits(tmp_path), scene)).design.suggestion_list.found
    number = next(k for k, suggestion in enumerate(suggestion_list, 1) if suggestion.kind == "a support plank")
    events = {"do": "choose", "number": number}, set_("planks.support.thickness", "20 mm")
    frames = list(PlankSession(scene, load_script(write_edits(tmp_path, *events), scene)).frames())
    assert frames[-1].refused is None and plank(frames[-1], "support").size[2] == pytest.approx(0.02)
    assert plank(frames[-1], "top").size[2] == pytest.approx(0.012)


def test_keys_of_what_was_deleted_are_refused(play):
    frames = play(SHELF, {"do": "delete", "on": "left"}, set_("planks.left.thickness", 0.03))
    assert "the plank left was deleted" in frames[-1].refused
    frames = play({"do": "delete", "on": "box"}, set_("weights.box.mass", 3))
    assert "the weight box was deleted" in frames[-1].refused


def test_what_is_near_a_drawn_plank_is_reported(play):
    assert play(SHELF)[-1].note == "joined: shelf on left, shelf on right"
    leg = {"do": "plank", "name": "leg", "from": [0, 0, 0.012], "to": [0, 0, 0.495], "width": [0, 0.2, 0]}
    frames = play(leg)
    assert frames[-1].note == "joined: leg on top, leg on the floor"
    assert plank(frames[-1], "leg").end(0)[2] == pytest.approx(0.0, abs=1e-12)
    far = SHELF | {"from": [-0.2, 3, 1], "to": [0.2, 3, 1]}
    away = play(far)[-1]
    assert "joined to nothing" in away.note
    # From its end at (-0.2, 2.9, 1) to the upper corner of the left leg at (-0.49, 0.15, 0.5).
    gap = (
        f"shelf -x is {1e3 * np.hypot(np.hypot(0.29, 2.75), 0.5):.0f} mm from left, beyond the reach of 15 mm of joints"
    )
    assert away.design.furniture.test().words[0] == f"in two parts: top with 2 more, shelf ({gap})"
    frames = play(far, {"do": "set", "key": "effects.guidance.farthest", "value": 5}, {"do": "choose", "number": 1})
    assert frames[-1].change == "shape" and not frames[-1].design.furniture.test().flaws & APART


def test_lines_of_text_say_all_that_events_may_of_a_plank(tmp_path):
    scene = load_scene(write_bench(tmp_path))
    text = "plank shelf from -49 cm 0 0.2 to 0.49 0 0.2 width 0 0.2 0 thick 15 mm of oak with dowel"
    _, first, second = map(json.loads, interpreted(PlankInterpreter(scene), [text, "connect shelf with nail"]).lines)
    wanted = SHELF | {"thickness": 0.015, "wood": "oak", "fastener": "dowel"}
    assert {key: first[key] for key in wanted} == wanted
    assert (second["do"], second["fastener"]) == ("connect", "nail")


def test_what_cannot_be_deleted_is_reported_with_what_can(play):
    (push, nothing) = play({"do": "delete", "on": "wind"}, {"do": "delete", "on": "hatt"}, text=BENCH + PUSH)[1:]
    assert "'wind' is a push" in push.refused and "pushes.wind.force" in push.refused
    assert "no plank or weight 'hatt'" in nothing.refused
    assert all(name in nothing.refused for name in ("top", "left", "right", "box"))
