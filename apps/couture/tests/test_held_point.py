"""A point of cloth that the hand holds: by the statics of a hanging strip, by what comes back, and what is refused."""

import numpy as np
import pytest

import restshape
from restshape.application import application
from restshape.cli.main import main
from restshape.physics.cloth.sensitivity.support_rates import support_rates
from restshape.scene.held_point import hold_of
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec
from restshape.shape.pieces import PieceFinder

STRIP = {
    "format": "restshape-scene",
    "version": 1,
    "app": "couture",
    "shape": {
        "outline": ["bottom", "right", "top", "left"],
        "vertices": {"a": [0, 0], "b": [0.4, 0], "c": [0.4, 0.1], "d": [0, 0.1]},
        "edges": {
            "bottom": {"line": ["a", "b"]},
            "right": {"line": ["b", "c"]},
            "top": {"line": ["c", "d"]},
            "left": {"line": ["d", "a"]},
        },
    },
    "material": {"felt": {"E": 2e6, "nu": 0.0, "rho": 500, "thickness": 4e-4, "bending": 1e-5}},
    "effects": {"gravity": {"g": [0, 0, -9.81]}},
    "supports": {"left": {"on": ["left"], "fix": ["x", "y", "z"]}},
    "mesh": {"size": 0.03},
    "quantities": {"weight_there": {"reaction": "z", "at": "left"}, "end": {"displacement": "z", "at": "b"}},
}
WEIGHT = 0.04 * 0.2 * 9.81
"""Of the sheet [N]."""


@pytest.fixture
def strip():
    with restshape.open(restshape.new_scene(STRIP)) as simulation:
        yield simulation


def places(simulation):
    """Where all nodes are (n, 3) [m]."""
    frame = simulation.frame
    found = frame.displacement.copy()
    found[:, :2] += frame.mesh.points[:, :2]
    return found


def node_at(simulation, x, y):
    return int(((simulation.frame.mesh.points[:, :2] - (x, y)) ** 2).sum(axis=1).argmin())


def test_the_node_at_the_point_is_where_the_hand_is_and_bears_its_part_of_the_weight(strip):
    assert strip.frame.quantities["weight_there"] == pytest.approx(WEIGHT, rel=1e-3)
    node = node_at(strip, 0.4, 0.05)
    hand = strip.press("cloth", at=[0.4, 0.05])
    for way in (0.0, 0.02, 0.05):
        frame = hand.to(0.35, 0.05, -0.05 + way)
        np.testing.assert_allclose(places(strip)[node], [0.35, 0.05, -0.05 + way], atol=1e-12)
        assert frame.row["converged"] == 1


def test_a_sheet_between_a_pin_and_a_hand_as_high_has_half_its_weight_at_each():
    pinned = {**STRIP, "supports": {"pin": {"on": ["a"], "fix": ["x", "y", "z"]}}}
    pinned["quantities"] = {"weight_there": {"reaction": "z", "at": "a"}}
    with restshape.open(restshape.new_scene(pinned)) as simulation:
        assert simulation.frame.quantities["weight_there"] == pytest.approx(WEIGHT, rel=1e-3)
        simulation.press("cloth", at=[0.4, 0.0]).to(0.3, 0.0, 0.0)
        assert simulation.frame.quantities["weight_there"] == pytest.approx(0.5 * WEIGHT, rel=0.01)


def test_what_is_let_go_and_what_is_undone_is_as_before(strip):
    before = places(strip)
    with strip.press("cloth", at=[0.4, 0.0]) as hand:
        hand.to(0.38, 0.0, -0.05)
        assert np.abs(places(strip) - before).max() > 1e-3 and hold_of(strip.scene) is not None
    assert hold_of(strip.scene) is None
    np.testing.assert_allclose(places(strip), before, atol=1e-5)
    strip.do("undo")
    np.testing.assert_array_equal(places(strip), before)
    strip.do("redo")
    assert hold_of(strip.scene) is None


