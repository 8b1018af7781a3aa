"""Pressure that follows the deformed boundary: the inherited checks, resultants and symmetry in closed form."""

import numpy as np
import pytest
from element_case import ElementCase

from restshape import _kernels as k


class PressureCase(ElementCase):
    """What has no potential has no energy and no symmetric tangent; the rest of the checks is inherited."""

    params = (0.7, -0.4, 0.8)

    def test_residual_is_the_gradient_of_the_energy(self, element):
        with pytest.raises(ValueError, match="no energy"):
            element.energy(self.X, 0 * self.X, self.cells, self.p)

    def test_tangent_is_symmetric(self, element):
        tangent = element.tangent_block(self.X, self.sample(element, 5), self.p)
        assert not element.symmetric
        assert np.abs(tangent - tangent.T).max() > 0.01

    def test_undeformed_it_is_the_dead_pressure(self, element):
        dead, out = k.Element(self.name.replace("pressure", "traction")), np.zeros_like(self.X)
        dead.residual(self.X, 0 * self.X, self.cells, np.array([0, 0, 0, 0, *self.params]), out)
        np.testing.assert_allclose(self.residual(element, self.X, 0 * self.X), out, atol=1e-15)

    def test_acts_where_the_displacement_has_brought_the_side(self, element):
        u = self.sample(element, 3)
        there = self.residual(element, self.X + u, 0 * u)
        np.testing.assert_allclose(self.residual(element, self.X, u), there, atol=1e-15)

    def test_turns_with_the_side(self, element):
        turn = np.array([[np.cos(2.0), -np.sin(2.0)], [np.sin(2.0), np.cos(2.0)]])
        turned = self.residual(element, self.X, self.X @ turn.T - self.X)
        np.testing.assert_allclose(turned, self.residual(element, self.X, 0 * self.X) @ turn.T, atol=1e-15)


class TestPressureEdge2(PressureCase):
    name, X = "pressure_edge2", np.array([[0.1, 0.2], [1.3, -0.4]])


class TestPressureEdge3(PressureCase):
    name, X = "pressure_edge3", np.array([[0.1, 0.2], [1.3, -0.4], [0.75, -0.05]])


def chain(order: int, closed: bool) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes, cells and a large displacement of a loop, or of half of it."""
    rng = np.random.default_rng(4)
    n = 11
    angle = np.sort(rng.uniform(0, 2 * np.pi if closed else np.pi, n))
    X = rng.uniform(0.5, 1.5, (n, 1)) * np.column_stack([np.cos(angle), np.sin(angle)])
    cells = np.column_stack([np.arange(n), np.roll(np.arange(n), -1)])
    cells = cells if closed else cells[:-1]
    if order == 2:
        middles = X[cells].mean(axis=1)
        cells = np.column_stack([cells, n + np.arange(len(cells))])
        X = np.vstack([X, middles + rng.uniform(-0.1, 0.1, middles.shape)])
    return X, cells.astype(np.int32), rng.uniform(-0.3, 0.3, X.shape)


def assembled(element, X: np.ndarray, cells: np.ndarray, u: np.ndarray, p: np.ndarray) -> np.ndarray:
    K = np.zeros((X.size, X.size))
    for cell in cells:
        dofs = (2 * cell[:, None] + np.arange(2)).ravel()
        K[np.ix_(dofs, dofs)] += element.tangent_block(X[cell], u[cell], p)
    return K


@pytest.mark.parametrize("order", [1, 2])
def test_uniform_pressure_on_a_deformed_loop_has_no_resultant(order):
    X, cells, u = chain(order, closed=True)
    out = np.zeros_like(X)
    k.Element(f"pressure_edge{order + 1}").residual(X, u, cells, np.array([2.0, 2.0, 0.3]), out)
    assert np.abs(out).max() > 0.01
    np.testing.assert_allclose(out.sum(axis=0), 0, atol=1e-14)
    y = X + u
    np.testing.assert_allclose(np.sum(y[:, 0] * out[:, 1] - y[:, 1] * out[:, 0]), 0, atol=1e-14)


@pytest.mark.parametrize("order", [1, 2])
def test_its_work_is_pressure_times_the_change_of_enclosed_area(order):
    """Of the polygon, whose area is a shoelace sum; parabolas add two thirds of the triangle to their middle."""
    X, cells, u = chain(order, closed=True)

    def area(y: np.ndarray) -> float:
        a, b = y[cells[:, 0]], y[cells[:, 1]]
        cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
        if order == 2:
            d, e = y[cells[:, 2]] - a, b - a
            cross = cross + 4 / 3 * (d[:, 0] * e[:, 1] - d[:, 1] * e[:, 0])
        return cross.sum() / 2

    out = np.zeros_like(X)
    k.Element(f"pressure_edge{order + 1}").residual(X, u, cells, np.array([2.0, 2.0, 0.3]), out)
    v, h = np.random.default_rng(1).uniform(-1, 1, X.shape), 1e-3
    change = (area(X + u + h * v) - area(X + u - h * v)) / (2 * h)  # exact: the area is quadratic
    np.testing.assert_allclose(np.sum(out * v), 2.0 * 0.3 * change, rtol=1e-10)


@pytest.mark.parametrize("order", [1, 2])
def test_tangent_is_symmetric_but_for_free_ends(order):
    element, p = k.Element(f"pressure_edge{order + 1}"), np.array([2.0, 2.0, 0.3])
    X, cells, u = chain(order, closed=True)
    K = assembled(element, X, cells, u, p)
    np.testing.assert_allclose(K, K.T, atol=1e-15)
    X, cells, u = chain(order, closed=False)
    K = assembled(element, X, cells, u, p)
    assert np.abs(K - K.T).max() > 0.1
    constrained = np.r_[0:2, 20:22]
    K[constrained], K[:, constrained] = 0, 0
    np.testing.assert_allclose(K, K.T, atol=1e-15)


def test_balloon_has_the_stiffness_of_its_area():
    """A regular polygon of n corners at radius r, pressed: forces p r sin(2 pi / n) outward a corner of a hole."""
    n, radius, pressure = 24, 1.7, 3.0
    angle = -2 * np.pi * np.arange(n) / n  # clockwise: the material is outside
    X = np.column_stack([np.cos(angle), np.sin(angle)])
    cells = np.column_stack([np.arange(n), np.roll(np.arange(n), -1)]).astype(np.int32)
    out = np.zeros_like(X)
    k.Element("pressure_edge2").residual(X, (radius - 1) * X, cells, np.array([pressure, pressure, 1.0]), out)
    np.testing.assert_allclose(-out, pressure * radius * np.sin(2 * np.pi / n) * X, atol=1e-14)
