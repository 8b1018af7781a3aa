"""Ends that miss what they were meant to meet: the first suggestion is the length with which they meet it."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.guidance.lengthening import NAME, lengthenings
from restshape_apps.furniture.physics import plank_findings
from restshape_apps.furniture.physics.plank_phrases import phrases
from restshape_apps.furniture.pieces import drawn
from restshape_apps.furniture.shape.free_ends import free_ends
from restshape_apps.furniture.shape.plank_scene import piece_of
from restshape_apps.furniture.shape.planks import Piece, parts_of
from restshape_apps.furniture.tests.furniture_scenes import rail_stool, write_edits
from small_scenes import make_replay

from restshape.scene.load import load_scene


def written(tmp_path: Path, start: float, end: float, low: float = 0.0) -> Path:
    path = tmp_path / "stool.toml"
    path.write_text(rail_stool(start, end, low))
    return path


def drawn_with(tmp_path: Path, planks: str, start: float, end: float) -> Piece:
    """The stool with more planks [m]."""
    path = written(tmp_path, start, end)
    path.write_text(path.read_text().replace("[weights.sitter]", f"{planks}\n[weights.sitter]"))
    return piece_of(load_scene(path))


def second_rail(start: float, end: float) -> str:
    return f"""[planks.upper]
from = [{start!r}, 0, 0.35]
to = [{end!r}, 0, 0.35]
width = [0, 0.1, 0]
"""


def stool(tmp_path: Path, start: float, end: float, low: float = 0.0) -> Design:
    return Design.closed(piece_of(load_scene(written(tmp_path, start, end, low))), Guidance())


def rail(piece: Piece) -> tuple[float, float]:
    """Where the rail's ends are along x [m]."""
    plank = piece.planks[piece.index("rail")]
    return tuple(sorted(float(plank.end(side)[0]) for side in (0, 1)))


@pytest.mark.parametrize(
    ("start", "end", "words"),
    [
        (-0.141, 0.117, "rail 24 mm longer at its end +x, to meet right"),
        (-0.121, 0.117, "rail 20 mm longer at its end -x and 24 mm longer at its end +x, to meet left and right"),
        (-0.101, 0.121, "rail 40 mm longer at its end -x and 20 mm longer at its end +x, to meet left and right"),
        (-0.141, 0.171, "rail 30 mm shorter at its end +x, to meet right"),
    ],
)
def test_a_rail_that_misses_a_leg_is_first_lengthened_to_meet_it(tmp_path, start: float, end: float, words: str):
    design = stool(tmp_path, start, end)
    assert not design.furniture.test().valid
    first = design.suggestion_list.found[0]
    assert first.valid and first.kind == NAME and first.words == words
    assert rail(first.piece) == pytest.approx((-0.141, 0.141), abs=1e-9)
    assert len(parts_of(first.piece)) == 1 and first.piece.joints != design.piece.joints


def test_moves_that_leave_an_end_free_come_after(tmp_path):
    found = stool(tmp_path, -0.121, 0.117).suggestion_list.found
    moves = [one for one in found if one.kind == "a part joined"]
    assert [one.free for one in moves] == [1] * len(moves) and moves
    assert found[0].free == 0


def test_lengthenings_that_do_not_hold_push_out_nothing_that_does(tmp_path):
    # Two rails that miss a leg each, and a light stool that a shove throws over whether they meet it or not.
    piece = drawn_with(tmp_path, second_rail(-0.141, 0.117), -0.141, 0.117)
    (sitter,), (shove,) = piece.weights, piece.pushes
    sitter, shove = replace(sitter, force=(0.0, 0.0, -200.0)), replace(shove, force=(100.0, 0.0, 0.0))
    light = replace(piece, weights=(sitter,), pushes=(shove,))
    found = {most: Design.closed(light, Guidance(suggestions=most)).suggestion_list.found for most in (1, 2, 8)}
    assert any(one.kind == NAME and not one.valid for one in found[8])
    for most, shown in found.items():
        valid = [one.valid for one in shown]
        assert valid[0] and valid == sorted(valid, reverse=True), most


STOP = """
[planks.stop]
from = [0.125, -0.1, 0.07]
to = [0.125, 0.13, 0.07]
width = [0.01, 0, 0]

[planks.peg]
from = [PEG, 0, 0.07]
to = [0.11, 0, 0.07]
width = [0, 0, 0.04]
"""
"""A peg short of the right leg, whose way a stop bars: it ends at -0.141 m at the left leg, or short of that too."""


