"""Schemes of first and second order on one equation, by the weights that systems of a step are made with."""

import numpy as np
import pytest

from restshape.analysis.effective_system import StepWeights
from restshape.fem.time_integration import Newmark, Theta, TimeState

K, M, F = 3.0, 2.0, 5.0


def run(scheme, state, steps):
    weights = StepWeights(scheme, 0.0, 0.0)
    for _ in range(steps):
        stiff, inert = np.zeros((1, 1)), np.zeros((1, 1))
        weights.apply(state, stiff, inert)
        right = weights.load * F + K * stiff + M * inert
        state = scheme.after(state, right / (weights.of_stiffness * K + weights.of_mass * M))
    return state


def start(y):
    return TimeState(np.array([[y]]), np.zeros((1, 1)), None, 0.0)


@pytest.mark.parametrize("theta", [0.5, 0.75, 1.0])
def test_theta_method_is_its_recursion(theta):
    dt, y = 0.1, 4.0
    for _ in range(7):
        y = (M / dt * y - (1 - theta) * (K * y - F) + theta * F) / (M / dt + theta * K)
    found = run(Theta(theta, dt), start(4.0), 7)
    assert found.y.item() == pytest.approx(y, rel=1e-13) and found.time == pytest.approx(0.7)


@pytest.mark.parametrize(("scheme", "order"), [(Theta, 1), (Theta, 2), (Newmark, 2)])
def test_orders_of_convergence(scheme, order):
    errors = []
    for steps in (40, 80):
        dt = 1.0 / steps
        if scheme is Newmark:
            found, exact = run(Newmark(0.25, 0.5, dt), start(0.0), steps), F / K * (1 - np.cos(np.sqrt(K / M)))
        else:
            found, exact = run(Theta(1.0 / order, dt), start(4.0), steps), F / K + (4.0 - F / K) * np.exp(-K / M)
        errors.append(abs(found.y.item() - exact))
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.05)
