"""Bodies under the hand, and values that change evenly over frames: places, sizes, undo and redo, refusals."""

import numpy as np
import pytest
from cloths import BALL, CLOTH, CONTACT, PIN
from shape_scenes import scene_and_script

from restshape.shape.session import EditSession

BOX = """
[bodies.box]
box = { center = [1, 0, -1], half = [0.1, 0.2, 0.3], rotate = [0, 0, "10 deg"], radius = 0.01 }
"""
FLOOR = """
[bodies.floor]
plane = { point = [1, 0, -2], normal = [1, 0, 1] }
"""
BAR = """
[bodies.bar]
capsule = { start = [-1, 0, 0], end = [1, 0, 2], radius = 0.1 }
"""
DRUM = """
[bodies.drum]
cylinder = { start = [0, 0, -3], end = [2, 0, -3], radius = 0.2, rounded = 0.02 }
"""
LIFT = """
[supports.lift]
on = "c"
fix = { x = 0, z = "1 cm" }
"""


def frames_of(folder, *events):
    text = CLOTH + PIN + BALL + CONTACT + BOX + FLOOR + BAR + DRUM + LIFT
    session = EditSession(*scene_and_script(folder, list(events), text))
    return list(session.frames())


def form(frame, name):
    return frame.scene.bodies[name].evaluated(frame.scene.parameters).form


def test_a_drag_moves_a_body_by_the_way_of_the_hand(tmp_path):
    press = {"do": "press", "on": "ball", "at": [0.4, 0.4]}
    frames = frames_of(tmp_path, press, {"do": "drag", "to": [0.7, 0.3], "frames": 4}, {"do": "release"})
    assert [f.change for f in frames] == ["start", "none", *["values"] * 4, "none"]
    np.testing.assert_allclose(form(frames[3], "ball").center, [0.5 + 0.15, 0.5 - 0.05, -0.3], atol=1e-15)
    np.testing.assert_allclose(form(frames[-1], "ball").center, [0.8, 0.4, -0.3], atol=1e-15)
    assert form(frames[-1], "ball").radius == 0.25
    assert all(f.gesture is None and f.refused is None and f.outline is frames[0].outline for f in frames)
    assert [f.edit_ended for f in frames] == [False, True, False, False, False, False, True]


def test_a_hand_without_a_point_takes_the_body_at_its_own_place(tmp_path):
    drag = {"do": "drag", "to": [0.5, 0.5]}
    frames = frames_of(tmp_path, {"do": "press", "on": "bar"}, drag, {"do": "release"})
    bar = form(frames[-1], "bar")
    np.testing.assert_allclose([bar.start, bar.end], [[-0.5, 0.5, 0], [1.5, 0.5, 2]], atol=1e-15)


def test_values_set_while_a_body_is_held_stay(tmp_path):
    frames = frames_of(
        tmp_path,
        {"do": "press", "on": "ball", "at": [0.5, 0.5]},
        {"do": "drag", "to": [0.6, 0.5]},
        {"do": "set", "key": "bodies.ball.sphere.radius", "value": 0.1},
        {"do": "drag", "to": [0.7, 0.5]},
        {"do": "release"},
        {"do": "undo"},
    )
    assert form(frames[5], "ball").radius == 0.1 and form(frames[5], "ball").center[0] == pytest.approx(0.7)
    assert frames[-1].change == "values" and frames[-1].scene is frames[0].scene


def test_bodies_turn_about_the_vertical(tmp_path):
    turn = {"do": "rotate", "by": "90 deg", "frames": 3}
    frames = frames_of(
        tmp_path,
        {**turn, "on": "box"},
        {**turn, "on": "floor", "about": [0, 0]},
        {**turn, "on": "bar"},
        {**turn, "on": "ball", "about": [0, 0]},
    )
    last = frames[-1]
    box, floor, bar = (form(last, name) for name in ("box", "floor", "bar"))
    np.testing.assert_allclose(box.rotate, [0, 0, np.radians(100)], atol=1e-15)
    np.testing.assert_allclose([box.center, box.half], [[1, 0, -1], [0.1, 0.2, 0.3]], atol=1e-15)
    np.testing.assert_allclose([floor.point, floor.normal], [[0, 1, -2], [0, 1, 1]], atol=1e-15)
    np.testing.assert_allclose([bar.start, bar.end], [[0, -1, 0], [0, 1, 2]], atol=1e-15)
    np.testing.assert_allclose(form(last, "ball").center, [-0.5, 0.5, -0.3], atol=1e-15)
    third = form(frames[2], "box").rotate[2]
    assert third == pytest.approx(np.radians(10 + 60), rel=1e-14)


