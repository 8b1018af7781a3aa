"""Strouhal numbers: periods of made signals, and where there are none."""

import numpy as np
import pytest
from flow_scenes import CYLINDER
from restshape_studies.stability.scenery import make_replay, set_value, write_scene, write_script
from restshape_verification.flow.scenes import HEAD, SQUARE, STEADY, disc, in_time
from thermal_scenes import solved

from restshape.physics.flow.swing import Swing

EVEN = np.arange(0.0, 10.0, 0.01)
UNEVEN = np.cumsum(np.random.default_rng(0).uniform(0.005, 0.02, 800))


def period(values, times=EVEN):
    swing = Swing()
    for time, value in zip(times, values):
        swing = swing.after(float(time), float(value))
    return swing.period


def wave(times, length=0.331):
    return np.sin(2 * np.pi * times / length)


@pytest.mark.parametrize("times", [EVEN, UNEVEN])
@pytest.mark.parametrize("mean", [0.0, -7.0])
def test_the_period_of_a_made_signal(times, mean):
    assert period(mean + 0.4 * wave(times), times) == pytest.approx(0.331, rel=1e-4)


def test_the_last_full_cycles_count():
    """A swing that grows, one that becomes slower, and one with a slow drift."""
    assert period(1e-6 * np.exp(EVEN) * wave(EVEN)) == pytest.approx(0.331, rel=1e-3)
    slower = np.where(EVEN < 4.0, wave(EVEN), wave(EVEN - 4.0, 0.6))
    assert period(slower) == pytest.approx(0.6, rel=1e-3)
    assert period(wave(EVEN) + 0.5 * EVEN) == pytest.approx(0.331, rel=5e-3)


@pytest.mark.parametrize(
    "values",
    [
        np.zeros_like(EVEN),
        1.0 - np.exp(-EVEN),
        4e-4 * wave(EVEN),
        wave(EVEN) * (EVEN < 8.0),
        wave(EVEN**2, 20.0) * (EVEN > 8.0),
        np.where(EVEN < 0.6, wave(EVEN), 1.0),
    ],
)
def test_what_does_not_swing_has_no_period(values):
    assert np.isnan(period(values))


@pytest.mark.slow
def test_a_lift_that_swings_with_the_stream_has_its_period(tmp_path):
    """A stream that turns up and down once a second; steps change on the way, and so does the mesh."""
    text = HEAD + SQUARE + disc("body", (0.4, 0.5), 0.15) + "[fluid]\nrho = 1\nmu = 0.05\n"
    text += '[boundary.sides]\non = "outline"\nvelocity = [1, "0.3*sin(2*pi*t)"]\n' + in_time(0.05)
    text += '[quantities]\nst = { strouhal = { speed = 2, length = 0.3 }, at = "body" }\n[mesh]\nsize = 0.2\n'
    events = [{"do": "idle", "frames": 45}, *set_value("effects.flow.time_step", 0.04), {"do": "idle", "frames": 25}]
    events += [*set_value("mesh.size", 0.19), {"do": "idle", "frames": 40}]
    rows = [dict(row) for row in make_replay(write_scene(tmp_path, text), write_script(tmp_path, events)).frames()]
    assert rows[-1]["time"] > 4.5 and 3 in [row["level"] for row in rows[1:]] and np.isnan(rows[30]["q_st"])
    found = np.array([row["q_st"] for row in rows if row["time"] > 3.0])
    np.testing.assert_allclose(found, 0.15, rtol=0.02)


def test_a_steady_flow_says_that_it_does_not_swing(tmp_path):
    asked = '[quantities]\nst = { strouhal = { speed = 1, length = 0.3 }, at = "body" }\n[mesh]\nsize = 0.2\n'
    row = solved(tmp_path, CYLINDER + STEADY + asked).row
    assert np.isnan(row["q_st"]) and "does not swing" in row["note"]
    row = solved(tmp_path, CYLINDER + in_time() + asked).row
    assert np.isnan(row["q_st"]) and "st: the lift has not swung" in row["note"]


def test_a_swing_from_step_to_step_is_none_of_the_flow():
    swing = Swing()
    for k in range(40):
        swing = swing.after(0.02 * k, (-1.0) ** k)
    assert np.isnan(swing.period)
