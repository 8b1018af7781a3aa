"""What is learnt of the steps of Newton's method."""

import pytest

from restshape.algebra.nonlinear.forcing_terms import ModelError


def test_a_step_reports_its_forcing_term():
    left = ModelError()
    assert left.factor(0) is None
    # |r| = 1e-2 became 3e-6, of which the linear solve may have left 1e-9: c = 0.03.
    left.learn(0, 1e-2, 3e-6, 1e-9)
    assert left.factor(0) == pytest.approx(0.03)
    # Steps learn by themselves, from the third on together.
    assert left.factor(1) is None and left.factor(2) is None
    left.learn(5, 1e-3, 1e-6, 1e-9)
    assert left.factor(2) == left.factor(9) == pytest.approx(1.0)


def test_a_rest_hidden_by_the_linear_solve_is_a_bound():
    left = ModelError()
    left.learn(0, 1.0, 0.5, 0.0)
    left.learn(0, 1.0, 1e-3, 1e-3)
    assert left.factor(0) <= 1e-3
    # One that is worse than known teaches nothing worse while the solve was loose.
    known = left.factor(0)
    left.learn(0, 1.0, 1e-2, 1e-2)
    assert left.factor(0) <= known


def test_a_residual_of_nothing_teaches_nothing():
    left = ModelError()
    left.learn(0, 0.0, 0.0, 0.0)
    assert left.factor(0) is None
