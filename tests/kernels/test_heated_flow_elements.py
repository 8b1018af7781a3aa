"""Elements of flow with heat: tangent and design derivative, and the temperatures and forces that they hold exactly."""

import numpy as np
import pytest
from element_case import TRI3
from sample_meshes import unit_box
from test_flow_elements import IN_TIME, MU, RHO, STEADY, WEIGHT, FlowCase

from restshape import _kernels as k

LIFT = (0.5, -0.9, 0.3)
HEAT = (1.7, 0.08, 3.0, 0.6)
STEADY_WAYS = ("slow_flow", "flow", "oseen_flow")
WAYS = ("slow_flow", "flow", "flow_on_moving_mesh", "oseen_flow")


def case(name, params):
    """A class of the checks of one element."""
    return type(f"Test{name.title().replace('_', '')}", (FlowCase,), {"name": f"{name}_tri3", "params": params})


CASES = [case(f"heated_{way}", STEADY + LIFT + HEAT) for way in STEADY_WAYS]
CASES += [case(f"lifted_{way}", STEADY + LIFT) for way in STEADY_WAYS]
CASES += [case(f"unsteady_heated_{way}", IN_TIME + LIFT + HEAT) for way in (*WAYS, "slow_flow_on_moving_mesh")]
CASES += [case(f"unsteady_lifted_{way}", IN_TIME + LIFT) for way in WAYS]
CASES += [case("advected_heat", HEAT), case("unsteady_advected_heat", (*HEAT, 15.0, 20.0))]
globals().update({one.__name__: one for one in CASES})
FLOWS = [(f"{way}_tri3", STEADY) for way in STEADY_WAYS] + [(f"unsteady_{way}_tri3", IN_TIME) for way in WAYS]
FLOWS += [(one.name, one.params) for one in CASES if "flow" in one.name]


@pytest.mark.parametrize("stepping", [1e-3, 20.0, 2e6])
@pytest.mark.parametrize("speed", [0.0, 1e-9, 0.05, 1.0, 40.0])
@pytest.mark.parametrize(("name", "params"), FLOWS)
def test_tangents_are_those_of_dual_numbers(name, params, speed, stepping):
    """At rest, with steps that count in tau and others, on both sides of the bend in tau of LSIC."""
    element, p = k.Element(name), np.array(params)
    if name.startswith("unsteady"):
        p[6] = stepping
    rng, cells = np.random.default_rng(5), np.arange(3, dtype=np.int32)[None]
    x = rng.uniform(-1, 1, (3, element.fields))
    x[:, :2] *= speed
    w = rng.uniform(-1, 1, (3, len(element.coefficients))) if element.coefficients else None
    if w is not None and element.coefficients[0] == "wx":
        w[:, :2] *= speed
    found, expected = element.tangent_block(TRI3, x, p, w), []
    for dx in np.eye(x.size):
        out = np.zeros_like(x)
        element.design(TRI3, 0 * TRI3, x, cells, p, out, coefficients=w, dx=dx.reshape(x.shape))
        expected.append(out.ravel())
    largest = np.abs(found).max(axis=1, keepdims=True)
    assert (np.abs(found - np.transpose(expected)) <= 1e-13 * largest).all()


def assembled(name, params, x, w=None):
    """The residual (n, f) at the inner nodes of a distorted square, of unknowns and coefficients as functions of X."""
    X, cells, inner = unit_box(2, 4)
    element = k.Element(f"{name}_tri3")
    out = np.zeros((len(X), element.fields))
    element.residual(X, x(X), cells, np.array(params), out, coefficients=None if w is None else w(X))
    return out[inner]


def test_a_linear_temperature_is_exact_in_a_stream():
    """T = x + 2 y in the stream (0.6, -0.2): capacity times 0.2 is set free."""
    source = 1.7 * (0.6 - 0.4)

    def flow(X):
        still = np.zeros((len(X), 1))
        return np.hstack([np.broadcast_to([0.6, -0.2], X.shape), still, (X @ [1.0, 2.0])[:, None]])

    heat = (1.7, 0.08, 3.0, source)
    found = assembled("heated_flow", (RHO, MU, 0, 0, WEIGHT, 0, 0, 0, *heat), flow)
    np.testing.assert_allclose(found, 0.0, atol=1e-13)
    alone = assembled("advected_heat", heat, lambda X: flow(X)[:, 3:].copy(), lambda X: flow(X)[:, :2].copy())
    np.testing.assert_allclose(alone, 0.0, atol=1e-13)


@pytest.mark.parametrize("name", ["heated_flow", "lifted_flow"])
def test_a_pressure_bears_a_warm_fluid(name):
    """Two kelvins above the reference lift by twice the force of one, which a linear pressure balances."""
    warm, lift = 2.3, np.array([0.5, -0.9])

    def flow(X):
        return np.column_stack([0 * X, X @ (2.0 * lift), np.full(len(X), warm)])[:, : 4 if name == "heated_flow" else 3]

    params = (RHO, MU, 0, 0, WEIGHT, *lift, 0.3, *((1.7, 0.08, 3.0, 0.0) if name == "heated_flow" else ()))
    given = None if name == "heated_flow" else lambda X: np.full((len(X), 1), warm)
    np.testing.assert_allclose(assembled(name, params, lambda X: np.ascontiguousarray(flow(X)), given), 0.0, atol=1e-13)


def test_both_ways_have_the_same_residual():
    """Heat and flow in one element are heat advected by the flow, and a flow that the temperature lifts."""
    rng = np.random.default_rng(3)
    n = len(unit_box(2, 4)[0])
    x, past, mesh = rng.uniform(-1, 1, (n, 4)), rng.uniform(-1, 1, (n, 3)), rng.uniform(-1, 1, (n, 2))
    both = assembled(
        "unsteady_heated_flow_on_moving_mesh",
        IN_TIME + LIFT + HEAT,
        lambda _: x,
        lambda _: np.hstack([mesh, past]),
    )
    flow = assembled(
        "unsteady_lifted_flow_on_moving_mesh",
        IN_TIME + LIFT,
        lambda _: x[:, :3].copy(),
        lambda _: np.hstack([mesh, past[:, :2], x[:, 3:]]),
    )
    heat = assembled(
        "unsteady_advected_heat",
        (*HEAT, *IN_TIME[-2:]),
        lambda _: x[:, 3:].copy(),
        lambda _: np.hstack([x[:, :2] - mesh, past[:, 2:]]),
    )
    np.testing.assert_allclose(both[:, :3], flow, atol=1e-13)
    np.testing.assert_allclose(both[:, 3:], heat, atol=1e-13)
