"""Derivatives of the forces in furniture: Taylor remainders of second order, along design modes."""

import numpy as np
import pytest
from restshape_apps.furniture.physics.derivatives import (
    force_derivative,
    predicted,
    stability_derivative,
    stability_values,
)
from restshape_apps.furniture.physics.furniture import Compliance, Furniture
from restshape_apps.furniture.pieces import bookshelf, shelf_1, stool_chair, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.small_pieces import bench, stool

ABOUT_X = 3
"""The number of the turn about a plank's own x among its design parameters."""
STEPS = np.array([4e-3, 2e-3, 1e-3])


def orders(remainders: list[float]) -> np.ndarray:
    """How fast remainders fall as the step is halved."""
    return np.log2(np.array(remainders[:-1]) / np.array(remainders[1:]))


def modes_of(furniture: Furniture) -> DesignModes:
    """The valid modes of a model."""
    return DesignModes.of(furniture.piece, furniture.kernel.freedoms())


@pytest.mark.parametrize(
    "piece", [table(), table(push=30.0), stool_chair(), shelf_1(), bookshelf((3, 2), 1, 1)], ids=lambda p: p.name
)
def test_forces_have_second_order_remainders(piece) -> None:
    furniture = Furniture(piece)
    furniture.test()
    modes = modes_of(furniture)
    weights = np.random.default_rng(7).normal(size=len(modes))
    weights /= np.linalg.norm(weights)
    case = len(furniture.cases) - 1
    change, base = force_derivative(furniture, modes.directions, case), furniture.forces(case)
    gamma = (weights @ modes.directions).reshape(-1, 8)
    remainders: dict[str, list[float]] = {}
    for step in STEPS:
        furniture.test(step * gamma)
        moved = furniture.forces(case)
        assert moved.one_sided == base.one_sided
        for name in ("u", "tension", "bending", "shear"):
            part = np.tensordot(weights, getattr(change, name), axes=1)
            rest = getattr(moved, name) - getattr(base, name) - step * part
            remainders.setdefault(name, []).append(float(np.abs(rest).max()))
    for name, rest in remainders.items():
        assert orders(rest) == pytest.approx(2.0, abs=0.1), name


def test_stability_has_second_order_remainders() -> None:
    feet, width = [(-0.4, -0.3), (0.45, -0.2), (0.0, 0.4)], (0.3e-4, 0.9e-4, 0.0)
    furniture = Furniture(stool(feet, (0.1, 0.05), width=width), Compliance(least_overlap=1e-6))
    furniture.test()
    modes = modes_of(furniture)
    weights = np.random.default_rng(3).normal(size=len(modes)) / len(modes)
    gamma = (weights @ modes.directions).reshape(-1, 8)
    # Each foot has four corners, so that the triangle of feet has up to six edges.
    base, change = stability_derivative(furniture, modes.directions)
    remainders = []
    for step in 0.25 * STEPS:
        furniture.test(step * gamma)
        now = stability_values(furniture)
        assert len(now) == len(base)
        remainders.append(float(np.abs(now - base - step * weights @ change).max()))
    assert orders(remainders) == pytest.approx(2.0, abs=0.15)


def test_stability_has_the_edges_of_what_was_tested_and_its_derivative_those_of_the_piece() -> None:
    """A leg that is turned back until its end lies as the other's: the hull of both loses some of its edges."""
    straight = Furniture(bench(leg=0.02))
    gamma = np.zeros((3, 8))
    gamma[1, ABOUT_X] = 0.2
    furniture = Furniture(straight.moved(gamma))
    furniture.test()
    turned = stability_values(furniture)
    furniture.test(-gamma)
    straight.test()
    assert stability_values(furniture) == pytest.approx(stability_values(straight))
    assert len(stability_values(furniture)) == 4 < len(turned)
    values, change = stability_derivative(furniture, np.eye(24))
    assert values == pytest.approx(turned) and change.shape == (24, len(turned))


def test_the_rows_of_stability_are_reactions_of_a_tripod() -> None:
    # The moment about the edge of two feet is the third one's reaction times its distance from the edge.
    feet, at = [(-0.4, -0.3), (0.45, -0.2), (0.0, 0.4)], (0.1, 0.05)
    furniture = Furniture(stool(feet, at, mu=0.0), Compliance(least_overlap=1e-6))
    furniture.test()
    rows = stability_derivative(furniture, modes_of(furniture).directions[:1])[0]
    reactions = furniture.forces().contacts.reshape(-1, 4, 3)[:, :, 2].sum(axis=1)
    points = np.array(feet)
    size = max(np.hypot(*(a - b)) for a in points for b in points)
    expected = []
    for k in range(3):
        a, b = points[(k + 1) % 3], points[(k + 2) % 3]
        e = b - a
        away = abs(e[0] * (points[k] - a)[1] - e[1] * (points[k] - a)[0]) / np.linalg.norm(e)
        expected.append(reactions[k] / reactions.sum() * away / size)
    for value in expected:
        assert np.abs(rows - value).min() < 2e-3 * max(expected)


def test_a_prediction_is_nearer_than_no_prediction() -> None:
    furniture = Furniture(table())
    furniture.test()
    modes = modes_of(furniture)
    direction = np.zeros(len(modes))
    direction[3] = 0.01
    guess, base = predicted(furniture, modes, direction), furniture.forces().u
    furniture.test((direction @ modes.directions).reshape(-1, 8))
    now = furniture.forces().u
    assert np.linalg.norm(guess - now) < 0.1 * np.linalg.norm(base - now)
