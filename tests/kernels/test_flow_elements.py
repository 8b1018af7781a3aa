"""Stabilised elements of flow: tangent and design derivative, and the flows that they hold exactly."""

import numpy as np
import pytest
from element_case import TRI3, ElementCase, taylor_slope
from sample_meshes import unit_box

from restshape import _kernels as k

RHO, MU, WEIGHT = 1.3, 0.07, 2.1
STEADY, IN_TIME = (RHO, MU, 0.4, -0.3, WEIGHT), (RHO, MU, 0.4, -0.3, WEIGHT, 15.0, 20.0)


class FlowCase(ElementCase):
    """The checks of any element, with coefficients given; there is no energy, and no symmetry."""

    amplitude, X = 1.0, TRI3
    test_residual_is_the_gradient_of_the_energy = test_tangent_is_symmetric = None

    def coefficients(self, element):
        w = np.random.default_rng(17).uniform(-1, 1, (len(self.X), len(element.coefficients)))
        return w if element.coefficients else None

    def residual(self, element, X, x, w=None):
        out = np.zeros((len(self.X), element.fields))
        element.residual(X, x, self.cells, self.p, out, coefficients=self.coefficients(element) if w is None else w)
        return out

    def design(self, element, dX, x, **directions):
        out = np.zeros((len(self.X), element.fields))
        w = self.coefficients(element)
        element.design(self.X, dX, x, self.cells, self.p, out, coefficients=w, **directions)
        return out

    def tangent(self, element, x):
        return element.tangent_block(self.X, x, self.p, self.coefficients(element))

    def test_tangent_is_the_derivative_of_the_residual(self, element):
        x, v = self.sample(element, 3), self.direction((len(self.X), element.fields), 4)
        slope = taylor_slope(
            lambda h: self.residual(element, self.X, x + h * v).ravel(), self.tangent(element, x) @ v.ravel()
        )
        assert slope > 1.9

    def test_design_is_the_derivative_of_the_residual_in_X(self, element):
        x, dX, w = self.sample(element, 6), self.direction(self.X.shape, 7), self.coefficients(element)
        dw = None if w is None else self.direction(w.shape, 8)
        derivative = self.design(element, dX, x, dw=dw)

        def moved(h):
            return self.residual(element, self.X + h * dX, x, None if w is None else w + h * dw).ravel()

        assert taylor_slope(moved, derivative.ravel(), step=2e-3) > 1.9

    def test_design_takes_in_moving_unknowns(self, element):
        x, dX = self.sample(element, 6), self.direction(self.X.shape, 7)
        dx = self.direction(x.shape, 13)
        expected = self.design(element, dX, x).ravel() + self.tangent(element, x) @ dx.ravel()
        np.testing.assert_allclose(self.design(element, dX, x, dx=dx).ravel(), expected, atol=1e-12)

    def test_moving_cell_and_design_together_changes_nothing(self, element):
        derivative = self.design(element, np.ones_like(self.X), self.sample(element, 8))
        np.testing.assert_allclose(derivative, 0.0, atol=1e-12)


class TestSlowFlow(FlowCase):
    name, params = "slow_flow_tri3", STEADY


class TestFlow(FlowCase):
    name, params = "flow_tri3", STEADY

    @pytest.mark.parametrize("speed", [0.0, 1e-9])
    def test_fluid_that_hardly_moves_has_a_tangent(self, element, speed):
        x = np.array([[speed, 0.0, 1.0]] * 3)
        assert np.all(np.isfinite(self.tangent(element, x)))


class TestOseenFlow(FlowCase):
    name, params = "oseen_flow_tri3", STEADY


class TestUnsteadySlowFlow(FlowCase):
    name, params = "unsteady_slow_flow_tri3", IN_TIME


class TestUnsteadyFlow(FlowCase):
    name, params = "unsteady_flow_tri3", IN_TIME


class TestUnsteadyFlowInTinySteps(FlowCase):
    name, params = "unsteady_flow_tri3", (RHO, MU, 0.4, -0.3, WEIGHT, 15.0, 2e6)


class TestUnsteadyFlowOnMovingMesh(FlowCase):
    name, params = "unsteady_flow_on_moving_mesh_tri3", IN_TIME


class TestUnsteadyOseenFlow(FlowCase):
    name, params = "unsteady_oseen_flow_tri3", IN_TIME


class TestCurvedSlip(FlowCase):
    name, params, X = "curved_slip_edge2", (MU,), TRI3[:2].copy()

    def test_a_chord_of_a_circle_has_the_friction_of_its_curvature(self, element):
        """mu u / r along the way of the fluid, on the side that it is outside of: here clockwise around it."""
        angle, radius, speed = 0.02, 2.0, 3.0
        at = np.array([angle, -angle])
        x = np.zeros((2, element.fields))
        x[:, :2] = speed * np.column_stack([np.sin(at), -np.cos(at)])
        out = self.residual(element, radius * np.column_stack([np.cos(at), np.sin(at)]), x)
        friction = MU * speed / radius * 2 * radius * np.sin(angle)
        np.testing.assert_allclose(out[:, :2].sum(axis=0), [0.0, -friction], rtol=1e-3, atol=1e-12)

    def test_a_straight_edge_has_none(self, element):
        x = np.zeros((2, element.fields))
        x[:, :2] = np.outer([1.0, 2.5], self.X[1] - self.X[0])
        np.testing.assert_allclose(self.residual(element, self.X, x), 0.0, atol=1e-14)


