"""What is still wrong with a suggestion, why there is none, and why a plank cannot move, in words."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.physics.furniture import UNSTABLE, WEAK, Furniture
from restshape_apps.furniture.pieces import scales, table
from restshape_apps.furniture.shape.planks import FREEDOMS


def test_what_holds_in_part_reports_what_is_still_wrong() -> None:
    # A leg beside the top, and a mass that the joints do not bear either.
    piece = table(kilograms=200.0)
    gamma = np.zeros((len(piece.planks), 8))
    gamma[piece.index("leg-1"), 1] = -0.2
    design = Design(Furniture(piece).moved(gamma))
    suggestion_list = design.suggestion_list.found
    assert suggestion_list and not any(suggestion.valid for suggestion in suggestion_list)
    for suggestion in suggestion_list:
        assert suggestion.rest.startswith("weak: joint") and suggestion.rest in suggestion.summary
        found = Furniture(design.furniture.moved(suggestion.t * suggestion.direction)).test()
        assert found.flaws == WEAK
        assert suggestion.range_words.startswith("nothing more is wrong from")


def test_a_suggestion_that_mends_all_reports_nothing_more() -> None:
    suggestion_list = Design(table()).suggestion_list.found
    assert suggestion_list and all(
        suggestion.valid and suggestion.rest == "" and "still wrong" not in suggestion.summary
        for suggestion in suggestion_list
    )


def test_a_piece_that_nothing_stands_under_is_reported_so() -> None:
    design = Design(replace(scales(), feet=()))
    assert design.furniture.test().flaws & UNSTABLE
    assert design.suggestion_list.found == ()
    assert design.suggestion_list.why.startswith("nothing stands on the floor")


def test_a_weak_piece_without_a_suggestion_is_answered_by_what_else_helps() -> None:
    suggestion_list = Design(scales(kilograms=400.0), Guidance(freedoms=1)).suggestion_list
    assert not suggestion_list.found
    said = "closer or other fasteners and thicker planks do not help either; a lighter load may"
    assert suggestion_list.why.endswith(said)
    # Such words must have room in a recording.
    assert len(suggestion_list.why) <= 240


@pytest.mark.parametrize("make", [table, scales])
def test_a_fixed_parameter_reports_what_is_free_instead(make) -> None:
    design = Design(make())
    reported = [
        (plank, number, design.why_fixed(plank, number))
        for plank in range(len(design.piece.planks))
        for number in range(8)
        if (plank, number) not in design.freedoms
    ]
    assert reported
    for plank, _, why in reported:
        assert why.startswith(f"{design.piece.planks[plank].name} cannot ")
        free = why.rpartition("; free: ")[2].split(", ")
        named = [(plank, FREEDOMS.index(name)) for name in free if name in FREEDOMS]
        assert named == sorted(one for one in design.freedoms if one[0] == plank)
    assert any("(lost: " in why for _, _, why in reported)
