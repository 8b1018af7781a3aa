"""What a vibrating body shows at the hand: its resonance curve, and the motion of the last frames."""

from pathlib import Path

import numpy as np
import pytest
from marked_edits import last_marks, rows_with_and_without
from restshape_apps.vibration.harmonic_sweep import modal_sweep, sweep
from restshape_apps.vibration.stage import structure_of

import restshape
from restshape.analysis.motion.modes_beside import present_modes

BUILDING = Path(__file__).parents[1] / "scenes" / "building.toml"
COARSE = ("mesh.size='2 m'", "mesh.order=1", "effects.dynamics.steps=4")


@pytest.fixture(scope="module")
def building():
    with restshape.open(restshape.load(BUILDING, *COARSE)) as simulation:
        yield simulation


def test_the_curve_peaks_at_the_first_mode_and_marks_the_excitation(building):
    chart = last_marks(building)["resonance curve"]
    frequencies, amplitudes = chart.curves["amplitude, sway"]
    assert chart.at["excitation"] == 2.5 and chart.logarithmic
    assert frequencies[amplitudes.argmax()] == pytest.approx(chart.at["mode 1"], rel=1e-3)
    assert frequencies[-1] > max(chart.at.values())


def test_modes_give_the_curve_of_direct_solves_near_resonances(building):
    analysis, scene = building.replay.analysis, building.scene
    shape, modes = structure_of(analysis, scene), present_modes(analysis, 8)
    by_modes = modal_sweep(shape, modes, 1.0, 4.0, 4)
    direct = sweep(shape, by_modes.frequencies)
    for name, values in direct.relative.items():
        assert np.allclose(by_modes.relative[name], values, rtol=0.01, atol=1e-3 * np.abs(values).max())
        assert np.allclose(by_modes.transmissibility[name], direct.transmissibility[name], rtol=0.02)


def test_the_motion_is_that_of_the_rows(building):
    building.idle(frames=1)
    last_marks(building)
    building.idle(frames=1)
    time, sway = last_marks(building)["motion of the last frames"].curves["sway"]
    assert time[-1] == building.frame.row["time"] and sway[-1] == building.frame.quantities["sway"]
    assert (np.diff(time) > 0.0).all() and len(time) >= 3


def test_marks_change_no_row_of_a_motion():
    events = [
        {"do": "press", "on": "roof"},
        {"do": "drag", "to": [4.0, 20.2], "frames": 2},
        {"do": "release"},
        {"do": "idle", "frames": 1},
    ]
    marked, plain = rows_with_and_without(restshape.load(BUILDING, *COARSE), events)
    assert len(plain) == 5 and marked == plain