class TestCurvedSlipWithHeat(TestCurvedSlip):
    name = "curved_slip_with_heat_edge2"


class TestBackflow(FlowCase):
    name, params, X = "backflow_edge2", (RHO,), TRI3[:2].copy()

    def sample(self, element, seed):
        """Unknowns by which fluid comes in, also relative to the mesh, everywhere on the side."""
        x = super().sample(element, seed)
        along = self.X[1] - self.X[0]
        x[:, :2] -= 3.0 * np.array([along[1], -along[0]]) / np.linalg.norm(along)
        return x

    def test_it_takes_what_convection_brings_in(self, element):
        """Half of rho |a . n| |u|^2 a metre; and nothing where the fluid leaves."""
        along = self.X[1] - self.X[0]
        length = np.linalg.norm(along)
        n, w = np.array([along[1], -along[0]]) / length, np.zeros((2, len(element.coefficients)))
        if w.size:
            w[:] = 0.5 * n
        for speed in (-2.0, 2.0):
            x = np.zeros((2, element.fields))
            x[:, :2] = speed * n + 0.3 * along / length
            taken = (x * self.residual(element, self.X, x, w)).sum()
            entering = max(0.0, -(speed - 0.5 * bool(w.size)))
            assert taken == pytest.approx(0.5 * RHO * entering * (speed**2 + 0.09) * length)


class TestBackflowOnMovingMesh(TestBackflow):
    name = "backflow_on_moving_mesh_edge2"


class TestBackflowWithHeat(TestBackflow):
    name = "backflow_with_heat_edge2"


class TestBackflowOnMovingMeshWithHeat(TestBackflow):
    name = "backflow_on_moving_mesh_with_heat_edge2"


def assembled(name, x, params, w=None):
    """The residual (n, 3) of a distorted square, and its inner nodes."""
    X, cells, inner = unit_box(2, 4)
    out = np.zeros((len(X), 3))
    element = k.Element(name)
    element.residual(X, x(X), cells, np.array(params), out, coefficients=None if w is None else w(X))
    return out[inner]


def columns(velocity, pressure):
    return np.column_stack([velocity, pressure])


@pytest.mark.parametrize("name", ["slow_flow_tri3", "flow_tri3"])
def test_linear_velocity_and_pressure_are_exact(name):
    """u = (y, x), p = c . x: div u = 0, u . grad u = (x, y), which a pressure of the other sign balances."""
    gradient = np.array([0.8, -0.5])
    params = (RHO, MU, *gradient, WEIGHT)

    def flow(X):
        velocity = X[:, ::-1] if name == "slow_flow_tri3" else np.broadcast_to([0.6, -0.2], X.shape)
        return columns(velocity, X @ gradient)

    np.testing.assert_allclose(assembled(name, flow, params), 0.0, atol=1e-13)


def test_own_velocity_as_the_one_that_advects_gives_the_same_residual():
    def flow(X):
        return columns(np.sin(3 * X[:, ::-1]), X[:, 0])

    own, given = (
        assembled(name, flow, STEADY, w)
        for name, w in (("flow_tri3", None), ("oseen_flow_tri3", lambda X: np.sin(3 * X[:, ::-1])))
    )
    np.testing.assert_allclose(own, given, atol=1e-13)


def test_a_frame_of_reference_that_moves_along_changes_nothing():
    """Velocities, and that of the mesh, with a uniform stream added have the same residual."""
    drift, past = np.array([0.7, -0.4]), -15.0

    def residual(added):
        def flow(X):
            return columns(np.cos(2 * X) + added, X[:, 1])

        def given(X):
            return np.hstack([0.3 * np.sin(X) + added, np.sin(X[:, ::-1]) + past * added])

        return assembled("unsteady_flow_on_moving_mesh_tri3", flow, IN_TIME, given)

    np.testing.assert_allclose(residual(drift), residual(0 * drift), atol=1e-12)


def test_a_steady_shear_is_exact_while_the_mesh_moves():
    """u = (y, 0): nodes that moved from X - d had the velocity y - d_y, and the mesh moves with d / dt."""
    dt, params = 0.05, (RHO, MU, 0.0, 0.0, WEIGHT, 20.0, 40.0)

    def given(X):
        moved = 0.02 * np.sin(5 * X)
        return np.column_stack([moved / dt, -(X[:, 1] - moved[:, 1]) / dt, np.zeros(len(X))])

    def flow(X):
        return columns(np.column_stack([X[:, 1], np.zeros(len(X))]), np.zeros(len(X)))

    found = assembled("unsteady_flow_on_moving_mesh_tri3", flow, params, given)
    np.testing.assert_allclose(found, 0.0, atol=1e-13)
