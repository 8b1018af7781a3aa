"""Design derivatives of static answers: Taylor remainders, differences of full solves, invariances."""

import numpy as np
import pytest
from designs import LOADS, Design

from restshape.fem.residuals import design_rates, tangent_product, unconstrained_residual
from restshape.sensitivity.steady_derivative import design_derivative

TOLERANCE = 1e-12


def derivative(design, dX):
    """ds (n, 2) along one motion dX (n, 2)."""
    return design_derivative(design.analysis, np.stack([dX, np.zeros_like(dX)]), TOLERANCE)[0]


def check_taylor(design, step):
    """x(X + h dX) - x(X) - h s falls with the square of h, and s is what central differences tend to."""
    dX = design.direction()
    s = derivative(design, dX)
    ahead, nearer, behind = (design.move(h * dX) for h in (step, step / 2, -step / 2))
    remainders = [np.linalg.norm(x - design.x - h * s) for h, x in ((step, ahead), (step / 2, nearer))]
    assert remainders[0] > 1e-8 * np.linalg.norm(design.x), "nothing to compare with"
    assert 1.9 < np.log2(remainders[0] / remainders[1]) < 2.1
    central = (nearer - behind) / step
    assert np.linalg.norm(central - s) < 0.05 * remainders[0] / step


@pytest.mark.parametrize("load", LOADS)
@pytest.mark.parametrize("nonlinear", [False, True], ids=["linear", "stvk"])
@pytest.mark.parametrize("order", [1, 2])
def test_remainder_is_of_second_order(tmp_path, load, nonlinear, order):
    check_taylor(Design(tmp_path, LOADS[load], nonlinear, order), 4e-3)


@pytest.mark.parametrize("nonlinear", [False, True], ids=["linear", "stvk"])
def test_all_loads_at_once_with_two_materials(tmp_path, nonlinear):
    soft = (
        "[shape.regions]\nsoft = { polygon = [[0.9, 0.3], [1.3, 0.3], [1.3, 0.8], [0.9, 0.8]] }\n"
        '[material.foam]\nE = 2e5\nnu = 0.2\nrho = 300\nthickness = 0.03\nregion = ["soft"]\n'
    )
    parts = [text.replace("loads.a", f"loads.l{i}") for i, text in enumerate(LOADS.values())]
    check_taylor(Design(tmp_path, "\n".join(parts), nonlinear, tables=soft), 4e-3)


def test_incompressible(tmp_path):
    # Mean dilatation: the thickness of an element's pressure is its whole area, which moves with all of its nodes.
    check_taylor(Design(tmp_path, LOADS["traction"], True, 2, nu=0.4999), 2e-3)


@pytest.mark.parametrize("load", ["gravity", "traction", "pressure", "force"])
@pytest.mark.parametrize("nonlinear", [False, True], ids=["linear", "stvk"])
def test_moving_the_whole_design_changes_nothing(tmp_path, load, nonlinear):
    # A translation of support, body and loads together: x stays, to rounding.
    design = Design(tmp_path, LOADS[load], nonlinear)
    s = derivative(design, np.broadcast_to([0.6, -0.8], design.X.shape).copy())
    assert np.abs(s).max() < 1e-11 * np.abs(derivative(design, design.direction())).max()


def test_growing_the_whole_design(tmp_path):
    # Under a traction on its end a body k times as large (in the plane) is displaced k times as far: s = x for dX = X.
    design = Design(tmp_path, LOADS["traction"])
    s = derivative(design, design.X.copy())
    np.testing.assert_allclose(s, design.x, atol=1e-9 * np.abs(design.x).max())


def test_turning_the_whole_design(tmp_path):
    # Turned with a body that only pressure loads, x turns with it: s = w x x for dX = w x X.
    design = Design(tmp_path, LOADS["pressure"], True)
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    s = derivative(design, design.X @ turn.T)
    np.testing.assert_allclose(s, design.x @ turn.T, atol=1e-9 * np.abs(design.x).max())


@pytest.mark.parametrize("load", ["varying force", "moving support", "varying pressure", "body force"])
def test_forces_follow_the_design_at_constant_displacement(tmp_path, load):
    # (5.11) against central differences of the forces themselves, free unknowns held where they are.
    design = Design(tmp_path, LOADS[load], True)
    physics, mesh, dX, h = design.analysis.problem, design.analysis.space, design.direction(), 1e-5
    force, held = design_rates(physics, design.x, dX)
    found, places = [], []
    for side in (1, -1):
        mesh.X[...] = design.X + side * h * dX
        physics.update()
        x = design.x.copy()
        physics.boundary.apply(x)
        found.append(unconstrained_residual(physics, x))
        places.append(physics.boundary.values.copy())
    np.testing.assert_allclose(force, (found[0] - found[1]) / (2 * h), atol=1e-7 * np.abs(force).max())
    np.testing.assert_allclose(held, (places[0] - places[1]) / (2 * h), atol=1e-8)


def test_product_with_the_tangent(tmp_path):
    design = Design(tmp_path, LOADS["varying pressure"], True)
    physics, v, h = design.analysis.problem, design.direction(5), 1e-6
    product = tangent_product(physics, design.x, v)
    difference = (
        unconstrained_residual(physics, design.x + h * v) - unconstrained_residual(physics, design.x - h * v)
    ) / (2 * h)
    np.testing.assert_allclose(product, difference, atol=1e-7 * np.abs(product).max())