def test_bodies_grow_about_their_own_centre_or_a_point(tmp_path):
    frames = frames_of(
        tmp_path,
        {"do": "scale", "on": "ball", "factor": 2, "frames": 2},
        {"do": "scale", "on": "box", "factor": 3, "about": [0, 0]},
        {"do": "scale", "on": "bar", "factor": 0.5},
        {"do": "scale", "on": "floor", "factor": 2},
    )
    assert form(frames[1], "ball").radius == pytest.approx(0.375, rel=1e-15)
    ball, box, bar = (form(frames[-1], name) for name in ("ball", "box", "bar"))
    assert ball.radius == 0.5 and ball.center == (0.5, 0.5, -0.3)
    np.testing.assert_allclose([box.center, box.half], [[3, 0, -1], [0.3, 0.6, 0.9]], atol=1e-15)
    assert box.radius == pytest.approx(0.03)
    np.testing.assert_allclose([bar.start, bar.end], [[-0.5, 0, 0.5], [0.5, 0, 1.5]], atol=1e-15)
    assert frames[-1].change == "none" and "a plane has no size" in frames[-1].refused


def test_numbers_change_evenly_and_end_exactly(tmp_path):
    frames = frames_of(
        tmp_path,
        {"do": "set", "key": "bodies.ball.sphere.radius", "value": "7 cm", "frames": 6},
        {"do": "set", "key": "supports.lift.fix.z", "value": "0.2 m", "frames": 5},
        {"do": "set", "key": "effects.gravity.g", "value": [0, 1, -1.62], "frames": 3},
        {"do": "set", "key": "parameters.half", "value": 0.6, "frames": 2},
    )
    assert {f.change for f in frames[1:]} == {"values"}
    radii = [form(f, "ball").radius for f in frames[:7]]
    np.testing.assert_allclose(np.diff(radii), (0.07 - 0.25) / 6, rtol=1e-12)
    assert radii[-1] == 0.07
    lifts = [f.scene.supports["lift"].fix["z"] for f in frames[6:12]]
    np.testing.assert_allclose(lifts, np.linspace(0.01, 0.2, 6), rtol=1e-12)
    assert lifts[-1] == 0.2 and frames[-1].scene.effects["gravity"]["g"] == [0.0, 1.0, -1.62]
    assert form(frames[-2], "ball").center[1] == pytest.approx(0.55)


def test_a_sweep_is_undone_and_redone_at_once(tmp_path):
    sweep = {"do": "set", "key": "bodies.ball.sphere.radius", "value": 0.1, "frames": 5}
    scale = {"do": "scale", "on": "box", "factor": 2, "frames": 3}
    frames = frames_of(tmp_path, sweep, scale, {"do": "undo"}, {"do": "undo"}, {"do": "redo"}, {"do": "redo"})
    assert [f.change for f in frames[-4:]] == ["values"] * 4
    scenes = [f.scene for f in (frames[5], frames[0], frames[5], frames[8])]
    assert all(f.scene is scene for f, scene in zip(frames[-4:], scenes))


def test_a_cylinder_is_moved_turned_and_scaled(tmp_path):
    turn = {"do": "rotate", "on": "drum", "by": "90 deg"}
    hold = [{"do": "press", "on": "drum"}, {"do": "drag", "to": [1, 1, -2]}, {"do": "release"}]
    frames = frames_of(tmp_path, turn, {"do": "scale", "on": "drum", "factor": 2}, *hold)
    turned, grown, moved = (form(frame, "drum") for frame in (frames[1], frames[2], frames[-1]))
    np.testing.assert_allclose([turned.start, turned.end], [[1, -1, -3], [1, 1, -3]], atol=1e-15)
    np.testing.assert_allclose([grown.start, grown.end], [[1, -2, -3], [1, 2, -3]], atol=1e-15)
    assert (grown.radius, grown.rounded) == (0.4, 0.04)
    np.testing.assert_allclose([moved.start, moved.end], [[1, -1, -2], [1, 3, -2]], atol=1e-15)


@pytest.mark.parametrize(
    ("on", "about", "refused"),
    [
        ("ball", None, True),
        ("ball", [0, 0], False),
        ("drum", None, False),
        ("bar", None, False),
        ("floor", None, False),
    ],
)
def test_a_turn_that_changes_nothing_is_refused(tmp_path, on, about, refused):
    """A ball is round about its own vertical axis: it would take no cloth along. There is nothing to undo then."""
    turn = {"do": "rotate", "on": on, "by": "40 deg", **({"about": about} if about else {})}
    frames = frames_of(tmp_path, turn, {"do": "undo"})
    assert [bool(frame.refused) for frame in frames] == [False, refused, refused]
    assert not refused or "a sphere that turns about its own vertical axis stays as it is" in frames[1].refused


@pytest.mark.parametrize(("on", "about"), [("bar", None), ("ball", [0, 0])])
def test_a_body_may_turn_by_whole_turns(tmp_path, on, about):
    turn = {"do": "rotate", "on": on, "by": "720 deg", "frames": 4, **({"about": about} if about else {})}
    frames = frames_of(tmp_path, turn)
    assert not any(frame.refused for frame in frames)
    first, once = (form(frames[k], on) for k in (0, 2))
    key = "start" if on == "bar" else "center"
    np.testing.assert_allclose(getattr(once, key), getattr(first, key), atol=1e-15)


