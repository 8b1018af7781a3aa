"""Taylor and Hood's element: fields on different nodes, nodal coefficients; a patch, and rates 3 and 2."""

import numpy as np
import pytest
from element_case import TRI3, ElementCase, curved, taylor_slope
from mixed_meshes import mixed_dofs, solve, square

from restshape import _kernels as k


class MixedCase(ElementCase):
    """The checks of any element, with dofs and coefficients given."""

    dofs = np.arange(15, dtype=np.int32)[None]

    def given(self, element) -> dict:
        w = np.random.default_rng(17).uniform(-1, 1, (6, len(element.coefficients)))
        return {"dofs": self.dofs, "coefficients": w if element.coefficients else None}

    def sample(self, element, seed):
        return self.amplitude * self.direction((15, 1), seed)

    def residual(self, element, X, x, **given):
        out = np.zeros((15, 1))
        element.residual(X, x, self.cells, self.p, out, **{**self.given(element), **given})
        return out

    def design(self, element, dX, x, **directions):
        out = np.zeros((15, 1))
        element.design(self.X, dX, x, self.cells, self.p, out, **self.given(element), **directions)
        return out

    def tangent(self, element, x):
        return element.tangent_block(self.X, x, self.p, self.given(element)["coefficients"])

    def test_residual_is_the_gradient_of_the_energy(self, element):
        if not element.symmetric:
            pytest.skip("convection has no energy")
        x, v = self.sample(element, 1), self.direction((15, 1), 2)
        slope = taylor_slope(
            lambda h: element.energy(self.X, x + h * v, self.cells, self.p, dofs=self.dofs)[0],
            float(np.sum(self.residual(element, self.X, x) * v)),
        )
        assert slope > 1.9

    def test_tangent_is_the_derivative_of_the_residual(self, element):
        x, v = self.sample(element, 3), self.direction((15, 1), 4)
        change = self.residual(element, self.X, x + v) - self.residual(element, self.X, x)
        np.testing.assert_allclose(self.tangent(element, x) @ v.ravel(), change.ravel(), atol=1e-13)

    def test_tangent_is_symmetric(self, element):
        tangent = self.tangent(element, self.sample(element, 5))
        assert np.allclose(tangent, tangent.T, rtol=0, atol=1e-14) == element.symmetric

    def test_design_is_the_derivative_of_the_residual_in_X(self, element):
        x, dX = self.sample(element, 6), self.direction(self.X.shape, 7)
        derivative = self.design(element, dX, x)
        slope = taylor_slope(
            lambda h: self.residual(element, self.X + h * dX, x).ravel(), derivative.ravel(), step=2e-3
        )
        assert slope > 1.9

    def test_design_takes_in_moving_unknowns(self, element):
        x, dX, dx = self.sample(element, 6), self.direction(self.X.shape, 7), self.direction((15, 1), 13)
        expected = self.design(element, dX, x).ravel() + self.tangent(element, x) @ dx.ravel()
        np.testing.assert_allclose(self.design(element, dX, x, dx=dx).ravel(), expected, atol=1e-12)

    def test_moving_cell_and_design_together_changes_nothing(self, element):
        derivative = self.design(element, np.ones_like(self.X), self.sample(element, 8))
        np.testing.assert_allclose(derivative, 0.0, atol=1e-13)


class TestStokesTri6(MixedCase):
    name, params, X = "stokes_tri6", (0.7, 0.3, -0.9), curved(TRI3)


class TestOseenTri6(MixedCase):
    name, params, X = "oseen_tri6", (0.7, 0.3, -0.9, 1.3), curved(TRI3)

    def test_design_takes_in_moving_coefficients(self, element):
        x, w = self.sample(element, 6), self.given(element)["coefficients"]
        dX, dw = self.direction(self.X.shape, 7), self.direction(w.shape, 8)
        derivative = self.design(element, dX, x, dw=dw)
        slope = taylor_slope(
            lambda h: self.residual(element, self.X + h * dX, x, coefficients=w + h * dw).ravel(),
            derivative.ravel(),
            step=2e-3,
        )
        assert slope > 1.9

    def test_without_coefficients_it_says_which_it_needs(self, element):
        with pytest.raises(ValueError, match=r"oseen_tri6 needs coefficients of shape \(6, 2\)"):
            element.residual(self.X, np.zeros((15, 1)), self.cells, self.p, np.zeros((15, 1)), dofs=self.dofs)


