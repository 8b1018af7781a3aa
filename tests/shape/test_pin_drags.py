"""Pins of cloth and bodies under a hand in space: where they go, what is kept, what is refused, what cloth does."""

import json

import numpy as np
import pytest
from cloths import BALL, CLOTH, CONTACT, PIN
from shape_scenes import scene_and_script
from small_scenes import make_replay

from restshape.cli.main import main
from restshape.errors import UserError
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene
from restshape.shape.hand.pin_drag import place_of_pin
from restshape.shape.session import EditSession

LIFT = """
[supports.lift]
on = "c"
fix = { x = 0, z = "0.2*x + 1 cm" }
"""
LEFT = """
[supports.left]
on = "d"
fix = { x = 0, y = "2 cm", z = 0 }
"""
MIRROR = """
[supports.mirror]
on = "bottom"
symmetry = "y"
"""
CLAMP = """
[supports.clamp]
on = "right"
fix = { x = 0, y = 0, z = 0, slope = 0 }
"""
START = """
[start]
turn = ["90 deg", 0, 0]
about = [0, 1, 0]
move = [0, 0, 2]
"""


def session_of(folder, *events, text=CLOTH + PIN + LIFT + LEFT + BALL + CONTACT):
    return EditSession(*scene_and_script(folder, list(events), text))


def frames_of(folder, *events, text=CLOTH + PIN + LIFT + LEFT + BALL + CONTACT):
    return list(session_of(folder, *events, text=text).frames())


def fix(frame, name):
    return {axis: getattr(value, "text", value) for axis, value in frame.scene.supports[name].fix.items()}


def test_a_pin_goes_the_way_of_the_hand_in_space(tmp_path):
    press = {"do": "press", "on": "pin", "at": [0, 0, 0]}
    path = {"do": "drag", "path": [[0.1, 0, 0.3], [0.1, 0.2], [0.4, 0.2, -0.1]]}
    frames = frames_of(tmp_path, press, path, {"do": "release"}, {"do": "undo"}, {"do": "redo"})
    assert [frame.change for frame in frames] == ["start", "none", *["values"] * 3, "none", "values", "values"]
    places = [list(fix(frame, "pin").values()) for frame in frames]
    # Without a height the hand keeps its own.
    expected = [[0, 0, 0]] * 2 + [[0.1, 0, 0.3], [0.1, 0.2, 0.3], *[[0.4, 0.2, -0.1]] * 2, [0, 0, 0], [0.4, 0.2, -0.1]]
    np.testing.assert_allclose(places, expected, atol=1e-15)
    assert all(frame.refused is None and frame.outline is frames[0].outline for frame in frames)
    assert frames[3].hand == ("pin", (0.1, 0.2))


def test_a_drag_in_many_frames_goes_evenly(tmp_path):
    drag = {"do": "drag", "to": [0.2, 0, 0.4], "frames": 4}
    frames = frames_of(tmp_path, {"do": "press", "on": "pin", "at": [0, 0]}, drag, {"do": "release"})
    heights = [fix(frame, "pin")["z"] for frame in frames[2:6]]
    np.testing.assert_allclose(heights, [0.1, 0.2, 0.3, 0.4], rtol=1e-12)


def test_a_formula_and_a_slope_are_kept(tmp_path):
    text = CLOTH + PIN + LIFT + CLAMP
    hold = [{"do": "press", "on": "lift", "at": [1, 1, 0]}, {"do": "drag", "to": [1, 1, 0.5]}, {"do": "release"}]
    hold += [{"do": "press", "on": "clamp", "at": [1, 1, 0]}, {"do": "drag", "to": [0.9, 1, 0.5]}]
    frames = frames_of(tmp_path, *hold, text=text)
    assert fix(frames[2], "lift") == {"x": 0.0, "z": "(0.2*x + 1 cm) + (0.5)"}
    assert frames[2].scene.supports["lift"].fix["z"].evaluate(1.0, 1.0, {}) == pytest.approx(0.71)
    assert fix(frames[5], "clamp") == pytest.approx({"x": -0.1, "y": 0.0, "z": 0.5, "slope": 0.0})


