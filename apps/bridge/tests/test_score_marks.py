"""What a bridge shows at the hand: its score, and how near the limit is."""

from pathlib import Path

import pytest
from marked_edits import last_marks, rows_with_and_without

import restshape
from restshape.live.shown_marks import NodeValue, Words

BRIDGE = Path(__file__).parents[1] / "scenes" / "bridge.toml"
COARSE = "mesh.size='500 mm'"


@pytest.mark.parametrize(("limit", "meaning"), [("18 MPa", "guide"), ("5 MPa", "limit")])
def test_the_score_is_the_area_beside_the_use_of_the_limit(limit, meaning):
    scene = restshape.load(BRIDGE, COARSE, f"quantities.strength.max='{limit}'")
    with restshape.open(scene) as simulation:
        marks, found = last_marks(simulation), simulation.frame.quantities
        use = 100.0 * found["strength"] / scene.quantities["strength"].max
        words = marks[f"score {found['score']:.4g} m²; strength is at {use:.0f} % of its limit"]
        assert words.meaning == meaning
        if meaning == "guide":
            assert isinstance(marks["strength"], NodeValue)
        else:
            assert any(isinstance(one, Words) and one.text.startswith("strength ") and one.at for one in marks.values())


def test_marks_change_no_row_of_a_bridge():
    events = [
        {"do": "press", "on": "underside", "at": [10, 1.6]},
        {"do": "drag", "to": [10, 1.7], "frames": 2},
        {"do": "release"},
    ]
    marked, plain = rows_with_and_without(restshape.load(BRIDGE, COARSE), events)
    assert len(plain) == 4 and marked == plain
