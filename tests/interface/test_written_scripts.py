"""Scripts that are written as things are done: each event is the one that a file would give."""

from pathlib import Path

import numpy as np
import pytest

import restshape
from restshape.interface.scripts import PLACE, WrittenScript
from restshape.scene.edit_script import read_script

BRACKET = Path(__file__).parents[2] / "docs" / "examples" / "bracket.toml"


@pytest.fixture(scope="module")
def bracket():
    return restshape.load(BRACKET)


@pytest.fixture
def held(bracket):
    """A script in which a hand holds the window, and has gone to a place."""
    written = WrittenScript(bracket)
    written.add("press", {"on": "window"})
    written.add("drag", {"to": [0.09, 0.06], "frames": None})
    return written


@pytest.mark.parametrize("to", [[0.1, 0.07], [np.float64(0.1), np.float32(0.5)], ["10 cm", 0.07], [0, 1], (0.1, 0.07)])
def test_a_hand_that_goes_on_does_what_a_file_would(held, bracket, to):
    held.add("drag", {"to": to, "frames": None})
    held.add("drag", {"to": [0.11, 0.06], "frames": 3})
    held.add("drag", {"to": [0.12, 0.06]})
    held.add("release", {})
    script = held.script()
    assert script.events == read_script(script.text, PLACE, bracket).events
    assert [event.line for event in script.events] == list(range(2, 8))


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"to": [float("nan"), 0.0]}, "nan is not a finite number"),
        ({"to": [np.inf, 0.0]}, "inf is not a finite number"),
        ({"to": [0.1]}, "at least 2"),
        ({"to": [0.1, 0.0, 0.0]}, "a place in the plane has 2 numbers"),
        ({"to": [0.1, True]}, "a number is wanted here"),
        ({"to": [0.1, "1 kg"]}, "is a mass"),
        ({"to": [0.1, 0.0], "speed": 1.0}, "speed"),
        ({"to": [0.1, 0.0], "frames": 0}, "it must be at least 1"),
        ({}, "exactly one of"),
    ],
)
def test_a_hand_that_goes_on_is_refused_what_a_file_would_be(held, keys, said):
    before = held.script()
    with pytest.raises(restshape.UserError, match=said):
        held.add("drag", keys)
    assert held.script() == before
    assert held.add("drag", {"to": [0.1, 0.06]}).line == 4


def test_nothing_is_moved_that_no_hand_holds(held):
    held.add("release", {})
    with pytest.raises(restshape.UserError, match="before a press"):
        held.add("drag", {"to": [0.1, 0.06]})


def test_the_name_of_a_file_is_neither_a_scene_nor_a_script(bracket):
    for call in (restshape.open, restshape.replay, lambda name: restshape.new_script(name, [])):
        with pytest.raises(restshape.UserError, match=r"restshape\.load\('bracket.toml'\)"):
            call("bracket.toml")
    with pytest.raises(restshape.UserError, match=r"restshape\.load_script\('edits.jsonl'\)"):
        restshape.replay(bracket, Path("edits.jsonl"))