def test_a_name_that_an_edge_has_too_means_the_edge(tmp_path):
    events = [{"do": "press", "on": "left", "at": [0, 0.5]}, {"do": "drag", "to": [-0.1, 0.5]}, {"do": "release"}]
    on_edge = frames_of(tmp_path, *events)[2]
    assert on_edge.change == "move" and fix(on_edge, "left")["x"] == 0.0
    events = [{**event, **({"on": "supports.left"} if "on" in event else {})} for event in events]
    on_pin = frames_of(tmp_path, *events)[2]
    assert on_pin.change == "values" and fix(on_pin, "left") == pytest.approx({"x": -0.1, "y": 0.02, "z": 0.0})


@pytest.mark.parametrize(
    ("on", "to", "why"),
    [
        ("lift", [1.0, 1.2, 0.0], "along y (drag it along x, z"),
        ("supports.none", [0.0, 0.0, 1.0], "no entity named 'supports.none'"),
        ("a", [0.0, 0.0], None),
    ],
)
def test_what_cannot_be_dragged_so_is_refused(tmp_path, on, to, why):
    hold = {"do": "press", "on": on, **({"at": [1, 1, 0]} if on == "lift" else {})}
    frames = frames_of(tmp_path, hold, {"do": "drag", "to": to, "frames": 2})
    refused = [frame.refused for frame in frames[1:] if frame.refused]
    assert (why is None and not refused) or (refused and why in refused[0])
    assert fix(frames[-1], "lift") == {"x": 0.0, "z": "0.2*x + 1 cm"}


def test_a_plane_of_symmetry_cannot_be_held(tmp_path):
    frames = frames_of(tmp_path, {"do": "press", "on": "mirror"}, text=CLOTH + LEFT + MIRROR)
    assert "plane of symmetry, which no hand moves" in frames[1].refused


def test_a_part_of_the_pattern_stays_in_its_plane(tmp_path):
    """Its name is also that of a pin, so that a script may give heights, and the message names it."""
    events = [{"do": "press", "on": "left", "at": [0, 0.5]}, {"do": "drag", "path": [[0, 0.5], [0.1, 0.5, 0.2]]}]
    frames = frames_of(tmp_path, *events)
    assert all("press on supports.left, which moves in space, or leave z out" in frame.refused for frame in frames[2:])
    events[0]["on"] = "supports.left"
    assert not any(frame.refused for frame in frames_of(tmp_path, *events))
    events[0]["on"] = "c"
    with pytest.raises(UserError, match="c is no body and no support in space") as refused:
        frames_of(tmp_path, *events)
    assert refused.value.do == "leave out z, or press on one of: supports.left, supports.lift, supports.pin"
    assert [frame.change for frame in frames[2:]] == ["none"] * 2
    assert all("is a part of the shape, which has no z" in frame.refused for frame in frames[2:])


@pytest.mark.parametrize("key", ["supports.tie", "supports"])
def test_a_support_that_an_edit_has_added_is_held_by_its_name(tmp_path, key):
    tie = {"on": "c", "fix": ["x", "y", "z"]}
    add = {"do": "set", "key": key, "value": tie if key == "supports.tie" else {"tie": tie}}
    hold = [{"do": "press", "on": "tie"}, {"do": "drag", "path": [[1.0, 0.9, 0.2]]}]
    frames = frames_of(tmp_path, add, *hold)
    assert not any(frame.refused for frame in frames) and fix(frames[-1], "tie")["z"] == pytest.approx(0.2)
    with pytest.raises(UserError, match="tie is no body and no support in space"):
        frames_of(tmp_path, *hold)


def test_a_pin_that_is_gone_refuses_the_hand(tmp_path):
    without = {"do": "set", "key": "supports", "value": {"lift": {"on": "c", "fix": ["x", "z"]}}}
    frames = frames_of(tmp_path, {"do": "press", "on": "pin"}, without, {"do": "drag", "to": [0, 0, 1]})
    assert "'pin' is there no more" in frames[-1].refused


def test_a_frame_without_a_solution_is_taken_back(tmp_path):
    press = {"do": "press", "on": "pin", "at": [0, 0, 0]}
    session = session_of(tmp_path, press, {"do": "drag", "path": [[0, 0, 0.1], [0, 0, 0.2], [0, 0, 0.4]]})
    heights = []
    for frame in session.frames():
        if frame.index == 3:
            session.rollback()
        heights.append(session.scene.supports["pin"].fix["z"])
    np.testing.assert_allclose(heights, [0, 0, 0.1, 0.1, 0.4], atol=1e-15)


