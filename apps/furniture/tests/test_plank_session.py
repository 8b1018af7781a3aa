"""Sessions of furniture: what each event does to a piece, and what is refused in words."""

import numpy as np
import pytest
from furniture_scenes import BENCH, write_bench, write_edits
from restshape_apps.furniture.guidance.design import Design
from restshape_apps.furniture.physics.furniture import LOST, UNSTABLE
from restshape_apps.furniture.pieces import PIECES, SCENES
from restshape_apps.furniture.session.plank_session import PlankSession

from restshape.errors import UserError
from restshape.guidance.ranges import valid_ranges
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene


@pytest.fixture
def play(tmp_path):
    """Frames of events on the bench, and the session."""

    def played(*events, text=BENCH, **header):
        scene = load_scene(write_bench(tmp_path, text))
        session = PlankSession(scene, load_script(write_edits(tmp_path, *events, **header), scene))
        return list(session.frames()), session

    return played


def planks(session):
    """Planks by name, as they are now."""
    return {plank.name: plank for plank in session.design.furniture.moved(session.gamma).planks}


def press(on, **more):
    return {"do": "press", "on": on, **more}


RELEASE = {"do": "release"}


def test_a_plank_goes_with_the_hand_and_its_joint_stays_closed(play):
    drag = {"do": "drag", "to": [-0.5, 0.1, 0.25], "frames": 4}
    frames, session = play(press("left", at=[-0.5, 0.0, 0.25]), drag, RELEASE)
    assert [frame.change for frame in frames] == ["start", "none", "move", "move", "move", "move", "none"]
    assert [frame.c[0] for frame in frames[2:6]] == pytest.approx([0.025, 0.05, 0.075, 0.1])
    leg = planks(session)["left"]
    assert leg.centre == pytest.approx([-0.5, 0.1, 0.25]) and leg.size == pytest.approx([0.5, 0.3, 0.02])
    assert [frame.edit_ended for frame in frames] == [True, False, False, False, False, False, True]
    assert not session.gamma.any() and frames[-1].gesture is None


def test_a_longer_leg_would_lift_the_bench_and_is_refused_in_words(play):
    frames, session = play(press("left", parameter="length x"), {"do": "drag", "by": 0.1, "frames": 2}, RELEASE)
    assert frames[1].refused.startswith(
        "left cannot become longer along its x: its joints and feet would not stay closed"
    )
    assert [frame.refused for frame in frames[2:]] == ["nothing is grabbed"] * 3
    assert planks(session)["left"].size[0] == pytest.approx(0.5)


def test_a_raised_board_draws_its_legs_along(play):
    _, session = play(press("top", parameter="move z"), {"do": "drag", "by": 0.2, "frames": 2}, RELEASE)
    found = planks(session)
    assert found["top"].centre[2] == pytest.approx(0.71)
    assert [found[name].size[0] for name in ("left", "right")] == pytest.approx([0.7, 0.7])
    assert [found[name].end(0)[2] for name in ("left", "right")] == pytest.approx([0.0, 0.0], abs=1e-9)


def test_directions_that_would_open_joints_are_left_out_and_named(play):
    # Along its x the leg is held between floor and board: its length follows, so that it cannot move.
    drag = {"do": "drag", "to": [-0.4, 0.0, 0.35]}
    frames, session = play(press("left", at=[-0.5, 0.0, 0.25]), drag)
    assert frames[2].note == "left cannot move along its +x (+z of the room): that part of the drag is left out"
    assert planks(session)["left"].centre == pytest.approx([-0.4, 0.0, 0.25])


def test_hands_that_hold_a_parameter_drag_numbers_and_others_points(play):
    frames, _ = play(press("left", parameter="move z"), {"do": "drag", "to": [0, 0, 0]})
    assert frames[-1].refused == "a parameter is dragged by a number: use 'by', or press the plank without a parameter"
    frames, _ = play(press("left"), {"do": "drag", "by": 1.0})
    assert frames[-1].refused == "a plank is dragged to a point: use 'to', or press a parameter of it"


def test_the_hand_takes_a_path_in_as_many_frames_as_it_has_points(play):
    path = [[-0.5, 0.0, 0.25], [-0.45, 0.0, 0.25], [-0.4, 0.05, 0.25]]
    frames, session = play(press("left"), {"do": "drag", "path": path})
    assert len(frames) == 5
    assert planks(session)["left"].centre == pytest.approx(path[-1])


