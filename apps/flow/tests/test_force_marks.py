"""What a flow shows at the hand: the force on a body."""

from pathlib import Path

import numpy as np
from marked_edits import last_marks, rows_with_and_without

import restshape
from restshape.live.shown_marks import Arrows

FLOW = Path(__file__).parents[1] / "scenes" / "steady_flow.toml"


def test_the_arrow_on_a_body_has_its_drag_and_lift():
    with restshape.open(restshape.load(FLOW)) as simulation:
        (arrow,) = (one for one in last_marks(simulation).values() if isinstance(one, Arrows))
        found = simulation.frame.quantities
        assert arrow.vectors.tolist() == [[found["drag"], found["lift"]]] and arrow.unit == ""
        assert arrow.words[0].startswith("drag ") and ", lift " in arrow.words[0]
        assert np.isfinite(arrow.points).all()


def test_marks_change_no_row_of_a_flow():
    events = [{"do": "rotate", "on": "body", "by": 0.05, "frames": 2}, {"do": "idle", "frames": 1}]
    marked, plain = rows_with_and_without(restshape.load(FLOW), events)
    assert len(plain) == 3 and marked == plain