@pytest.mark.parametrize("peg", [-0.141, -0.121])
def test_an_end_that_cannot_be_joined_bars_no_others(tmp_path, peg: float):
    rails = second_rail(-0.121, 0.121)
    more, alone = (
        drawn_with(tmp_path, planks, -0.121, 0.121) for planks in (rails + STOP.replace("PEG", repr(peg)), rails)
    )
    both = "20 mm longer at its end -x and 20 mm longer at its end +x, to meet left and right"
    expected = {f"{name} {both}" for name in ("upper", "rail")}
    assert expected in [set(one.words.split("; ")) for one in lengthenings(alone)]
    own = {"peg 20 mm longer at its end -x, to meet left"} if peg > -0.141 else set()
    assert expected | own in [set(one.words.split("; ")) for one in lengthenings(more)]


def test_a_leg_above_the_floor_is_lengthened_to_stand_on_it(tmp_path):
    design = stool(tmp_path, -0.141, 0.141, low=0.05)
    one = next(one for one in lengthenings(design.piece))
    assert one.words == "right 50 mm longer at its end -x, to meet the floor" and one.flaws == 0
    assert {foot.plank for foot in one.piece.feet} == {1, 2}
    assert np.linalg.norm(one.way) == pytest.approx(0.05)


@pytest.mark.parametrize("friction", [0.6, 0.1])
def test_a_stool_above_the_floor_is_lengthened_to_stand_on_it(tmp_path, friction: float):
    # On a slippery floor it still slides under the push, but does not fall under its weights.
    path = written(tmp_path, -0.141, 0.141, low=0.05)
    text = path.read_text().replace("from = [-0.15, 0, 0]", "from = [-0.15, 0, 0.05]")
    path.write_text(text.replace("friction = 0.6", f"friction = {friction}"))
    design = Design.closed(piece_of(load_scene(path)), Guidance())
    assert not design.piece.feet and len(design.furniture.test().found.falls) == 2
    first = design.suggestion_list.found[0]
    legs = "left 50 mm longer at its end -x, to meet the floor; right 50 mm longer at its end -x, to meet the floor"
    assert first.words == legs and not design.suggestion_list.why
    assert first.valid == (friction > 0.5) and first.rest.startswith("" if first.valid else "slides under push shove (")


def test_a_lengthening_is_chosen_like_others(tmp_path):
    scene = written(tmp_path, -0.121, 0.117)
    script = write_edits(tmp_path, {"do": "choose", "number": 1})
    rows = list(make_replay(scene, script).frames())
    assert [row["constraint_status"] for row in rows] == ["fails", "holds"]


@pytest.mark.parametrize("name", ["table", "shelf-1", "chair-1", "scales"])
def test_pieces_without_free_ends_have_none(name: str):
    assert lengthenings(drawn(name)) == ()


def test_a_rail_lengthened_to_its_leg_touches_it_and_is_to_be_connected(tmp_path) -> None:
    # The stool's legs have faces at x = -0.141 and 0.141 m; the rail ends 24 mm before the right one.
    scene = written(tmp_path, -0.141, 0.117)
    scene.write_text(re.sub(r"\nforce = .*", "\nforce = [1, 0, 0]", scene.read_text()))
    events = (
        {"do": "press", "on": "rail", "parameter": "length x"},
        {"do": "drag", "by": "24 mm", "frames": 1},
        {"do": "release"},
        {"do": "connect", "on": "rail"},
    )
    *_, touching, joined = make_replay(scene, write_edits(tmp_path, *events)).frames()
    assert touching["violated_constraints"] == "free end: rail +x touches right, not joined: connect rail"
    suggestion, *_ = json.loads(touching["suggestions"])
    assert suggestion["words"] == "rail connected to right, which its end +x touches"
    assert joined["constraint_status"] == "holds" and "rail on right" in joined["note"]


def test_what_joints_reach_is_to_be_connected(tmp_path) -> None:
    piece = piece_of(load_scene(written(tmp_path, -0.141, 0.135)))
    (joint,) = (one for one in piece.joints if piece.planks[one.i].name == "rail" and one.side == 1)
    apart = replace(piece, joints=tuple(one for one in piece.joints if one is not joint))
    (one,) = free_ends(apart)
    assert one.words(apart) == "rail +x is free: 6 mm from right, not joined; connect rail"
    assert "rail +x is 6 mm from right, not joined: connect rail" in phrases(plank_findings.free(apart, [one]))[0]
