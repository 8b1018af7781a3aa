"""What a piece shows at the hand: ranges, suggestions, forces of feet, joints that break."""

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from marked_edits import frames_of, last_marks, rows_with_and_without
from restshape_apps.furniture.guidance.suggested import SuggestionList
from restshape_apps.furniture.guidance.valid_ranges import decode_ranges
from restshape_apps.furniture.marks.offer_marks import OfferMarks
from restshape_apps.furniture.marks.range_marks import range_lines
from restshape_apps.furniture.physics.furniture import Furniture

import restshape
from restshape.live.shown_marks import Offer, Words

TABLE = Path(__file__).parents[1] / "scenes" / "table.toml"


@pytest.fixture(scope="module")
def table():
    with restshape.open(restshape.load(TABLE)) as simulation:
        yield simulation


def test_the_range_under_the_hand_is_that_of_the_row(table):
    with table.press("leg-4", parameter="length y") as hand:
        hand.by(0.03)
        marks, row = last_marks(table), table.frame.row
        (found,) = decode_ranges(row["valid_ranges"]).ranges
        inside, outside, here = (marks[name] for name in ("valid range", "outside the valid range", "as it is"))
        axis = np.array([0.0, 1.0, 0.0])
        along = (inside.points - here.points) @ axis
        # A plank that grows goes half as far at its end.
        assert np.allclose(np.abs(along), 0.5 * np.abs(np.array([found.low, found.high]) - 0.03), atol=1e-6)
        assert np.allclose(outside.points[-1], inside.points[0]) and here.meaning == "outside"
        assert inside.words == [f"{1e3 * found.low:.1f}".removesuffix(".0") + " mm to 550 mm or beyond"]
        hand.by(0.05)
        assert last_marks(table)["as it is"].meaning == "inside"
    table.undo()


def test_the_line_of_a_plank_goes_through_where_it_was_taken(table):
    at = [0.325, 0.2, 0.35]
    with table.press("leg-4", at=at) as hand:
        hand.to(0.325, 0.23, 0.35)
        marks = last_marks(table)
        assert np.allclose(marks["as it is"].points, [[0.325, 0.23, 0.35]])
        assert np.allclose(marks["outside the valid range"].points[:, [0, 2]], [0.325, 0.35])
    table.undo()


def test_feet_bear_the_loads_and_the_planks(table):
    marks = last_marks(table)
    weight = table.replay.analysis.design.furniture.geometry().mass.sum() * 9.80665
    load = marks["loads"].vectors.sum(axis=0)
    assert marks["forces of feet"].vectors.sum(axis=0) == pytest.approx(-load + [0.0, 0.0, weight], abs=1e-6)
    assert marks["loads"].words == ["weight 490 N"]


def test_the_joint_that_breaks_is_named_with_its_utilisation(table):
    (words,) = last_marks(table)["joints that break"].words
    assert words == "leg-4 on top: 1.29" and table.frame.row["utilisation"] == pytest.approx(1.29, abs=0.01)
    said = {one.text: one.meaning for one in last_marks(table).values() if isinstance(one, Words)}
    assert said["weak: joint leg-4 on top at 1.29 of its strength"] == "limit"


def test_suggestions_are_offers_that_can_be_chosen_and_slid_along(table):
    offers = [one for one in last_marks(table).values() if isinstance(one, Offer)]
    assert len(offers) == table.frame.row["suggested"] == 4
    assert [offer.slide is None for offer in offers] == [False, False, True, True]
    turned = offers[0].lines[0]
    assert turned.words == ["leg-4"] and len(turned.points) == 16
    (choose,) = offers[0].events
    (frame,) = frames_of(table, choose)
    (along,) = (one for one in last_marks(table).values() if isinstance(one, Offer))
    assert np.allclose(turned.points.max(axis=0), frame.mesh.points[32:40].max(axis=0))
    (frame,) = frames_of(table, along.slide | {along.slid: 0.5})
    assert not frame.refused and "joints that break" not in last_marks(table)
    table.undo()
    table.undo()


def test_a_suggestion_that_only_overloads_joints_more_is_not_offered(table):
    design = table.replay.analysis.design
    longer = next(one for one in design.suggestion_list.found if "longer" in one.words)
    worse = replace(longer, t=-0.05, valid=False, rest="weak")
    found = SuggestionList((worse, longer))
    offers = OfferMarks()(design, found, None, Furniture(design.piece, design.furniture.compliance))
    assert [one.events for one in offers] == [({"do": "choose", "number": 2},)]


def test_where_nothing_is_valid_the_line_says_so(table):
    with table.press("leg-4", parameter="length y"):
        under = table.replay.analysis.design_direction
        at, along = np.zeros(3), np.array([0.0, 1.0, 0.0])
        nothing = SimpleNamespace(low=-0.2, high=0.3, unit="m", doubtful=(), ranges=SimpleNamespace(intervals=()))
        (line,) = range_lines(nothing, at, along)
        assert line.words == ["nothing valid along this drag"] and line.meaning == "limit"
        assert len(range_lines(under, at, along)) >= 2


@pytest.mark.slow
def test_marks_change_no_row():
    events = [
        {"do": "choose", "number": 1},
        {"do": "slide", "to": 0.5},
        {"do": "press", "on": "leg-4", "parameter": "length y"},
        {"do": "drag", "by": 0.03},
    ]
    scene = restshape.load(TABLE, "effects.guidance.freedoms=1", "effects.guidance.suggestions=1")
    marked, plain = rows_with_and_without(scene, events)
    assert len(plain) == 4 and marked == plain


def test_planks_that_move_are_the_same_cells_at_other_places(table):
    before = table.replay.solver.space
    with table.press("leg-4", parameter="length y") as hand:
        hand.by(0.03)
        after = table.replay.solver.space
        assert after is not before and after.cells is before.cells and not np.array_equal(after.X, before.X)
    table.undo()