def test_turns_and_lengths_without_a_hand(play):
    turn = {"do": "rotate", "on": "left", "by": "30 deg", "about": "y", "frames": 3}
    frames, session = play(turn, {"do": "scale", "on": "top", "factor": 1.5, "along": "y", "frames": 2})
    assert [frame.change for frame in frames[1:]] == ["move"] * 5
    found = planks(session)
    assert found["top"].size == pytest.approx([1.2, 0.45, 0.02])
    # It leans by 30 degrees between the floor and the board, whose distance is 0.5 m.
    leg = found["left"]
    assert abs(leg.axes[2, 0]) == pytest.approx(np.cos(np.pi / 6))
    assert leg.size[0] == pytest.approx(0.5 / np.cos(np.pi / 6), abs=1e-6)
    assert frames[3].c[0] == pytest.approx(np.pi / 6)


def test_no_plank_loses_all_of_its_length(play):
    frames, session = play(press("top", parameter="move z"), {"do": "drag", "by": -0.6, "frames": 6})
    assert [frame.refused for frame in frames[2:6]] == [None] * 4
    assert frames[-1].refused == "left and right would have no length left: a plank keeps 10 mm at least"
    assert planks(session)["left"].size[0] > 0.0


SHELF = {"do": "plank", "name": "shelf", "from": [-0.49, 0, 0.2], "to": [0.49, 0, 0.2], "width": [0, 0.2, 0]}


def test_a_drawn_plank_is_joined_to_what_it_is_near(play):
    frames, session = play(SHELF)
    piece = session.design.piece
    assert frames[1].change == "shape" and len(piece.planks) == 4
    assert sorted((j.i, j.j) for j in piece.joints) == [(1, 0), (2, 0), (3, 1), (3, 2)]
    assert piece.planks[3].wood == "pine" and piece.planks[3].size[2] == 0.02
    assert {joint.fastener for joint in piece.joints} == {"screw"}


def test_a_plank_is_connected_where_it_has_come_near(play):
    far = SHELF | {key: [a, 0.8, c] for key, (a, _, c) in (("from", SHELF["from"]), ("to", SHELF["to"]))}
    events = far, press("shelf"), {"do": "drag", "to": [0, 0, 0.2]}, RELEASE, {"do": "connect", "on": "shelf"}
    frames, session = play(*events, {"do": "connect", "on": "shelf"})
    assert [bool(frame.design.furniture.test().flaws & UNSTABLE) for frame in frames[1:6]] == [True] * 4 + [False]
    assert len(session.design.piece.joints) == 4
    assert "near nothing" in frames[-1].refused


def test_weights_are_put_changed_and_taken_away(play):
    put = {"do": "weight", "name": "vase", "on": "top", "mass": "3 kg", "at": [0.25, 0, 0.5]}
    frames, _ = play(put, put | {"mass": "4 kg"}, {"do": "delete", "on": "vase"}, {"do": "delete", "on": "vase"})
    loads = [{load.name: load.force[2] for load in frame.design.piece.weights} for frame in frames]
    assert loads[1] == {"box": -200.0, "vase": -30.0} and loads[2]["vase"] == -40.0 and loads[3] == {"box": -200.0}
    assert "there is no plank or weight 'vase'" in frames[4].refused


def test_a_plank_that_goes_takes_its_joints_and_loads_along(play):
    frames, session = play(SHELF, {"do": "delete", "on": "top"})
    piece = session.design.piece
    assert [plank.name for plank in piece.planks] == ["left", "right", "shelf"]
    assert [(j.i, j.j) for j in piece.joints] == [(2, 0), (2, 1)] and not piece.weights
    assert frames[-1].refused is None


