"""What solids show at the hand: the load factor where the mode moves most."""

from pathlib import Path

import numpy as np
import pytest
from marked_edits import last_marks, rows_with_and_without

import restshape
from restshape.live.shown_marks import Words

EULER = Path(__file__).parents[1] / "scenes" / "euler.toml"


def test_a_column_on_pins_buckles_in_its_middle_below_its_load():
    with restshape.open(restshape.load(EULER)) as simulation:
        (words,) = (one for one in last_marks(simulation).values() if isinstance(one, Words) and "buckles" in one.text)
        factor, points = simulation.frame.row["mu_1"], simulation.frame.mesh.points
        assert words.text == f"buckles at {factor:.3g} times its load"
        assert words.meaning == ("limit" if factor < 1.0 else "guide")
        low, high = points.min(axis=0), points.max(axis=0)
        along = int(np.argmax(high - low))
        assert words.at[along] == pytest.approx(0.5 * (low + high)[along], abs=0.1 * (high - low)[along])


def test_marks_change_no_row_of_buckling():
    events = [{"do": "set", "key": "material.steel.E", "value": "200 GPa"}, {"do": "idle", "frames": 1}]
    scene = restshape.load(EULER)
    name = next(iter(scene.material))
    events[0]["key"] = f"material.{name}.E"
    marked, plain = rows_with_and_without(scene, events)
    assert len(plain) == 2 and marked == plain
