"""What shapes show at the hand: supports and loads, extremes, limits, singular places, lines of one value."""

import subprocess
import sys
from dataclasses import replace
from itertools import pairwise
from operator import is_
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from marked_edits import rows_with_and_without

import restshape
from restshape.live.extreme_marks import ExtremeMarks, LookedAt
from restshape.live.isolines import isolines, round_levels
from restshape.live.kept_marks import kept
from restshape.live.seen_frame import SeenFrame
from restshape.live.shape_marks import shape_marks
from restshape.live.shape_surface import mode_of
from restshape.live.shown_marks import Arrows, Lines, NodeValue, Words, shown_with
from restshape.outputs.si_numbers import si

BRACKET = Path(__file__).parents[2] / "docs" / "examples" / "bracket.toml"
COARSE = ("mesh.size='30 mm'", "mesh.near.window='15 mm'")


@pytest.fixture(scope="module")
def bracket():
    with restshape.open(restshape.load(BRACKET, *COARSE)) as simulation:
        yield simulation


def marks_of(simulation, kind):
    return [one for one in shape_marks(simulation) if isinstance(one, kind)]


def test_supports_are_lines_that_stay_and_loads_are_arrows_with_their_vectors(bracket):
    scene = bracket.scene
    supports = [one for one in marks_of(bracket, Lines) if one.meaning == "support"]
    assert [one.name for one in supports] == [f"support {name}" for name in scene.supports]
    assert not bracket.frame.displacement[supports[0].nodes].any() and len(supports[0].nodes) > 2
    (name, load), *_ = scene.loads.items()
    (arrows,) = (one for one in marks_of(bracket, Arrows) if one.name == f"load {name}")
    value = getattr(load, load.kind)
    assert arrows.unit == {"force": "N", "traction": "Pa"}[load.kind]
    assert np.allclose(arrows.vectors, np.array(value, dtype=float))
    ends = bracket.frame.mesh.points[arrows.nodes]
    assert arrows.nodes.shape == (len(arrows.vectors), 2) and (ends[:, 0] != ends[:, 1]).any(axis=1).all()


def test_marks_of_supports_and_loads_stay_the_same_while_a_hole_is_dragged(bracket):
    """They lie at nodes, and the page has them follow the shape: nothing of them travels."""
    named = {one.name: one for one in marks_of(bracket, Lines | Arrows) if one.name.startswith(("support", "load"))}
    with bracket.press("window", at=[0.1, 0.06]) as hand:
        assert hand.to(0.1005, 0.0605).row["level"] == 1
        later = [one for one in marks_of(bracket, Lines | Arrows) if one.name in named]
        assert len(named) >= 2 and all(named[one.name] is one for one in later)
        hand.to(0.1, 0.06)


def test_an_extreme_is_said_where_the_field_has_it(bracket):
    frame = bracket.frame
    names = [name for name, one in bracket.scene.quantities.items() if one.reduce == "max" and one.kind == "stress"]
    assert names
    for name in names:
        (value,) = (one for one in marks_of(bracket, NodeValue) if one.name == name)
        assert frame.von_mises[value.node] == pytest.approx(frame.quantities[name], rel=1e-12)
        assert value.unit == "Pa"


def test_the_value_of_an_extreme_is_the_same_mark_until_it_is_at_another_node(bracket):
    with bracket.press("window", at=[0.1, 0.06]) as hand:
        found = []
        for step in range(12):
            hand.to(0.1, 0.06 + 0.0015 * step)
            found.append(marks_of(bracket, NodeValue))
        hand.to(0.1, 0.06)
    same = [[a is b for a, b in zip(*pair)] for pair in pairwise(found)]
    moved = [[a.node != b.node for a, b in zip(*pair)] for pair in pairwise(found)]
    assert all(one is not other for pair in zip(same, moved) for one, other in zip(*pair))
    assert any(map(any, same)) and any(map(any, moved))


def test_an_extreme_is_said_with_its_estimated_error_where_the_page_has_not_all_nodes(bracket):
    scene = restshape.load(BRACKET, *COARSE, "quantities.stress_at_window.max='1 GPa'")
    with restshape.open(scene) as simulation:
        error = simulation.frame.row["stress_at_window_error"]
        seen = SeenFrame.of(simulation)
        hidden = type("SkinOnly", (SeenFrame,), {"all_nodes_drawn": False})
        skin = hidden(seen.frame, seen.scene, seen.space, seen.deformed, seen.solved)
        (words,) = (one for one in ExtremeMarks()(skin) if one.text.startswith("stress_at_window "))
        (value,) = (one for one in ExtremeMarks()(seen) if one.name == "stress_at_window")
    assert error > 0 and words.text.endswith(f"(error {si(error, 'Pa', 2)})")
    assert words.at == seen.space.X[value.node].tolist() and words.moved == seen.deformed[value.node].tolist()


def test_an_extreme_is_found_among_the_values_that_are_known(bracket):
    seen = SeenFrame.of(bracket)
    for reduce, place in (("max", 2), ("min", 1), ("absmax", 2)):
        values = np.array([np.nan, 1.0, 3.0, np.nan])
        fields = {**seen.frame.fields, "known": values}
        partly = replace(seen, frame=SimpleNamespace(fields=fields, row={}))
        assert (
            ExtremeMarks()._node(LookedAt("a", "Pa", "known", None, reduce, None, ("q_a", "a_error")), partly) == place
        )
        later = replace(seen, frame=SimpleNamespace(fields=fields, row={"q_a": 4.0}))
        assert ExtremeMarks()._node(LookedAt("a", "Pa", "known", None, reduce, None, ("q_a", "a_error")), later) is None
        values[:] = np.nan
        assert (
            ExtremeMarks()._node(LookedAt("a", "Pa", "known", None, reduce, None, ("q_a", "a_error")), partly) is None
        )


