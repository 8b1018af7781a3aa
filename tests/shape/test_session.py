"""Sessions: what frames events give, undo and redo, refusals, and shapes that are valid between all events."""

import re
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from plain_check import fault
from restshape_studies.stability.edit_strategies import gestures, single_edits
from shape_scenes import plate, scene_and_script, square
from small_scenes import CURVED

from restshape.scene.edit_script import EVENTS
from restshape.shape.hand import gesture as movements
from restshape.shape.session import EditSession
from restshape.shape.validity import MotionCheck, problem


def frames_of(folder, *events):
    return list(EditSession(*scene_and_script(folder, list(events))).frames())


PRESS = {"do": "press", "on": "window", "at": [0.5, 0.5]}
RELEASE = {"do": "release"}


def test_a_drag_moves_the_hole_with_the_cursor(tmp_path):
    frames = frames_of(tmp_path, PRESS, {"do": "drag", "path": [[0.6, 0.5], [0.7, 0.55]]}, RELEASE)
    assert [(f.do, f.change) for f in frames] == [
        ("start", "start"),
        ("press", "none"),
        ("drag", "move"),
        ("drag", "move"),
        ("release", "none"),
    ]
    assert frames[1].gesture is frames[3].gesture
    centre = frames[3].outline.centroid(frames[3].outline.entity("window"))
    np.testing.assert_allclose(centre, [0.7, 0.55], atol=1e-15)
    np.testing.assert_array_equal(frames[3].outline.points[:4], frames[0].outline.points[:4])
    assert [f.t for f in frames[1:3]] == [0.0, 0.02]
    assert all(earlier.t <= later.t for earlier, later in pairwise(frames))


def test_gestures_are_what_they_say():
    outline = plate()
    turn = movements.rotate(outline, outline.entity("window"), np.array([0.1, 0.2]))
    angle = 0.7
    moved = turn.points((np.cos(angle) - 1.0, np.sin(angle)))
    own = outline.control_points(outline.entity("window"))
    matrix = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    np.testing.assert_allclose(moved[own], (outline.points[own] - [0.1, 0.2]) @ matrix.T + [0.1, 0.2], atol=1e-15)
    grown = movements.scale(outline, outline.entity("window"), np.array([0.5, 0.5])).points((0.5, 0.0))
    assert outline.moved(grown).area() == pytest.approx(outline.area() - np.pi * 0.04 * 1.25, rel=1e-12)


def test_inner_points_follow_one_end_along_the_chord():
    outline = plate()
    moved = movements.drag(outline, outline.entity("c")).points((0.3, 0.0))
    edge = outline.edges[2]
    for p, t in zip(edge.inner, edge.knots[1:-1]):
        np.testing.assert_allclose(moved[p] - outline.points[p], [0.3 * (1.0 - t), 0.0], atol=1e-15)


def test_undo_and_redo_restore_bit_for_bit(tmp_path):
    edits = [
        PRESS,
        {"do": "drag", "path": [[0.6, 0.5], [0.7, 0.5]]},
        RELEASE,
        {"do": "insert", "on": "bottom", "name": "q", "s": 0.3},
        {"do": "rotate", "on": "window", "by": "20 deg", "frames": 2},
        {"do": "set", "key": "material.steel.nu", "value": 0.2},
        {"do": "arc", "on": "left", "bulge": 0.1, "frames": 2},
        {"do": "hole", "name": "new", "center": [1.5, 0.5], "radius": 0.1},
        {"do": "delete", "on": "q"},
    ]
    back = [{"do": "undo"}] * 8 + [{"do": "redo"}] * 8
    frames = frames_of(tmp_path, *edits, *back)
    undone, redone = frames[-17:-8], frames[-8:]
    assert [f.change for f in frames[-16:-8]] == ["shape", "shape", "shape", "values", "move", "shape", "move", "none"]
    assert undone[-1].refused == "there is nothing to undo"
    start, end = frames[0], frames[-17]
    for one, other in ((start, undone[-2]), (end, redone[-2])):
        assert one.outline.points.tobytes() == other.outline.points.tobytes()
        assert one.outline.bulges.tobytes() == other.outline.bulges.tobytes()
        assert one.outline.topology == other.outline.topology
        assert one.scene is other.scene
    assert redone[-1].refused == "there is nothing to redo"


