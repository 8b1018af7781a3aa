"""What a cantilever shows at the hand: its goal, and where it is farthest from it."""

from pathlib import Path

import numpy as np
import pytest
from marked_edits import last_marks, rows_with_and_without
from restshape_apps.cantilever.miss_marks import nearest_on

import restshape

BEAM = Path(__file__).parents[1] / "scenes" / "cantilever.toml"
COARSE = "mesh.size='100 mm'"


def test_the_line_to_the_goal_is_as_long_as_the_farthest_place_is_away():
    with restshape.open(restshape.load(BEAM, COARSE)) as simulation:
        marks, scene = last_marks(simulation), simulation.scene
        corners = np.array(scene.sections["goal"]["wing"].polyline)
        goal, line = marks["goal wing"], marks["farthest from wing"]
        assert goal.meaning == "goal" and all((goal.points == corner).all(axis=1).any() for corner in corners)
        here, there = line.points + line.moved
        far = simulation.frame.quantities["farthest"]
        assert np.hypot(*(there - here)) == pytest.approx(far, rel=1e-9)
        assert np.hypot(*(nearest_on(goal.points, there) - there)) < 1e-12
        assert any(text.startswith("miss ") and "; farthest " in text for text in marks)


def test_marks_change_no_row_of_a_beam():
    events = [{"do": "press", "on": "b"}, {"do": "drag", "to": [2.0, 0.02], "frames": 2}, {"do": "release"}]
    marked, plain = rows_with_and_without(restshape.load(BEAM, COARSE), events)
    assert len(plain) == 4 and marked == plain
