"""Guesses at the next time step: polynomials in time are predicted exactly, and a sudden start is not overshot."""

import numpy as np
import pytest
from counted_replays import begin_log, watched
from restshape_studies.stability.scenery import write_scene, write_script
from restshape_verification.flow.scenes import channel, disc, in_time

from restshape.physics.flow import extrapolation
from restshape.physics.flow.extrapolation import Extrapolation

TIMES = (0.0, 0.1, 0.3, 0.35, 0.6, 0.7)


def followed(values, times=TIMES):
    """The series of (k, n, f) values at times."""
    series = Extrapolation()
    for time, x in zip(times, values):
        series = series.after(time, x)
    return series


@pytest.mark.parametrize("degree", [0, 1, 2, 3])
def test_a_polynomial_of_the_time_is_predicted_at_any_steps(degree):
    factors = np.random.default_rng(degree).normal(size=(degree + 1, 7, 3))

    def at(time):
        return np.tensordot(float(time) ** np.arange(degree + 1), factors, 1)

    found = followed([at(time) for time in TIMES])(0.9, [slice(0, 2), slice(2, 3)])
    np.testing.assert_allclose(found, at(0.9), rtol=1e-9, atol=1e-9)


def test_a_flow_that_has_begun_suddenly_is_not_overshot():
    """At rest, and from the first step on all but steady: what it was is nearer than where it seems to go."""
    values = [np.zeros((4, 3)), np.ones((4, 3)), np.full((4, 3), 1.01)]
    series = followed(values[:2], (0.0, 0.1))
    np.testing.assert_allclose(series(0.2, [slice(0, 3)]), 1.0)
    np.testing.assert_allclose(followed(values, (0.0, 0.1, 0.2))(0.3, [slice(0, 3)]), 1.01)


def test_each_unknown_has_its_own_order():
    """The first column goes on evenly; the second one is back where it was in each step, far from any line."""
    values = [np.array([[0.1 * k, 5.0 + (-1.0) ** k]]) for k in range(5)]
    found = followed(values, 0.1 * np.arange(5))(0.5, [slice(0, 1), slice(1, 2)])
    np.testing.assert_allclose(found, [[0.5, 6.0]], rtol=1e-12)


def test_what_it_was_given_may_change_afterwards():
    x = np.ones((2, 3))
    series = Extrapolation().after(0.0, x)
    x[:] = 5.0
    np.testing.assert_allclose(series(1.0, [slice(0, 3)]), 1.0)


def test_guesses_of_higher_order_save_newtons_steps(tmp_path, monkeypatch):
    """Behind a body, from the sixth time step on: two of Newton's steps each, from the flow as it was up to three."""
    begin_log()
    text = (
        channel(3, 1, "rho = 1\nmu = 0.004\n", holes=disc("body", (0.8, 0.47), 0.15))
        + in_time(0.05)
        + "[mesh]\nsize = 0.1\n"
    )
    scene, script = write_scene(tmp_path, text), write_script(tmp_path, [{"do": "idle", "frames": 14}])
    taken = {}
    for most in (0, extrapolation.MOST):
        monkeypatch.setattr(extrapolation, "MOST", most)
        taken[most] = [row["newton"] for row in watched(scene, script)[0]][6:]
    assert sum(taken[0]) >= 22 and max(taken[extrapolation.MOST]) <= 2
