"""What a frame of a dragged plank costs, by counts of calls; short cuts lead to the same."""

import numpy as np
import pytest
from counted_calls import called
from restshape_apps.furniture.guidance.amounts import leading_parameter, parameters
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.marks.piece_marks import piece_marks
from restshape_apps.furniture.pieces import SCENES, drawn

import restshape
from restshape.interface.scripts import WrittenScript

PLACES = [(0.41 + 0.001 * step, 0.19 + 0.0005 * step * step, 0.2) for step in range(10)]


def test_a_frame_of_a_drag_and_its_marks_call_little():
    sim = restshape.open(restshape.load(SCENES / "table.toml"), strict=False)
    hand, frames, marks = sim.press("leg-4", at=[0.4, 0.2, 0.2]), [], []
    for place in PLACES:
        frames.append(called(lambda place=place: hand.to(*place)))
        marks.append(called(lambda: piece_marks(sim)))
    sim.close()
    assert 500 < np.median(frames) <= 1000
    assert 100 < np.median(marks) <= 415


def test_a_plank_that_is_dragged_on_is_the_event_that_would_be_read():
    scene = restshape.load(SCENES / "table.toml")
    written, read = (WrittenScript(scene) for _ in range(2))
    for one in (written, read):
        one.add("press", {"on": "leg-4", "at": [0.4, 0.2, 0.2]})
        one.add("drag", {"to": [0.41, 0.2, 0.2]})
    quick, slow = written.moved_on([0.42, 0.19, 0.2]), read.follow({"t": read.t, "do": "drag", "to": [0.42, 0.19, 0.2]})
    assert quick == slow and type(quick) is type(slow) and quick.model_dump() == slow.model_dump()
    assert written.text() == read.text()
    # What a parameter is dragged by is no place.
    assert written.add("drag", {"to": [0.4, 0.2, 0.2], "frames": 3}) and written.moved_on([0.4, 0.2, 0.2]) is None


@pytest.mark.parametrize("name", ["table", "chair-1", "shelf-2"])
def test_corners_and_what_leads_are_found_from_numbers_alone(name: str):
    design, rng = Design.closed(drawn(name), Guidance()), np.random.default_rng(3)
    for _ in range(5):
        gamma = np.zeros((len(design.piece.planks), 8))
        for plank, number in design.freedoms:
            gamma[plank, number] = 0.02 * rng.normal()
        planks = design.furniture.moved(gamma).planks
        assert np.array_equal(design.furniture.corners(gamma), np.concatenate([one.corners() for one in planks]))
        assert leading_parameter(design.piece, gamma) == parameters(design.piece, gamma)[0]
    # Of parameters that change as much the first one leads.
    gamma[:] = 0.0
    gamma[2, 1] = gamma[1, 0] = -1.0
    assert leading_parameter(design.piece, gamma) == (1, 0)