@pytest.mark.parametrize("backend", ["csr", "bcsr"])
def test_patch_of_a_linear_velocity_and_a_linear_pressure(backend):
    """u = (y, x) and p = p_x x + p_y y, with the body force grad p: exact on straight sides."""
    X, cells, corners = square(3)
    gradient = np.array([0.8, -0.5])
    element = k.Element("stokes_tri6")
    x = solve(element, X, cells, corners, np.array([0.7, *gradient]), lambda at: at[:, ::-1], backend)
    np.testing.assert_allclose(x[: 2 * len(X)].reshape(-1, 2), X[:, ::-1], atol=1e-12)
    np.testing.assert_allclose(x[2 * len(X) :], (X[:corners] - X[0]) @ gradient, atol=1e-11)


def slow_flow(X: np.ndarray, viscosity: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and pressure of the stream function y e^x sin y, which needs no body force."""
    x, y = X.T
    velocity = np.column_stack([np.sin(y) + y * np.cos(y), -y * np.sin(y)]) * np.exp(x)[:, None]
    return velocity, -2 * viscosity * np.exp(x) * np.sin(y)


def kovasznay_flow(X: np.ndarray, viscosity: float) -> tuple[np.ndarray, np.ndarray]:
    """Velocity and pressure behind a grid, for density 1. Source: Kovasznay, Proc. Camb. Phil. Soc. 44 (1948) 58."""
    x, y = X.T
    decay = 0.5 / viscosity - np.sqrt(0.25 / viscosity**2 + 4 * np.pi**2)
    wave = np.exp(decay * x)
    velocity = [1 - wave * np.cos(2 * np.pi * y), decay / (2 * np.pi) * wave * np.sin(2 * np.pi * y)]
    return np.column_stack(velocity), -0.5 * np.exp(2 * decay * x)


def errors(exact, name: str, per_side: int, viscosity: float = 0.1) -> tuple[float, float]:
    """L2 errors of velocity and of pressure, whose constant is free."""
    X, cells, corners = square(per_side)
    element = k.Element(name)
    velocity, pressure = exact(X, viscosity)
    convected = bool(element.coefficients)
    params = np.array([viscosity, 0.0, 0.0, 1.0][: 4 if convected else 3])
    x = solve(
        element,
        X,
        cells,
        corners,
        params,
        lambda at: exact(at, viscosity)[0],
        coefficients=velocity if convected else None,
    )
    off = x[2 * len(X) :] - pressure[:corners]
    one, mass = np.ones(1), k.Element("mass_tri3")
    weight = np.zeros((corners, 2))
    mass.residual(X[:corners], np.ones((corners, 2)), np.ascontiguousarray(cells[:, :3]), one, weight)
    off -= weight[:, 0] @ off / weight[:, 0].sum()
    field = np.column_stack([off, np.zeros(corners)])
    energies = [
        k.Element("mass_tri6").energy(X, x[: 2 * len(X)].reshape(-1, 2) - velocity, cells, one),
        mass.energy(X[:corners], field, np.ascontiguousarray(cells[:, :3]), one),
    ]
    return tuple(np.sqrt(2 * e.sum()) for e in energies)


@pytest.mark.parametrize(
    "exact, name, sizes", [(slow_flow, "stokes_tri6", (6, 24)), (kovasznay_flow, "oseen_tri6", (12, 48))]
)
def test_velocity_is_of_order_3_and_pressure_of_order_2(exact, name, sizes):
    coarse, fine = (errors(exact, name, n) for n in sizes)
    rates = np.log(np.divide(coarse, fine)) / np.log(sizes[1] / sizes[0])
    assert rates[0] > 2.8 and rates[1] > 1.85, rates


def test_mixed_elements_name_the_dofs_that_they_need():
    X, cells, _ = square(1)
    with pytest.raises(ValueError, match=r"stokes_tri6 needs dofs of shape \(ne, 15\)"):
        k.Element("stokes_tri6").residual(X, np.zeros((9, 1)), cells, np.ones(3), np.zeros((9, 1)))


def test_dofs_that_do_not_exist_are_refused():
    X, cells, corners = square(1)
    element = k.Element("stokes_tri6")
    dofs, count = mixed_dofs(element, cells, corners)
    dofs[0, 14] = count
    out = np.zeros((count, 1))
    with pytest.raises(ValueError, match=f"names node {count}, which does not exist"):
        element.residual(X, out.copy(), cells, np.ones(3), out, dofs=dofs)