def test_edits_of_one_gesture_are_undone_at_once(tmp_path):
    def scaled(factor, **keys):
        return {"do": "scale", "on": "window", "factor": factor, **keys}

    one, two = ({"gesture": number} for number in (1, 2))
    session = EditSession(*scene_and_script(tmp_path, []))
    start = session.outline
    shapes = []
    for event in (scaled(1.1), scaled(1.1, **one), scaled(50.0, **one), scaled(1.1, **one), scaled(1.1, **two)):
        list(steps_of(session, event))
        shapes.append(session.outline)
    undo, redo = {"do": "undo"}, {"do": "redo"}
    assert shapes[2] is shapes[1], "it is refused, and the gesture goes on"
    for event, shape in zip((undo, undo, redo, undo), (shapes[3], shapes[0], shapes[3], shapes[0])):
        assert [step.refused for step in steps_of(session, event)] == [None]
        assert session.outline is shape
    # What comes after an undo, and what was rolled back, is a gesture of its own.
    for _ in steps_of(session, scaled(1.2, **one)):
        session.rollback()
    list(steps_of(session, scaled(1.2, **one)))
    for shape in (shapes[0], start):
        list(steps_of(session, undo))
        assert session.outline is shape


@pytest.mark.parametrize(
    ("event", "why"),
    [
        ({"do": "hole", "name": "h", "center": [0.5, 0.6], "radius": 0.2}, "cross"),
        ({"do": "hole", "name": "h", "center": [0.5, 0.5], "radius": 0.1}, "inside hole window"),
        ({"do": "hole", "name": "window", "center": [1.5, 0.5], "radius": 0.1}, "in use"),
        ({"do": "hole", "name": "h", "center": [3, 3], "radius": 0.1}, "outside the outline"),
        ({"do": "hole", "name": "h", "center": [1.5, 0.5], "radius": 1e-5}, "collapse"),
        ({"do": "scale", "on": "window", "factor": 4}, "cross"),
        ({"do": "rotate", "on": "window", "by": "180 deg", "about": [0, 0]}, "outside the outline"),
        ({"do": "arc", "on": "bottom", "bulge": -0.6}, "cross"),
        ({"do": "arc", "on": "top", "bulge": 0.1}, "spline"),
        (
            {"do": "delete", "on": "d"},
            r"left is needed by supports.left \(set supports.left.on to another place first\)",
        ),
        ({"do": "insert", "on": "window", "name": "q", "s": 0.5}, "not an edge"),
        ({"do": "insert", "on": "bottom", "name": "q", "at": [-1, 0]}, "end of edge"),
        ({"do": "insert", "on": "bottom", "name": "a", "s": 0.5}, "in use"),
        ({"do": "set", "key": "shape.vertices.a", "value": [0, 0]}, "cannot be set"),
        ({"do": "set", "key": "quantities.more", "value": {"area": True}}, "quantities.more cannot be set"),
        ({"do": "set", "key": "quantities", "value": {}}, "quantities cannot be set"),
        ({"do": "set", "key": '"solve".tolerance', "value": 1e-3}, "cannot be set"),
        ({"do": "set", "key": "solve.policy", "value": "thesis"}, "solve.policy cannot be set"),
        ({"do": "set", "key": "mesh.sizee", "value": 1}, "sizee"),
        ({"do": "press", "on": "windw"}, "windw"),
    ],
)
def test_refused_edits_leave_shape_and_scene(tmp_path, event, why):
    frames = frames_of(tmp_path, event)
    assert frames[-1].change == "none"
    assert frames[-1].refused is not None and re.search(why, frames[-1].refused)
    assert frames[-1].outline is frames[0].outline
    assert frames[-1].scene is frames[0].scene


def test_a_refused_frame_of_a_path_keeps_the_last_valid_shape(tmp_path):
    path = [[0.6, 0.5], [0.6, 1.0], [9.0, 9.0], [0.7, 0.5]]
    frames = frames_of(tmp_path, PRESS, {"do": "drag", "path": path}, RELEASE)[2:6]
    assert [f.change for f in frames] == ["move", "none", "none", "move"]
    assert frames[1].outline is frames[0].outline and frames[2].outline is frames[0].outline
    assert "cross" in frames[1].refused and "outside" in frames[2].refused


