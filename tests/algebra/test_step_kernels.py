"""What a time step makes of the state before it: to the last bit the sums of whole arrays."""

import numpy as np
import pytest

from restshape import _kernels

WEIGHTS = (1.1, 0.2, 0.7, 3.0, 4.0, 5.0)


@pytest.mark.parametrize(("shape", "of_rate"), [((37, 2), 0.2), ((5, 3), 0.0)])
def test_states_are_weighed_as_arrays_are(shape, of_rate):
    rng = np.random.default_rng(0)
    y, v, a = rng.normal(size=(3, *shape))
    base, weights = rng.normal(size=shape[1]), (WEIGHTS[0], of_rate, *WEIGHTS[2:])
    for rates in (a, None):
        stiff, inert = np.empty(shape), np.empty(shape)
        _kernels.weigh_state(y, v, rates, weights, base, stiff, inert)
        wanted = weights[0] * y + weights[1] * v, weights[3] * y + weights[4] * v
        if rates is not None:
            wanted = wanted[0] + weights[2] * a, wanted[1] + weights[5] * a
        assert np.array_equal(stiff, wanted[0]) and np.array_equal(inert, wanted[1] - base)


def test_rates_after_a_step_are_those_of_arrays():
    y, before, v = np.random.default_rng(1).normal(size=(3, 41, 2))
    assert np.array_equal(_kernels.rates_after(y, before, v, 1.7, 0.3), 1.7 * (y - before) - 0.3 * v)


def test_weights_solve_the_regularised_system():
    rng = np.random.default_rng(2)
    rows = rng.normal(size=(3, 9))
    gram, products, found = rows @ rows.T, rng.normal(size=4), np.zeros((1, 3))
    _kernels.ridge_weights(gram, products, 0.5, found)
    exact = np.linalg.solve(gram + 0.5 * np.trace(gram) * np.eye(3), products[:3])
    assert np.allclose(found[0], exact, rtol=1e-12, atol=0.0)
    _kernels.ridge_weights(np.zeros((3, 3)), products, 0.5, found)
    assert not found.any()


def test_arrays_that_do_not_belong_together_are_refused():
    y = np.zeros((4, 2))
    with pytest.raises(ValueError, match="weights six numbers"):
        _kernels.weigh_state(y, y, None, WEIGHTS[:5], np.zeros(2), y.copy(), y.copy())
    with pytest.raises(ValueError, match="before and v"):
        _kernels.rates_after(y, y[:3], y, 1.0, 1.0)
    with pytest.raises(ValueError, match="gram"):
        _kernels.ridge_weights(np.zeros((3, 2)), np.zeros(3), 1.0, np.zeros(3))
