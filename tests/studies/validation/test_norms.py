"""Error norms against integrals done by hand."""

from types import SimpleNamespace

import numpy as np
import pytest
from restshape_studies.validation.norms import POINTS, WEIGHTS, errors

# The unit square in two triangles.
SQUARE = SimpleNamespace(
    X=np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float), cells=np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
)


def zero(X):
    return np.zeros((len(X), 2))


def no_slope(X):
    return np.zeros((len(X), 2, 2))


def test_linear_fields_have_no_error():
    A = np.array([[1.0, 2.0], [-0.5, 3.0]])
    l2, h1 = errors(SQUARE, SQUARE.X @ A.T + 7, lambda X: X @ A.T + 7, lambda X: np.broadcast_to(A, (len(X), 2, 2)))
    assert l2 < 1e-14 and h1 < 1e-14


def test_against_zero_the_norm_itself():
    # u = (x, 2 y): L2^2 = 1/3 + 4/3, H1^2 = 1 + 4.
    l2, h1 = errors(SQUARE, SQUARE.X * [1.0, 2.0], zero, no_slope)
    assert l2 == pytest.approx(np.sqrt(5 / 3), rel=1e-14) and h1 == pytest.approx(np.sqrt(5), rel=1e-14)


def test_slopes_are_rows_of_components():
    # u = (y, 0): only d u_x / d y.
    x = np.column_stack([SQUARE.X[:, 1], np.zeros(4)])
    right = np.array([[0.0, 1.0], [0.0, 0.0]])
    _, h1 = errors(SQUARE, x, zero, lambda X: np.broadcast_to(right, (len(X), 2, 2)))
    assert h1 == pytest.approx(0.0, abs=1e-14)
    _, h1 = errors(SQUARE, x, zero, lambda X: np.broadcast_to(right.T, (len(X), 2, 2)))
    assert h1 == pytest.approx(np.sqrt(2), rel=1e-14)


def test_interpolated_parabola():
    # x^2 is interpolated by x on both triangles: integral of (x - x^2)^2 is 1/30, of (1 - 2 x)^2 is 1/3.
    x = np.column_stack([SQUARE.X[:, 0] ** 2, np.zeros(4)])

    def exact(X):
        return np.column_stack([X[:, 0] ** 2, 0 * X[:, 0]])

    def slope(X):
        found = np.zeros((len(X), 2, 2))
        found[:, 0, 0] = 2 * X[:, 0]
        return found

    l2, h1 = errors(SQUARE, x, exact, slope)
    assert l2 == pytest.approx(np.sqrt(1 / 30), rel=1e-12) and h1 == pytest.approx(np.sqrt(1 / 3), rel=1e-12)


def test_quadrature_is_exact_to_degree_4():
    # The integral of x^a y^b over the unit triangle is a! b! / (a + b + 2)!.
    from math import factorial as f

    x, y = POINTS[:, 1], POINTS[:, 2]
    for a in range(5):
        for b in range(5 - a):
            assert 0.5 * WEIGHTS @ (x**a * y**b) == pytest.approx(f(a) * f(b) / f(a + b + 2), rel=1e-13)
