"""Design modes of a piece that has been changed: the same parameters, seen from where they have led."""

import numpy as np
import pytest
from restshape_apps.furniture.physics.derivatives import force_derivative
from restshape_apps.furniture.physics.furniture import LOST, Furniture
from restshape_apps.furniture.pieces import chair, shelf_1, stool_chair, table
from restshape_apps.furniture.shape.design_modes import DesignModes

STEP = 1e-4


@pytest.mark.parametrize("make", [table, chair, stool_chair, shelf_1], ids=lambda make: make.__name__)
def test_derivatives_after_a_change_are_differences_of_the_full_test(make) -> None:
    furniture = Furniture(make())
    furniture.test()
    modes = DesignModes.of(furniture.piece, furniture.kernel.freedoms())
    rng = np.random.default_rng(3)
    checked = turned = 0
    for _ in range(12):
        some = rng.choice(len(modes), 3, replace=False)
        gamma = modes.direction(some, 0.08 * rng.normal(size=3))
        moved = Furniture(furniture.moved(gamma))
        if moved.test().flaws & LOST:
            continue
        change = force_derivative(moved, modes.some(some).after(gamma, moved.piece).directions)
        for k, mode in enumerate(some):
            step = modes.direction(np.array([mode]), np.array([STEP]))
            expected = (bent(furniture, gamma + step) - bent(furniture, gamma - step)) / (2.0 * STEP)
            rounding = 1e-5 * np.abs(moved.forces().bending).max()
            assert change.bending[k] == pytest.approx(expected, abs=1e-4 * np.abs(change.bending).max() + rounding)
            checked += 1
        turned += np.abs(gamma[:, 3:6]).max() > 0.02
    assert checked >= 9
    assert turned


def bent(furniture: Furniture, gamma: np.ndarray) -> np.ndarray:
    """Moments of all joints by the full test."""
    furniture.test(gamma)
    return furniture.forces().bending
