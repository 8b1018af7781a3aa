"""What cloth shows at the hand: supports, seams, contact, stretch, and whether it is in equilibrium."""

from pathlib import Path

import numpy as np
import pytest
from marked_edits import last_marks, rows_with_and_without

import restshape

SCENES = Path(__file__).parents[1] / "scenes"


@pytest.mark.slow
def test_cloth_on_a_ball_touches_it_where_its_dots_are():
    scene = restshape.load(SCENES / "sphere.toml", "mesh.size='120 mm'", "mesh.levels=1")
    with restshape.open(scene) as simulation:
        marks, row = last_marks(simulation), simulation.frame.row
        dots = marks["touches a body"]
        centre = np.array([row[f"bodies.ball.sphere.center.{k}"] for k in range(3)])
        away = np.linalg.norm(dots.points + dots.moved - centre, axis=1) - row["bodies.ball.sphere.radius"]
        assert len(away) >= 8 and (away < scene.effects["contact"]["thickness"]).all()
        assert any(text.startswith("in equilibrium: residual ") for text in marks)
        assert any(text == f"stretched most: {100.0 * row['max_strain']:.2g} %" for text in marks)


def test_pins_are_supports_that_stay_where_they_are():
    scene = restshape.load(SCENES / "pins.toml", "mesh.size='80 mm'")
    with restshape.open(scene) as simulation:
        marks = last_marks(simulation)
        for name in scene.supports:
            pin = marks[f"support {name}"]
            assert pin.meaning == "support" and pin.nodes.shape == (1, 1)
            assert not simulation.frame.displacement[pin.nodes[:, 0], 2].any()


@pytest.mark.slow
@pytest.mark.parametrize("predict", ["none", "linear"])
def test_marks_change_no_row_of_cloth(predict):
    scene = restshape.load(SCENES / "pins.toml", "mesh.size='150 mm'")
    events = [{"do": "press", "on": "c"}, {"do": "drag", "to": [0.52, 0.0], "frames": 2}, {"do": "release"}]
    marked, plain = rows_with_and_without(scene, events, predict)
    assert len(plain) == 4 and marked == plain
