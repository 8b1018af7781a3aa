"""Ranges of suggestions are the parts without doubt, and those of slides along them."""

import json

import pytest
from restshape_apps.furniture.guidance.valid_ranges import decode_ranges
from restshape_apps.furniture.tests.furniture_scenes import HEAD, write_edits
from small_scenes import make_replay

STEP = """
[wood]
name = "pine"
thickness = "24 mm"
[fastener]
name = "screw"
spacing = "40 mm"
[planks]
sideL = { from = [-0.2, 0, 0], to = [-0.2, 0, 0.44], width = [0, 0.4, 0] }
sideR = { from = [0.2, 0, 0], to = [0.2, 0, 0.44], width = [0, 0.4, 0] }
top = { from = [-0.25, 0.08, 0.452], to = [0.25, 0.08, 0.452], width = [0, 0.24, 0] }
tread = { from = [-0.188, -0.1, 0.232], to = [0.188, -0.1, 0.232], width = [0, 0.2, 0] }
[weights.person]
on = "tread"
mass = "95 kg"
at = [0, -0.4, 0.5]
[pushes.climb]
on = "top"
force = [0, "-120 N", 0]
at = [0, -0.5, 0.5]
[effects.gravity]
[effects.push]
"""
"""A stool with a step that tips over when someone climbs."""


def slid(tmp_path, number: int, frames: int = 6) -> list[dict]:
    """Rows of a suggestion that is chosen and slid along to the end of its range."""
    events = {"do": "choose", "number": number}, {"do": "slide", "to": 1, "frames": frames}
    (tmp_path / "step.toml").write_text(HEAD + STEP)
    script = write_edits(tmp_path, *events, scene="step.toml")
    return list(make_replay(tmp_path / "step.toml", script=script).frames())


@pytest.mark.parametrize("number", [1, 2, 3, 4])
def test_a_slide_to_the_end_of_a_range_is_without_doubt(tmp_path, number: int) -> None:
    first, chosen, *rows = slid(tmp_path, number)
    listed = json.loads(first["suggestions"])[number - 1]
    assert listed["valid"] and not listed.get("doubt")
    assert {row["constraint_status"] for row in (chosen, *rows)} == {"holds"}
    assert all(row["inside"] == 1 for row in rows)
    hand = decode_ranges(rows[-1]["valid_ranges"])
    low, high = listed["range"]
    # The range under the hand has the suggestion's within it, with what is doubtful beyond its end.
    assert any(one.low <= low + 1e-6 and high <= one.high + 1e-6 for one in hand.ranges)
    assert all(right <= low + 1e-4 or high - 1e-4 <= left for left, right in hand.doubtful)


def test_a_range_ends_where_a_joint_loses_the_fastener_that_bears_its_twist(tmp_path) -> None:
    # Three screws, 40 mm apart, bear the step's twist, two do not: it is 200 mm wide, and may lose 80 mm.
    first, *_ = slid(tmp_path, 1, 1)
    shorter = json.loads(first["suggestions"])[0]
    assert shorter["words"].startswith("tread ") and "shorter along its y" in shorter["words"]
    assert shorter["range"][1] == pytest.approx(0.08, abs=1e-6)
    # It would hold, in doubt, to 120 mm.
    assert not shorter["beyond"]


def test_a_suggestion_says_which_weights_it_takes_along(tmp_path) -> None:
    first, chosen, *_ = slid(tmp_path, 1, 1)
    one, other, *_ = json.loads(first["suggestions"])
    # The person stands at -0.4 of the width, which both ends lose alike.
    assert one["words"].endswith(f"; person taken {400 * one['t']:.3g} mm towards +y")
    assert f"person taken {400 * one['t']:.3g} mm towards +y" in chosen["note"]
    # Whoever stands on a plank that is moved goes with it: no more is said.
    assert other["words"].startswith("tread moved") and "person" not in other["words"]


def test_a_drag_of_a_length_says_which_weights_it_has_taken_along(tmp_path) -> None:
    (tmp_path / "step.toml").write_text(HEAD + STEP)
    drag = {"do": "press", "on": "tread", "parameter": "length y"}, {"do": "drag", "by": 0.05}, {"do": "release"}
    script = write_edits(tmp_path, *drag, scene="step.toml")
    rows = list(make_replay(tmp_path / "step.toml", script=script).frames())
    assert [row["note"] for row in rows[-3:]] == ["", "", "person taken 20 mm towards -y"]
