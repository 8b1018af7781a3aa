"""A key that is set and changes nothing says so, and why."""

import re

import pytest
from restshape_apps.furniture.tests.furniture_scenes import BENCH, write_bench, write_edits
from small_scenes import make_replay

RAIL = """
[planks.rail]
from = [-0.49, 0, 0.2]
to = ["end", 0, 0.2]
width = [0, 0.1, 0]

[parameters]
t = "20 mm"
end = "0.466 m"
most = "8 kg"
unused = 1

[quantities]
heavy = { mass = true, max = "most" }

[effects.guidance]
"""
"""A rail of the bench that ends 24 mm before its right leg."""
JOINED = {"do": "choose", "number": 1}


def notes(tmp_path, *events: dict) -> list[str]:
    """What each event notes."""
    scene = write_bench(tmp_path, BENCH.replace("thickness = 0.02", 'thickness = "t"') + RAIL)
    return [row["note"] for row in make_replay(scene, write_edits(tmp_path, *events)).frames()][1:]


def put(key: str, value: object, **more: int) -> dict:
    return {"do": "set", "key": key, "value": value, **more}


@pytest.mark.parametrize("key", ["parameters.end", "planks.rail.to.0"])
def test_the_length_of_a_rail_that_was_joined_is_that_of_its_joints(tmp_path, key: str) -> None:
    chosen, said = notes(tmp_path, JOINED, put(key, 0.47))
    assert chosen.startswith("suggestion 1: rail 24 mm longer")
    assert said == "parameters.end changes nothing through planks.rail.to.0: joints, feet or earlier edits decide that"


def test_before_it_was_joined_the_rail_follows(tmp_path) -> None:
    assert notes(tmp_path, put("parameters.end", 0.46), put("parameters.end", 0.46)) == ["", ""]


def test_a_parameter_that_nothing_follows_says_so(tmp_path) -> None:
    said = "parameters.{} changes nothing: no formula uses it now"
    assert notes(tmp_path, put("parameters.unused", 2)) == [said.format("unused")]
    # The last frame of several says it.
    assert notes(tmp_path, put("parameters.unused", 2, frames=2)) == ["", said.format("unused")]


def test_what_an_edit_has_drawn_has_the_values_that_it_has(tmp_path) -> None:
    drawn = {"do": "plank", "name": "arm", "from": [-0.49, 0, 0.3], "to": [0.49, 0, 0.3], "width": [0, 0.1, 0]}
    events = drawn, put("planks.arm.thickness", 0.02), put("planks.arm.thickness", 0.018)
    assert notes(tmp_path, *events)[1:] == ["", ""]


def test_a_limit_is_none_of_the_piece(tmp_path) -> None:
    assert notes(tmp_path, put("parameters.most", "9 kg"), put("quantities.heavy.max", "7 kg")) == ["", ""]


@pytest.mark.slow
def test_a_formula_whose_place_a_suggestion_took_is_followed_no_more(tmp_path) -> None:
    # The bench weighs more than it may: thinner planks take the place of the formula of their thickness.
    scene = write_bench(
        tmp_path, BENCH.replace("thickness = 0.02", 'thickness = "0.5*t + 0.5*t"') + RAIL.replace("8 kg", "5 kg")
    )
    replay = make_replay(scene)
    first = next(iter(replay.frames()))
    number = next(k for k, one in enumerate(replay.session.design.suggestion_list.found, 1) if one.settings)
    assert first["suggested"] >= number
    events = [{"do": "choose", "number": number}, put("parameters.t", "22 mm")]
    chosen, said = [row["note"] for row in make_replay(scene, write_edits(tmp_path, *events)).frames()][1:]
    assert "it takes the place of the formula '0.5*t + 0.5*t'" in chosen
    assert said == "parameters.t changes nothing: no formula uses it now"


@pytest.mark.parametrize(
    ("key", "value", "said"),
    [
        ("weights.cat", {"on": "rail", "mass": 5}, "weights: this adds cat, .*the event weight puts one on"),
        ("weights", {}, "weights: this removes .*delete removes one"),
        ("planks.shelf", {"from": [-0.4, 0, 0.1], "to": [0.4, 0, 0.1], "width": [0, 0.1, 0]}, "the event plank draws"),
        ("joints.nailed", {"plank": "rail", "end": "-x", "to": "left", "face": "-z"}, "the event connect joins"),
    ],
)
def test_what_events_make_is_not_set(tmp_path, key, value, said):
    """It would be in the scene, and not in the piece."""
    scene = write_bench(tmp_path, BENCH.replace("thickness = 0.02", 'thickness = "t"') + RAIL)
    rows = [dict(row) for row in make_replay(scene, write_edits(tmp_path, put(key, value), {"do": "undo"})).frames()]
    assert re.search(said, rows[1]["refused"]) and rows[2]["refused"] == "there is nothing to undo"