def steps_of(session, event):
    """The steps of an event, which is not read from a file."""
    return session.steps(EVENTS[event["do"]].model_validate({"t": 0, **event}))


@pytest.mark.parametrize(
    "event",
    [
        {"do": "set", "key": "material.steel.nu", "value": 0.2},
        {"do": "insert", "on": "bottom", "name": "q", "s": 0.3},
        {"do": "hole", "name": "new", "center": [1.5, 0.5], "radius": 0.1},
        {"do": "undo"},
        {"do": "redo"},
    ],
)
def test_an_edit_taken_back_leaves_no_trace(tmp_path, event):
    session = EditSession(*scene_and_script(tmp_path, []))
    for known in ({"do": "insert", "on": on, "name": name, "s": 0.6} for on, name in (("right", "p1"), ("left", "p2"))):
        list(steps_of(session, known))
    list(steps_of(session, {"do": "undo"}))
    outline, scene = session.outline, session.scene
    for _ in steps_of(session, event):
        assert (session.outline, session.scene) != (outline, scene)
        session.rollback()
    assert session.outline is outline and session.scene is scene
    assert [step.refused for step in steps_of(session, {"do": "redo"})] == [None]
    assert "p2" in session.outline.vertex_names and "p1" in session.outline.vertex_names
    for left in (None, None, "there is nothing to undo"):
        assert [step.refused for step in steps_of(session, {"do": "undo"})] == [left]


def test_a_drag_moves_on_from_the_cursor_after_a_frame_taken_back(tmp_path):
    session = EditSession(*scene_and_script(tmp_path, []))
    list(steps_of(session, PRESS))
    path, seen = [[0.6, 0.5], [0.7, 0.5], [0.7, 0.5], [0.8, 0.5]], []
    for i, step in enumerate(steps_of(session, {"do": "drag", "path": path})):
        if i in (1, 2):
            session.rollback()
        seen.append((step.change, *session.outline.centroid(session.outline.entity("window")).tolist()))
    assert [change for change, *_ in seen] == ["move"] * 4
    np.testing.assert_allclose([x for _, x, _ in seen], [0.6, 0.6, 0.6, 0.8], atol=1e-15)


@pytest.mark.parametrize("lost", [{2}, {3}, {2, 3}])
@pytest.mark.parametrize(
    "event", [{"do": "scale", "on": "window", "factor": 1.5}, {"do": "arc", "on": "left", "bulge": 0.1}]
)
def test_frames_of_a_turn_taken_back(tmp_path, event, lost):
    session = EditSession(*scene_and_script(tmp_path, []))
    first = session.outline
    shapes = [first]
    for i, _ in enumerate(steps_of(session, {**event, "frames": 4})):
        if i in lost:
            session.rollback()
        assert (session.outline is shapes[-1]) == (i in lost)
        shapes.append(session.outline)
    assert [step.refused for step in steps_of(session, {"do": "undo"})] == [None]
    assert session.outline is first


def test_a_hundred_steps_can_be_undone(tmp_path):
    session = EditSession(*scene_and_script(tmp_path, []))
    for k in range(150):
        list(steps_of(session, {"do": "set", "key": "material.steel.nu", "value": 0.001 * k}))
    undone = [next(iter(steps_of(session, {"do": "undo"}))).refused for _ in range(101)]
    assert undone[:100] == [None] * 100 and undone[100] == "there is nothing to undo"
    assert session.scene.material["steel"].nu == 0.001 * 49
    redone = [next(iter(steps_of(session, {"do": "redo"}))).refused for _ in range(101)]
    assert redone[:100] == [None] * 100 and redone[100] == "there is nothing to redo"
    assert session.scene.material["steel"].nu == 0.001 * 149


def test_setting_mesh_keys_asks_for_a_new_mesh(tmp_path):
    sets = {"mesh.size": 0.05, "material.steel.nu": 0.25, "effects.gravity.g": [0, -1]}
    frames = frames_of(tmp_path, *({"do": "set", "key": key, "value": value} for key, value in sets.items()))
    assert [f.change for f in frames[1:]] == ["mesh", "values", "mesh"]
    assert frames[2].scene.material["steel"].nu == 0.25


