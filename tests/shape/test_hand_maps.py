"""What a press takes hold of along a direction, as another one, and in a mirror (figure 5.8 of the thesis)."""

import math

import numpy as np
import pytest
from cloths import BALL, CLOTH, CONTACT, PIN
from shape_scenes import scene_and_script, shape
from small_scenes import CURVED

from restshape.errors import UserError
from restshape.shape.hand import gesture as movements
from restshape.shape.session import EditSession
from restshape.shape.validity import MotionCheck

DART = {"a": [0, 0], "l": [0.4, 0], "tip": [0.5, 0.4], "r": [0.6, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1]}
MIDDLE = [[0.5, 0.0], [0.5, 2.0]]


def dart():
    """A square with a dart from below, symmetric about x = 0.5."""
    names = list(DART)
    edges = {f"e{i}": {"line": [names[i], names[(i + 1) % 7]]} for i in range(7)}
    return shape(vertices=DART, edges=edges, outline=list(edges))


def grabbed(outline, name, tensor=None, mirror=None):
    line = None if mirror is None else np.array(mirror)
    return movements.drag(outline, outline.entity(name), tensor, line)


def points_of(gesture, c, outline):
    return dict(zip(outline.vertex_names, gesture.points(c)))


def frames_of(folder, *events, text=CURVED):
    return list(EditSession(*scene_and_script(folder, list(events), text)).frames())


@pytest.mark.parametrize("along", [[1, 0], [3, 4], [-0.6, 0.8], [1e-200, -1e-200], [0, 1e50]])
def test_what_goes_along_a_direction_is_the_shadow_of_the_hand(tmp_path, along):
    way, e = np.array([0.11, -0.07]), np.array(along) / max(map(abs, along))
    e /= np.hypot(*e)
    press = {"do": "press", "on": "window", "at": [0.5, 0.5]}
    drag, release = {"do": "drag", "to": [0.5 + way[0], 0.5 + way[1]]}, {"do": "release"}
    *_, shadow, _ = frames_of(tmp_path, {**press, "along": along}, drag, release)
    *_, plain, _ = frames_of(tmp_path, press, {**drag, "to": (0.5 + e * (e @ way)).tolist()}, release)
    assert shadow.refused is None and shadow.change == "move"
    np.testing.assert_allclose(shadow.outline.points, plain.outline.points, rtol=0, atol=1e-15)
    assert shadow.gesture.linear


def test_what_goes_along_one_direction_as_the_hand_goes_along_another(tmp_path):
    events = [
        {"do": "press", "on": "window", "at": [0.5, 0.5], "along": [0, 2], "as": [1, 1]},
        {"do": "drag", "path": [[0.6, 0.5], [0.6, 0.4]]},
    ]
    start, _, across, back = frames_of(tmp_path, *events)
    moved = across.outline.points - start.outline.points
    window = start.outline.control_points(start.outline.entity("window"))
    np.testing.assert_allclose(moved[window], np.tile([0.0, 0.1 / math.sqrt(2.0)], (len(window), 1)), atol=1e-15)
    # Across the direction that counts the hand moves nothing.
    np.testing.assert_allclose(back.outline.points, start.outline.points, atol=1e-16)


def test_a_dart_opens_to_both_sides():
    outline, e = dart(), np.outer([1.0, 0.0], [1.0, 0.0])
    gesture = grabbed(outline, "l", e, MIDDLE)
    moved = points_of(gesture, (-0.1, 0.3), outline)
    for name, place in {**DART, "l": [0.3, 0], "r": [0.7, 0]}.items():
        np.testing.assert_allclose(moved[name], place, atol=1e-15)
    assert gesture.whole.tolist() == [name == "l" for name in DART]


@pytest.mark.parametrize("line", [MIDDLE, [[0.5, 7.0], [0.5, -1.0]]])
@pytest.mark.parametrize("name", ["l", "tip", "e0", "e1", "e2", "e5", "all"])
def test_a_shape_stays_its_own_mirror_image(line, name):
    outline = dart()
    rng = np.random.default_rng(3)
    tensor, c = rng.normal(size=(2, 2)), tuple(rng.normal(size=2))
    moved = points_of(grabbed(outline, name, tensor, line), c, outline)
    image = {"a": "b", "l": "r", "tip": "tip", "d": "c"}
    for one, other in image.items():
        np.testing.assert_allclose(moved[one] * [-1, 1] + [1, 0], moved[other], atol=1e-14)
    if name in ("l", "e0"):
        # What has no image that is held goes by its tensor.
        np.testing.assert_allclose(moved["l"], DART["l"] + tensor @ c, atol=1e-15)


def test_a_tip_on_the_line_goes_along_it():
    outline = dart()
    moved = points_of(grabbed(outline, "tip", mirror=MIDDLE), (0.2, 0.1), outline)
    np.testing.assert_allclose(moved["tip"], [0.5, 0.5], atol=1e-15)


def test_sides_of_a_dart_that_would_meet_are_refused():
    outline = dart()
    gesture = grabbed(outline, "l", np.outer([1.0, 0.0], [1.0, 0.0]), MIDDLE)
    check = MotionCheck(outline, gesture)
    found = [check.problem((way, 0.0)) for way in (-0.38, -0.1, 0.0, 0.08, 0.095, 0.11, 0.3)]
    assert [one is None for one in found] == [True, True, True, True, True, False, False]


def test_what_has_no_mirror_image_is_named():
    with pytest.raises(UserError, match=r"vertex l has no mirror image: no control point is at \(0.62, 0\)"):
        grabbed(dart(), "l", mirror=[[0.51, 0.0], [0.51, 1.0]])
    with np.errstate(all="ignore"), pytest.raises(UserError, match="vertex l has no mirror image"):
        grabbed(dart(), "l", mirror=[[-1e308, 0.0], [1e308, 1.0]])


def test_a_press_with_a_mirror_is_refused_where_the_shape_has_no_image(tmp_path):
    press = {"do": "press", "on": "window", "at": [0.5, 0.5], "mirror": [[0.9, 0], [0.9, 1]]}
    _, press, drag = frames_of(tmp_path, press, {"do": "drag", "to": [0.6, 0.5]})
    assert "has no mirror image" in press.refused and drag.refused == "nothing is grabbed"


@pytest.mark.parametrize("on", ["ball", "pin", "supports.pin"])
@pytest.mark.parametrize("more", [{"along": [1, 0]}, {"mirror": [[0, 0], [0, 1]]}])
def test_what_is_held_in_space_takes_no_map(tmp_path, on, more):
    text = "\n".join([CLOTH, CONTACT, BALL, PIN])
    _, press, drag = frames_of(tmp_path, {"do": "press", "on": on, **more}, {"do": "drag", "to": [0, 0]}, text=text)
    word = next(iter(more))
    assert press.refused.startswith(f"{on} is held in space, where all goes as the hand: it takes no {word}")
    assert drag.refused == "nothing is grabbed"