@pytest.mark.parametrize("name", ["drum", "second"])
def test_a_body_that_the_first_frame_has_not_is_refused(tmp_path, name):
    box = {"box": {"center": [1, 0, -1], "half": [0.1, 0.2, 0.3]}}
    *_, last = frames_of(tmp_path, {"do": "set", "key": f"bodies.{name}", "value": box})
    assert last.refused.startswith(f"bodies.{name}: a replay has the bodies of its first frame, and of the same kinds")


def test_a_turn_of_an_upright_post_is_refused(tmp_path):
    text = CLOTH + PIN + CONTACT + "[bodies.post]\ncapsule = { start = [1, 2, 0], end = [1, 2, 3], radius = 0.1 }\n"
    turn = {"do": "rotate", "on": "post", "by": "40 deg"}
    *_, last = EditSession(*scene_and_script(tmp_path, [turn], text)).frames()
    assert "a capsule that turns" in last.refused


def test_a_turn_of_a_level_half_space_is_refused(tmp_path):
    text = CLOTH + PIN + CONTACT + FLOOR.replace("normal = [1, 0, 1]", "normal = [0, 0, 1]")
    *_, last = EditSession(
        *scene_and_script(tmp_path, [{"do": "rotate", "on": "floor", "by": "40 deg"}], text)
    ).frames()
    assert "a plane that turns" in last.refused


@pytest.mark.parametrize(
    ("key", "value", "what"),
    [
        ("material.cotton.E", "soft", "not a number"),
        ("bodies.ball.sphere.center", [0, 0, 0], "given by the formula"),
        ("supports.pin.on", "b", "no number that could change evenly"),
        ("material.cotton.bending", "1e-5 N m", "no number that could change evenly"),
        ("bodies.ball.sphere.radius", "half", "no number that could change evenly"),
        ("effects.drape.steps", 20, "no number that could change evenly"),
        ("bodies.bal.friction", 0.1, "there is no bodies.bal"),
        ("title", "other", "no number"),
        ("shape.vertices.a", [0.1, 0], "cannot be set during an edit"),
    ],
)
def test_what_cannot_change_evenly_is_refused_in_all_frames(tmp_path, key, value, what):
    frames = frames_of(tmp_path, {"do": "set", "key": key, "value": value, "frames": 3})
    assert [f.change for f in frames[1:]] == ["none"] * 3
    assert all(what in f.refused for f in frames[1:])


def test_frames_that_make_no_sense_are_refused_one_by_one(tmp_path):
    sweep = {"do": "set", "key": "material.cotton.nu", "value": 0.49, "frames": 2}
    frames = frames_of(
        tmp_path, sweep, {"do": "set", "key": "bodies.box.box.half", "value": [0.1, 0.2, 0.005], "frames": 2}
    )
    assert [f.refused is None for f in frames] == [True, True, True, False, False]
    assert "radius of the box's edges" in frames[-1].refused


def test_a_frame_without_a_solution_is_taken_back(tmp_path):
    events = [
        {"do": "press", "on": "ball", "at": [0.5, 0.5]},
        {"do": "drag", "path": [[0.6, 0.5], [0.7, 0.5], [0.8, 0.5]]},
        {"do": "release"},
    ]
    session = EditSession(*scene_and_script(tmp_path, events, CLOTH + PIN + BALL + CONTACT))
    centres = []
    for frame in session.frames():
        if frame.index == 3:
            session.rollback()
        centres.append(session.scene.bodies["ball"].evaluated(session.scene.parameters).form.center[0])
    np.testing.assert_allclose(centres, [0.5, 0.5, 0.6, 0.6, 0.8, 0.8], atol=1e-15)


def test_what_is_no_part_of_the_shape_says_what_may_be_meant(tmp_path):
    on = {"on": "bal"}
    frames = frames_of(
        tmp_path, {"do": "press", **on}, {"do": "release"}, {"do": "rotate", "by": 1, **on}, {"do": "delete", **on}
    )
    refused = [frame.refused for frame in frames[1:]]
    assert ["'ball'" in why for why in refused] == [True, False, True, False]
    assert all("no entity named 'bal'" in refused[i] for i in (0, 2, 3))


@pytest.mark.parametrize(
    ("event", "frames"),
    [
        ({"do": "delete"}, 1),
        ({"do": "pull"}, 1),
        ({"do": "insert", "s": 0.5, "name": "m"}, 1),
        ({"do": "arc", "bulge": 0.1, "frames": 3}, 3),
        ({"do": "smooth", "frames": 2}, 2),
    ],
)
def test_a_body_is_no_curve(tmp_path, event, frames):
    found = frames_of(tmp_path, {"on": "ball", **event})[1:]
    assert len(found) == frames
    for frame in found:
        assert "ball is a body" in frame.refused and event["do"] in frame.refused and "rotated" in frame.refused


def test_a_pin_is_pulled_by_a_whole_table_of_supports(tmp_path):
    stay = {"do": "set", "key": "supports", "value": {"lift": {"on": "c", "fix": ["z"]}}}
    frames = frames_of(tmp_path, stay, {"do": "undo"})
    assert [list(frame.scene.supports) for frame in frames] == [["pin", "lift"], ["lift"], ["pin", "lift"]]
    assert [frame.change for frame in frames] == ["start", "values", "values"]