REFUSED = [
    (press("lft"), "did you mean 'left'"),
    ({"do": "rotate", "on": "lft", "by": 1}, "did you mean 'left'"),
    ({"do": "rotate", "on": "left", "by": 1, "about": "z"}, "left cannot turn z"),
    (SHELF | {"name": "left"}, "there is 'left' already"),
    (SHELF | {"width": [1, 0, 0]}, "its width lies along its middle line (draw its width across its middle line)"),
    (SHELF | {"width": [0, 0, 0]}, "its width has no length (draw a width across"),
    (SHELF | {"to": SHELF["from"]}, "its middle line has no length: it ends where it begins (let it go"),
    ({"do": "weight", "name": "left", "on": "top", "mass": 1}, "there is 'left' already"),
    ({"do": "choose", "number": 1}, "there is no suggestion 1"),
    ({"do": "slide", "to": 0.5}, "no suggestion is chosen"),
    ({"do": "set", "key": "wood.name", "value": "balsa"}, "no wood balsa"),
    ({"do": "set", "key": "app", "value": "solid"}, "cannot be set during an edit"),
    ({"do": "set", "key": "wood.thickness", "value": 0.06}, "does not reach through 60 mm"),
    ({"do": "undo"}, "nothing to undo"),
    ({"do": "redo"}, "nothing to redo"),
]


@pytest.mark.parametrize(("event", "words"), REFUSED, ids=[words for _, words in REFUSED])
def test_refusals_leave_the_piece_as_it_is(play, event, words):
    frames, session = play(event)
    assert words in frames[1].refused and frames[1].change == "none"
    assert frames[1].design is frames[0].design is session.design


def test_thicker_wood_in_even_steps(play):
    frames, _ = play({"do": "set", "key": "wood.thickness", "value": "30 mm", "frames": 5}, {"do": "undo"})
    thick = [frame.design.piece.planks[1].size[2] for frame in frames]
    assert thick == pytest.approx([0.02, 0.022, 0.024, 0.026, 0.028, 0.03, 0.02])
    # The board's middle stays, so that its legs end where its lower face is.
    assert frames[5].design.piece.planks[1].size[0] == pytest.approx(0.51 - 0.015)


def test_each_edit_is_undone_and_done_again(play):
    edits = [
        SHELF,
        {"do": "weight", "name": "vase", "on": "top", "mass": 1},
        {"do": "rotate", "on": "left", "by": 0.2, "about": "y", "frames": 3},
        {"do": "set", "key": "floor.friction", "value": 0.2},
        {"do": "delete", "on": "shelf"},
    ]
    frames, _ = play(*edits, *[{"do": "undo"}] * 5, *[{"do": "redo"}] * 5)

    def reported(frame):
        piece = frame.design.furniture.moved(frame.gamma)
        lean = round(float(piece.planks[1].axes[0, 0]), 9)
        return len(piece.planks), len(piece.weights), piece.planes[0].mu, lean

    ends = [reported(frames[k]) for k in (0, 1, 2, 5, 6, 7)]
    assert ends == [
        (3, 1, 0.5, 0.0),
        (4, 1, 0.5, 0.0),
        (4, 2, 0.5, 0.0),
        (4, 2, 0.5, pytest.approx(np.sin(0.2), abs=1e-6)),
        (4, 2, 0.2, pytest.approx(np.sin(0.2), abs=1e-6)),
        (3, 2, 0.2, pytest.approx(np.sin(0.2), abs=1e-6)),
    ]
    assert [reported(frame) for frame in frames[8:13]] == ends[4::-1]
    assert [reported(frame) for frame in frames[13:18]] == ends[1:]
    assert frames[-1].scene is frames[7].scene


def heavy(kilograms):
    """The bench with a mass beyond its left leg, whose end tips it over."""
    return BENCH.replace('mass = "20 kg"', f'mass = "{kilograms} kg"\nat = [-0.49, 0, 0.5]')


def test_a_suggestion_is_chosen_and_followed(play):
    text = heavy(60)
    frames, session = play({"do": "choose", "number": 1}, {"do": "slide", "to": 1, "frames": 4}, text=text)
    assert frames[0].design.furniture.test().flaws & UNSTABLE
    suggestion = frames[0].design.suggestion_list.found[0]
    assert frames[1].design.furniture.test().valid
    assert [frame.c[0] for frame in frames[2:]] == pytest.approx(np.linspace(suggestion.t, suggestion.span[1], 5)[1:])
    frames, session = play({"do": "choose", "number": 1}, {"do": "slide", "to": 0.5}, *[{"do": "undo"}] * 2, text=text)
    assert session.design is frames[0].design


def test_a_lost_joint_is_found_again_by_a_suggestion(play):
    away = press("left", parameter="move z"), {"do": "drag", "by": 0.3, "frames": 3}, RELEASE
    frames, session = play(*away, {"do": "choose", "number": 1})
    assert frames[5].design.furniture.test().flaws & LOST
    assert not session.design.furniture.test().flaws & LOST


