"""Integrals of elements: stresses, and the work's derivatives by the places of nodes, against Taylor's remainder."""

import numpy as np
import pytest

from restshape import _kernels
from restshape.fem.assembled import Assembled
from restshape.fem.integral import Integral

X = np.array([[0.0, 0.0], [1.0, 0.1], [0.9, 1.2], [-0.1, 0.8]])
CELLS = np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32)
LAW = np.array([2.0, 1.0, 0.5, 0.0, 0.0])


def integral(places: np.ndarray, factor: float = 1.0) -> Integral:
    return Integral(_kernels.Element("linear_elastic_tri3"), places, CELLS, LAW, factor)


@pytest.mark.parametrize("factor", [1.0, -3.0])
def test_derivatives_of_the_work_by_the_places_of_nodes(factor):
    rng = np.random.default_rng(1)
    x, dX = rng.uniform(-1, 1, X.shape), rng.uniform(-1, 1, X.shape)
    rates = integral(X, factor).work_derivatives(x)
    gradient = np.zeros_like(X)
    np.add.at(gradient, CELLS, rates)

    def work(h: float) -> float:
        return float((x * Assembled([integral(X + h * dX, factor)]).residual(x)).sum())

    remainders = [abs(work(h) - work(0.0) - h * (gradient * dX).sum()) for h in (1e-3, 5e-4)]
    assert np.log2(remainders[0] / remainders[1]) == pytest.approx(2.0, abs=0.05)


def test_stress_of_a_stretch():
    stretch = np.column_stack([0.01 * X[:, 0], 0.0 * X[:, 1]])
    points = np.array([[0.2, 0.3], [0.5, 0.1]])
    for stress in (integral(X).stress(stretch), *integral(X).stress(stretch, points).swapaxes(0, 1)):
        np.testing.assert_allclose(stress[:, :3], [[0.04, 0.02, 0.0]] * 2, atol=1e-15)
