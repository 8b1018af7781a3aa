"""Prescribed values: numbers are evaluated once, formulas whenever nodes move or time goes on."""

import numpy as np
import pytest

from restshape.errors import UserError
from restshape.fem import dirichlet
from restshape.fem.dirichlet import Dirichlet, Prescribed
from restshape.scene.expressions import PLACES_AND_TIME, Expression

X = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [3.0, 1.0]])


def formula(text):
    return Expression(text, coordinates=PLACES_AND_TIME)


def condition(component, nodes, value):
    return Prescribed("boundary.inlet", component, np.array(nodes, dtype=np.int32), value)


@pytest.fixture
def counted(monkeypatch):
    """The values that are evaluated, one after the other."""
    seen = []

    class Counted(dirichlet.Nodal):
        def __call__(self, X):
            seen.append(self.value)
            return super().__call__(X)

    monkeypatch.setattr(dirichlet, "Nodal", Counted)
    return seen


def test_numbers_are_evaluated_once_and_formulas_again(counted):
    wind = formula("2*x + t")
    supports = Dirichlet((4, 2), [condition(0, [0, 1], 3.0), condition(1, [0, 1], 0.0), condition(0, [2, 3], wind)], {})
    for time in (0.0, 1.0, 2.0):
        supports.parameters = {"t": time}
        supports.evaluate(X + time)
        np.testing.assert_allclose(supports.values[:, 0], [3.0, 3.0, 4.0 + 3.0 * time, 6.0 + 3.0 * time])
    assert supports.nonzero
    assert counted == [3.0, 0.0, wind, wind, wind]


def test_conditions_that_meet_are_compared_once_where_they_are_numbers(counted):
    supports = Dirichlet((4, 1), [condition(0, [0, 1], 3.0), condition(0, [1, 2], 3.0)], {})
    for _ in range(3):
        supports.evaluate(X)
    np.testing.assert_allclose(supports.values[:, 0], [3.0, 3.0, 3.0, 0.0])
    assert len(counted) == 2


def test_conditions_that_meet_are_compared_each_time_where_one_is_a_formula():
    supports = Dirichlet((4, 1), [condition(0, [0, 1], 1.0), condition(0, [1, 2], formula("x"))], {})
    supports.evaluate(X)
    np.testing.assert_allclose(supports.values[:, 0], [1.0, 1.0, 2.0, 0.0])
    with pytest.raises(UserError, match="two edges prescribe different values"):
        supports.evaluate(X + 1.0)


def test_a_formula_that_rounds_to_almost_0_agrees_with_0():
    slope = condition(0, [0, 1], formula("1e-3 * (y - 0.6/3)"))
    places = np.array([[0.0, 0.6], [0.0, 0.2], [1.0, 0.2], [1.0, 0.6]])
    supports = Dirichlet((4, 1), [slope, condition(0, [1, 2], 0.0)], {})
    supports.evaluate(places)
    np.testing.assert_allclose(supports.values[:, 0], [4e-4, 0.0, 0.0, 0.0], atol=1e-18)
    with pytest.raises(UserError, match="two edges prescribe different values"):
        supports.evaluate(places + 1e-11)