def test_a_way_of_several_frames_begins_where_the_hand_is(strip):
    strip.press("cloth", at=[0.4, 0.05])
    strip.do("drag", to=[0.35, 0.05, -0.1])
    heights = []
    for frame in strip.each("drag", to=[0.35, 0.05, -0.06], frames=4):
        heights.append(hold_of(frame.scene).to[2])
    np.testing.assert_allclose(heights, [-0.09, -0.08, -0.07, -0.06])


def test_the_first_way_of_several_frames_goes_from_its_first_place_without_a_stop():
    scene = restshape.new_scene(STRIP)
    script = restshape.new_script(
        scene,
        [
            {"do": "press", "on": "cloth", "at": [0.4, 0.05]},
            {"do": "drag", "path": [[0.35, 0.05, -0.1], [0.35, 0.05, -0.06]], "frames": 4},
        ],
    )
    holds = [hold_of(frame.scene) for frame in restshape.replay(scene, script)]
    np.testing.assert_allclose([hold.to[2] for hold in holds if hold], [-0.09, -0.08, -0.07, -0.06])


def test_a_press_without_a_drag_changes_nothing(strip):
    before, scene = places(strip), strip.scene
    with strip.press("cloth", at=[0.2, 0.05]):
        pass
    np.testing.assert_array_equal(places(strip), before)
    assert strip.scene is scene


@pytest.mark.parametrize(
    ("press", "to", "why"),
    [
        ({}, None, "named in the pattern plane"),
        ({"at": [0.2, 0.05, 0.0]}, None, "named in the pattern plane"),
        ({"at": [0.2, 0.05]}, [0.2, 0.05], "has no z"),
        ({"at": [0.9, 0.05]}, None, "there is no cloth at (0.9, 0.05) m of the pattern"),
        (
            {"at": [0.0, 0.05]},
            [0.2, 0.05, 0.1],
            "of the pattern, and the hand is 0.2 m from there",
        ),
    ],
)
def test_what_cannot_be_grabbed_is_refused_and_goes_on(press, to, why):
    with restshape.open(restshape.new_scene(STRIP), strict=False) as simulation:
        before = places(simulation)
        frame = simulation.do("press", on="cloth", **press)
        if to is not None:
            assert not frame.refused
            frame = simulation.do("drag", to=to)
        assert why in frame.refused, frame.refused
        simulation.do("release")
        assert hold_of(simulation.scene) is None
        np.testing.assert_allclose(places(simulation), before, atol=1e-9)


def test_a_scene_may_hold_a_point_of_its_own_and_says_so():
    own = {**STRIP, "hold": {"at": [0.4, 0.05], "to": [0.3, 0.05, 0.0]}}
    with restshape.open(restshape.new_scene(own)) as simulation:
        node = node_at(simulation, 0.4, 0.05)
        np.testing.assert_allclose(places(simulation)[node], [0.3, 0.05, 0.0], atol=1e-12)
        with simulation.press("cloth", at=[0.2, 0.05]) as hand:
            hand.to(0.15, 0.05, -0.1)
        assert hold_of(simulation.scene).at == (0.4, 0.05)


def test_cloth_may_hang_by_the_point_alone():
    hanging = {**STRIP, "supports": {}, "quantities": {}, "hold": {"at": [0.2, 0.05], "to": [0.0, 0.0, 0.3]}}
    with restshape.open(restshape.new_scene(hanging)) as simulation:
        assert simulation.frame.row["converged"] == 1
        with simulation.press("cloth", at=[0.4, 0.05]) as hand:
            hand.to(0.1, 0.0, 0.2)
            np.testing.assert_allclose(places(simulation)[node_at(simulation, 0.4, 0.05)], [0.1, 0.0, 0.2], atol=1e-12)
        np.testing.assert_allclose(places(simulation)[node_at(simulation, 0.2, 0.05)], [0.0, 0.0, 0.3], atol=1e-12)


EVENTS = [
    {"do": "press", "on": "cloth", "at": [0.4, 0.05]},
    {"do": "drag", "path": [[0.35, 0.05, -0.05], [0.33, 0.05, 0.0]]},
    {"do": "release"},
    {"do": "undo"},
]