def test_on_demand_frames_are_analysed_where_the_script_asks(play):
    frames, _ = play({"do": "idle", "frames": 2}, {"do": "analyse"}, analysis="on demand")
    assert [frame.analysed for frame in frames] == [True, False, False, True]


def test_steps_taken_back_leave_all_as_it_was(play):
    _, session = play()
    event = load_script_event(SHELF)
    steps = session.steps(event)
    before = session.design
    next(steps)
    assert session.design is not before
    session.rollback()
    assert session.design is before and not session._past


def load_script_event(event):
    """One event as a script would hold it."""
    from restshape_apps.furniture.scene.plank_events import PLANK_EVENTS

    return PLANK_EVENTS[event["do"]].model_validate({"t": 0.0, **event})


def test_a_suggested_plank_is_built_and_holds(tmp_path):
    scene = load_scene(SCENES / "table.toml")
    suggestion_list = PlankSession(scene, load_script(write_edits(tmp_path), scene)).design.suggestion_list.found
    number = next(k for k, suggestion in enumerate(suggestion_list, 1) if suggestion.kind == "a support plank")
    script = load_script(write_edits(tmp_path, {"do": "choose", "number": number}, {"do": "slide", "to": 1}), scene)
    frames = list(PlankSession(scene, script).frames())
    assert len(frames[1].design.piece.planks) == 6 and frames[1].design.furniture.test().valid
    assert frames[1].design.piece.planks[-1].name == "support"
    assert frames[2].refused == "no suggestion is chosen that could be slid along"


def test_more_is_known_the_more_guidance_there_is():
    # Section 6.6.2: one target, with no feedback, with ranges, with suggestions; each line of edits ends it.
    scene = load_scene(SCENES / "table.toml")
    hands = []
    for name in ("blind", "ranges", "suggestions"):
        script = load_script(SCENES.parent / "edits" / f"table-{name}.jsonl", scene)
        frames = list(PlankSession(scene, script).frames())
        assert not frames[0].design.furniture.test().valid and frames[-1].design.furniture.test().valid
        hands.append(sum(event.do in ("press", "choose") for event in script.events))
    assert hands == [4, 2, 1]


def test_a_fastener_that_is_too_short_is_reported_with_its_place(tmp_path):
    scene = load_scene(write_bench(tmp_path), ["wood.thickness=50 mm"])
    with pytest.raises(UserError, match=r"bench.toml: fastener.name \(line 11\): screw of 40 mm does not reach"):
        PlankSession(scene, load_script(write_edits(tmp_path), scene))


def test_a_straight_hand_keeps_its_way(play):
    drag = {"do": "drag", "to": [-0.3, 0.07, 0.25], "frames": 7}
    frames, _ = play(press("left", at=[-0.5, 0.0, 0.25]), drag)
    assert len({id(frame.gesture) for frame in frames[2:]}) == 1
    assert frames[-1].c[0] == pytest.approx(np.hypot(0.2, 0.07))


def test_a_range_knows_of_narrow_gaps():
    """A stretcher of 12 mm that is raised goes through the seat of the chair, and is free again above it."""
    piece = PIECES["chair-1"]()
    names = [plank.name for plank in piece.planks]
    design = Design(piece)
    way = design.parameter(names.index("stretcher"), 2)
    found = design.valid_along(way).intervals
    dense = valid_ranges(design.furniture.kernel, way.direction, way.low, way.high, samples=4001).intervals
    assert len(dense) > 1
    np.testing.assert_allclose(found, dense, atol=1e-5)


def test_ranges_do_not_depend_on_what_was_looked_at_before():
    piece = PIECES["table"]()
    leg = [plank.name for plank in piece.planks].index("leg-4")
    used, ways = Design(piece), []
    for along, up in ((0.8, 0.6), (0.6, 0.8)):
        direction = np.zeros((len(piece.planks), 8))
        direction[leg, [0, 2]] = along, up
        ways.append(direction)
        last = used.design_direction(direction, "leg-4: move")
        used.valid_along(last)
    first = Design(piece).design_direction(ways[-1], "leg-4: move")
    np.testing.assert_array_equal(last.ranges.intervals, first.ranges.intervals)
    np.testing.assert_array_equal(used.hints(last), first.design.hints(first))
    assert len(used.hints(last)) and last.doubtful == first.doubtful