def test_a_pin_is_where_its_cloth_starts_and_its_displacement(tmp_path):
    """A quarter turn about x through (0, 1, 0) takes (x, y, 0) to (x, 1, y - 1)."""
    session = session_of(tmp_path, text=CLOTH + LEFT + LIFT + CLAMP + START)
    places = {name: place_of_pin(session.scene, session.outline, name) for name in ("left", "lift", "clamp")}
    np.testing.assert_allclose(places["left"], [0, 1.02, 2], atol=1e-12)
    np.testing.assert_allclose(places["lift"], [1, 1, 2.21], atol=1e-12)
    np.testing.assert_allclose(places["clamp"], [1, 1, 1.5], atol=1e-12)


def test_a_body_is_lifted_by_the_hand(tmp_path):
    press = {"do": "press", "on": "ball", "at": [0.5, 0.5]}
    frames = frames_of(tmp_path, press, {"do": "drag", "to": [0.6, 0.5, 0.2]}, {"do": "release"})
    ball = frames[-1].scene.bodies["ball"].evaluated(frames[-1].scene.parameters)
    np.testing.assert_allclose(ball.form.center, [0.6, 0.5, 0.2], atol=1e-15)


def test_lines_of_text_drag_pins_in_space(tmp_path):
    path, out = tmp_path / "cloth.toml", tmp_path / "edits.jsonl"
    path.write_text(CLOTH + PIN + BALL + CONTACT)
    lines = ["support pin by 0 10 cm 0.3 in 6 frames, hand-like", "body ball by 0 0 -5 cm in 2 frames"]
    assert main(["script", str(path), *lines, "--out", str(out)]) == 0
    scene = load_scene(path)
    last = list(EditSession(scene, load_script(out, scene)).frames())[-1].scene
    assert last.supports["pin"].fix == pytest.approx({"x": 0.0, "y": 0.1, "z": 0.3}, abs=1e-12)
    assert last.bodies["ball"].evaluated(last.parameters).form.center[2] == pytest.approx(-0.35)
    assert main(["script", str(path), "edge left by 0 0 1 in 2 frames"]) == 2


@pytest.mark.slow
def test_cloth_follows_a_dragged_pin_as_it_follows_a_set_one(tmp_path):
    """Bit for bit, with the pinned corner where the hand is."""
    other = PIN.replace("supports.pin", "supports.other").replace('"a"', '"d"')
    quantities = "[quantities]\n" + "".join(f'{axis} = {{ position = "{axis}", at = "a" }}\n' for axis in "xyz")
    text = CLOTH + PIN + other + quantities + 'low = { position = "z", reduce = "min" }\n'
    header = {"format": "restshape-edits", "version": 1, "scene": "cloth.toml"}
    dragged = [{"do": "press", "on": "pin", "at": [0, 0, 0]}, {"do": "drag", "to": [0.1, 0.2, 0.25], "frames": 2}]
    ways = [{"x": 0.05, "y": 0.1, "z": 0.125}, {"x": 0.1, "y": 0.2, "z": 0.25}]
    given = [{"do": "idle"}, *({"do": "set", "key": "supports.pin.fix", "value": way} for way in ways)]
    (tmp_path / "cloth.toml").write_text(text)
    found = []
    for name, events in (("dragged", dragged), ("given", given)):
        lines = [header, *({"t": 0.1 * k, **event} for k, event in enumerate(events))]
        (tmp_path / name).write_text("\n".join(map(json.dumps, lines)) + "\n")
        rows = list(make_replay(tmp_path / "cloth.toml", tmp_path / name).frames())
        found.append([[row[f"q_{key}"] for key in ("x", "y", "z", "low")] for row in rows])
        assert all(row["converged"] for row in rows)
    np.testing.assert_array_equal(*found)
    np.testing.assert_allclose(np.array(found[0])[-1, :3], [0.1, 0.2, 0.25], atol=1e-15)
    # The lowest place is below both pins, by a cloth that has not stretched by half of its length.
    assert -1.0 < found[0][-1][3] < 0.0