def test_what_is_reused_changes_no_answer():
    scene = restshape.new_scene(STRIP)
    script = restshape.new_script(scene, EVENTS)
    forces = []
    for policy in ("auto", "rebuild"):
        forces.append([frame.quantities["weight_there"] for frame in restshape.replay(scene, script, policy=policy)])
    # The strip lies on other folds of its mesh by a hundredth of its weight.
    np.testing.assert_allclose(*forces, atol=2e-2 * WEIGHT)
    assert len(forces[0]) == 6 and forces[0][3] != pytest.approx(WEIGHT, rel=0.1)


def test_a_derivative_keeps_the_node_under_the_hand_where_two_are_as_near():
    # The middle of the right side is as far from the nodes above and below: which is nearer hangs on the drag.
    grabbed = {**STRIP, "hold": {"at": [0.4, 0.05], "to": [0.35, 0.05, -0.05]}}
    grabbed["quantities"] = {"energy": {"energy": "potential"}}
    with restshape.open(restshape.new_scene(grabbed)) as simulation:
        here, slopes = simulation.frame.quantities["energy"], simulation.frame.derivative("b")["energy"]
        there = simulation.press("b").to(0.4, -1e-4).quantities["energy"]
        assert np.isfinite(slopes).all()
        assert (there - here) / -1e-4 == pytest.approx(slopes[1], rel=2e-2)


@pytest.mark.parametrize("name", ["sewn_skirt", "tabard", "collar"])
def test_a_corner_of_a_panel_is_of_that_panel(name):
    outline = outline_from_spec(load_scene(application("couture").folder / "scenes" / f"{name}.toml").shape)
    finder = PieceFinder(outline)
    pieces = [loop for loop in outline.loops if loop.kind == "outline"]
    assert len(pieces) > 1
    for number, loop in enumerate(pieces):
        corners = [outline.point(edge, end)[0] for edge, _ in loop.edges for end in (0.0, 1.0)]
        assert {finder.of_point(corner) for corner in corners} == {number}


def test_rates_of_supports_leave_the_node_under_the_hand_where_another_is_nearer():
    grabbed = {**STRIP, "hold": {"at": [0.4, 0.05], "to": [0.35, 0.05, -0.05]}}
    with restshape.open(restshape.new_scene(grabbed)) as simulation:
        problem, scene = simulation._replay.analysis.state.problem, simulation._replay.analysis.state.scene
        mesh, hand = problem.mesh, problem.supports.hand
        nearer = mesh.X.copy()
        nearer[:, 1] -= 2.0 * (mesh.X[hand[0], 1] - 0.05)
        rates = support_rates(problem, scene, np.ones_like(mesh.X))
        assert np.abs(rates[problem.corner_number[hand]]).max() == 0.0


def test_the_command_script_writes_the_way_of_a_point(tmp_path, capsys):
    scene, out = tmp_path / "strip.toml", tmp_path / "edits.jsonl"
    restshape.save_scene(restshape.new_scene(STRIP), scene)
    line = "cloth at 40cm 5cm from 0.35 0.05 -0.1 by 0 0 4 cm in 4 frames"
    assert main(["script", str(scene), line, "--out", str(out)]) == 0
    read = restshape.load(scene)
    grabbed = [hold_of(frame.scene) for frame in restshape.replay(read, restshape.load_script(out, read))]
    heights = [hold.to[2] for hold in grabbed if hold]
    np.testing.assert_allclose(heights, [-0.09, -0.08, -0.07, -0.06])
    missed = "cloth at 0.9 0.05 from 0.35 0.05 -0.1 by 0 0 0.04 in 1 frame"
    assert main(["script", str(scene), missed, "--out", str(out)]) == 0
    assert "there is no cloth at (0.9, 0.05) m of the pattern" in capsys.readouterr().err
    assert main(["check", str(scene), str(out)]) == 1
    assert "there is no cloth at (0.9, 0.05) m of the pattern" in capsys.readouterr().out