def test_an_effect_that_makes_another_analysis_is_not_switched(tmp_path):
    on = {"do": "set", "key": "effects.large_deformation.load_steps", "value": 5}
    off = {"do": "set", "key": "effects", "value": {"solid": {"model": "plane_stress"}}}
    (start, refused, *_) = frames = frames_of(tmp_path, on, {"do": "set", "key": "effects.gravity.g", "value": [0, -1]})
    assert "'large_deformation' cannot be switched on during an edit" in refused.refused
    assert "make it two scenes" in refused.refused
    assert refused.scene is start.scene and frames[2].refused is None
    scene, script = scene_and_script(tmp_path, [on, off], CURVED + "[effects.large_deformation]\n")
    frames = list(EditSession(scene, script).frames())
    assert frames[1].change == "values" and frames[1].scene.effects["large_deformation"]["load_steps"] == 5
    assert "'large_deformation' cannot be switched off" in frames[2].refused


def test_modes_beyond_the_columns_of_the_first_frame_are_refused(tmp_path):
    text = CURVED.replace('app = "plane"', 'app = "modes"').replace("traction = [1e6, 0]", "")
    text = text[: text.index("[loads")] + "[effects.modal]\nmodes = 3\n[mesh]\nsize = 0.1\n"
    text = text.replace("nu = 0.3", "nu = 0.3\nrho = 8000\nthickness = 0.01")
    values = [{"do": "set", "key": "effects.modal.modes", "value": modes} for modes in (2, 3, 5)]
    scene, script = scene_and_script(tmp_path, values, text)
    fewer, again, more = list(EditSession(scene, script).frames())[1:]
    assert fewer.refused is None and again.refused is None and more.scene is again.scene
    assert more.refused.startswith("the columns of a replay are those of its first frame, and f_4, f_5, tone_4")


def test_one_drag_in_many_steps_ends_where_one_jump_ends(tmp_path):
    path = [[0.5 + 0.1 * np.sin(0.3 * i), 0.5 + 0.05 * np.cos(0.2 * i)] for i in range(100)]
    frames = frames_of(tmp_path, PRESS, {"do": "drag", "path": path}, RELEASE)
    jump = frames_of(tmp_path, PRESS, {"do": "drag", "to": path[-1]}, RELEASE)
    assert frames[-1].outline.points.tobytes() == jump[-1].outline.points.tobytes()


def test_pieces_are_made_finer_when_a_curve_grows():
    tables = {"window": {"circle": {"center": [0.5, 0.5], "radius": 0.004}}}
    outline = square(holes=tables)
    grow = movements.scale(outline, outline.entity("window"), np.array([0.5, 0.5]))
    check = MotionCheck(outline, grow)
    # Eight pieces of the small circle would leave 0.001 between themselves and a circle of radius 0.4985.
    assert check.problem((0.499 / 0.004 - 1.0, 0.0)) is None
    assert check.problem((0.5005 / 0.004 - 1.0, 0.0)) is not None


coordinate = st.floats(-0.4, 2.4, allow_nan=False).map(lambda v: round(v, 3))
place = st.tuples(coordinate, coordinate).map(list)
NAMES = ("a", "b", "c", "d", "window", "window.v1", "window.2", "top", "bottom", "left", "q", "h1")


@pytest.mark.slow
@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.lists(st.one_of(gestures(NAMES, place), single_edits(NAMES, place)), min_size=1, max_size=8))
def test_no_edit_leaves_an_invalid_shape(tmp_path, edits):
    events = [event for part in edits for event in part]
    scene, script = scene_and_script(tmp_path, [])
    session = EditSession(scene, script)
    for event in events:
        for step in session.steps(EVENTS[event["do"]].model_validate({"t": 0, **event})):
            assert step.refused is None or step.change == "none"
            if step.change in ("move", "shape"):
                assert fault(session.outline) is None
    assert problem(session.outline) is None


def test_arcs_that_cross_by_less_than_their_straight_pieces_know_are_refused(tmp_path):
    scene, script = scene_and_script(tmp_path, [])
    for by, crosses in ((3.982, True), (4.1, False)):
        session = EditSession(scene, script)
        turn = {"t": 0, "do": "rotate", "on": "window.2", "by": by}
        (step,) = session.steps(EVENTS["rotate"].model_validate(turn))
        assert (step.refused is not None and "would cross" in step.refused) is crosses
        assert fault(session.outline) is None
