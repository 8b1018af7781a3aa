"""Formulas: against numpy, and against what may not be in them."""

import math

import numpy as np
import pytest

from restshape.scene.duals import Dual
from restshape.scene.expressions import Expression, ExpressionError

X = np.array([0.3, -1.2, 4.0])
Y = np.array([1.0, 0.5, -2.5])


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1", np.ones(3)),
        ("x", X),
        ("-x^2", -(X**2)),
        ("x**2 + 3*y", X**2 + 3 * Y),
        ("2^-1", 0.5 * np.ones(3)),
        ("P*(L - x)/2", 7 * (2 - X) / 2),
        ("sqrt(x^2 + y^2)", np.hypot(X, Y)),
        ("sin(pi*x) + cos(y)", np.sin(math.pi * X) + np.cos(Y)),
        ("atan2(y, x)", np.arctan2(Y, X)),
        ("atan(y) + tan(x)", np.arctan(Y) + np.tan(X)),
        ("exp(-x) + log(abs(x))", np.exp(-X) + np.log(np.abs(X))),
        ("min(x, y) + max(x, 1)", np.minimum(X, Y) + np.maximum(X, 1)),
        (" + x ", X),
    ],
)
def test_value(text, value):
    out = Expression(text).evaluate(X, Y, {"P": 7.0, "L": 2.0})
    assert out.shape == X.shape and out.dtype == np.float64
    np.testing.assert_allclose(out, value, rtol=1e-15)


def test_a_constant_does_not_share_memory_with_the_coordinates():
    out = Expression("x").evaluate(X, Y, {})
    out[0] = 9
    assert X[0] == 0.3


def test_names():
    assert Expression("P*x + sin(q)").names == {"P", "x", "q"}


@pytest.mark.parametrize(
    "text",
    [
        "x.real",
        "().__class__",
        "__import__('os')",
        "open('file')",
        "[x]",
        "x if y else 1",
        "lambda: 1",
        "x == y",
        "x and y",
        "x // 2",
        "x % 2",
        "x[0]",
        "'text'",
        "True",
        "1j",
        "(lambda: 1)()",
        "sin(x)(y)",
        "sin(x, out=y)",
        "sin",
        "sin()",
        "atan2(x)",
        "sni(x)",
        "x +",
        "2 x",
        "",
        "x := 2",
        "f'{x}'",
        "(" * 300 + "x" + ")" * 300,
        "-" * 500 + "x",
        "x+" * 5000 + "x",
    ],
)
def test_anything_else_is_refused(text):
    with pytest.raises(ExpressionError):
        Expression(text)


def test_a_tower_of_powers_overflows_at_once():
    assert not np.isfinite(Expression("9^9^9^9^9").evaluate(X, Y, {})).all()


def test_suggestions():
    with pytest.raises(ExpressionError, match="did you mean 'sin'"):
        Expression("sni(x)")
    with pytest.raises(ExpressionError, match="did you mean 'load'"):
        Expression("laod*x").evaluate(X, Y, {"load": 1.0})


def test_division_by_zero_is_infinite_not_an_error():
    assert np.isinf(Expression("P/(1 - 1)").evaluate(X, Y, {"P": 1.0})).all()


FORMULAS = (
    "2*x - 3",
    "3 - x*y^2/(1 + x)",
    "P*sin(x) + cos(y)*tan(x)",
    "sqrt(x)^3 + 2^y",
    "x^y",
    "exp(-x)*log(2 + y)",
    "atan2(y, x) - atan(x*y)",
    "abs(y - 1) + min(x, 0.5) - max(P*x, y)",
    "-(x)/P + P/x - (+y)",
    "7",
)


@pytest.mark.parametrize("text", FORMULAS)
def test_rate_is_what_central_differences_tend_to(text):
    x, y, dx, dy = np.array([[0.3, 0.7, 1.2], [0.2, 0.4, 0.9], [1.0, 0.3, -2.0], [0.2, -0.5, 0.7]])
    formula, P, h = Expression(text), {"P": 2.5}, 1e-6
    ahead, behind = (formula.evaluate(x + s * h * dx, y + s * h * dy, P) for s in (1, -1))
    np.testing.assert_allclose(formula.rate(Dual(x, dx), Dual(y, dy), P), (ahead - behind) / (2 * h), atol=1e-8)


def test_rate_of_a_root_at_zero_is_no_number():
    nothing = Dual(np.zeros(1), np.ones(1))
    assert not np.isfinite(Expression("sqrt(x)").rate(nothing, nothing, {})).any()