def largest_stress():
    """Name of the quantity that is the largest stress."""
    quantities = restshape.load(BRACKET).quantities.items()
    return next(name for name, one in quantities if one.reduce == "max" and one.kind == "stress")


def test_a_limit_that_may_fail_is_said_in_few_words(bracket):
    name = largest_stress()
    most = f"quantities.{name}.max={1.001 * bracket.frame.quantities[name]}"
    with restshape.open(restshape.load(BRACKET, *COARSE, most)) as simulation:
        (words,) = (one.text for one in marks_of(simulation, Words) if one.meaning == "uncertain" and name in one.text)
        assert words.startswith(f"{name} ") and words.endswith(": uncertain") and len(words) <= len(name) + 40


def test_a_limit_that_fails_is_said_at_its_place():
    name = largest_stress()
    with restshape.open(restshape.load(BRACKET, *COARSE, f"quantities.{name}.max='1 Pa'")) as simulation:
        (words,) = (one for one in marks_of(simulation, Words) if one.meaning == "limit")
        assert words.text.startswith(f"{name} is ") and words.text.endswith("at most 1 Pa") and words.at is not None


def test_marks_of_a_frame_that_rests_are_the_same_objects_and_go_with_the_simulation(bracket):
    first = shape_marks(bracket)
    bracket.idle()
    assert len(first) > 2 and all(map(is_, first, shape_marks(bracket)))
    assert kept(bracket, dict) is kept(bracket, dict)


def test_marks_change_nothing():
    scene = restshape.load(BRACKET, *COARSE)
    drag = {"do": "drag", "path": [[0.1, 0.06], [0.102, 0.062]]}
    events = [{"do": "press", "on": "window"}, drag, {"do": "release"}, {"do": "idle", "frames": 1}]
    marked, plain = rows_with_and_without(scene, events)
    assert len(plain) == 5 and marked == plain


def test_a_scene_that_asks_for_no_extreme_has_that_of_its_first_field():
    plain = {key: value for key, value in restshape.load(BRACKET).raw.items() if key != "quantities"}
    with restshape.open(restshape.new_scene(plain | {"mesh": {"size": "30 mm"}})) as simulation:
        (words,) = (one for one in marks_of(simulation, Words))
        worst = int(simulation.frame.von_mises.argmax())
        assert words.text.startswith("max ") and words.text.endswith("Pa")
        assert words.at == simulation.frame.mesh.points[worst].tolist()


def test_a_frame_that_is_refused_keeps_the_last_marks():
    with restshape.open(restshape.load(BRACKET, *COARSE), strict=False) as simulation:
        last = shape_marks(simulation)
        with simulation.press("window") as hand:
            assert hand.to(5.0, 5.0).refused
            assert last and shape_marks(simulation) is last


MOST_CALLS = 220
"""Of functions, for the marks of a frame of a drag: less than 0.1 ms."""


def test_marks_of_a_drag_take_few_calls():
    calls = 0

    def count(frame, event, argument):
        nonlocal calls
        calls += event in ("call", "c_call")

    with (
        restshape.open(restshape.load(BRACKET, *COARSE)) as simulation,
        simulation.press("window", at=[0.1, 0.06]) as hand,
    ):
        shape_marks(simulation)
        hand.to(0.101, 0.061)
        _ = simulation.frame.fields
        sys.setprofile(count)
        try:
            found = shape_marks(simulation)
        finally:
            sys.setprofile(None)
    assert len(found) >= 3 and 10 < calls <= MOST_CALLS


def test_lines_of_one_value_lie_where_a_linear_field_has_it():
    X = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    cells = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
    (lines,) = isolines("isotherms", X, cells, 300.0 + 8.0 * X[:, 0], "K")
    levels = [words for words in lines.words if words]
    assert levels == [f"{k} K" for k in range(301, 308)]
    assert np.allclose(lines.points[:, 0] * 8.0, np.round(lines.points[:, 0] * 8.0), atol=1e-12)
    assert isolines("none", X, cells, np.ones(4), "K") == []


def test_lines_of_a_mode_are_shown_where_it_is_drawn():
    modes = [Lines(f"mode {k}", np.zeros((1, 2)), mode=k) for k in (0, 1, 2)]
    assert shown_with([*modes, Words("C5")], mode_of("mode_2")) == [modes[0], modes[2], Words("C5")]
    assert shown_with(modes, mode_of("size_of_mode_1")) == modes[:2] == shown_with(modes, mode_of("von_mises"))


def test_levels_are_round_and_few():
    for low, high in ((0.0, 1.0), (293.15, 299.8), (-3e-7, 8e-7)):
        levels = round_levels(low, high)
        assert 3 <= len(levels) <= 8 and all(low < level < high for level in levels)


@pytest.mark.cli
def test_marks_of_shapes_need_no_pictures_and_no_recordings():
    program = "import sys, restshape.live.shape_marks; print({'matplotlib', 'h5py', 'gmsh'} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout == "set()\n"
