"""Derivatives of drapes along a hand on the pattern: Taylor remainders, invariances, each part that enters alone."""

import numpy as np
import pytest
from drape_designs import BALL, CLAMPED, CONTACT, HELD, DrapeDesign, sheet

from restshape.errors import ReplayProblem

KINDS = ("morley", "hinge", "nonlinear")
DRAPES = {
    "pinned": (sheet, (HELD,), 1e-3),
    "clamped": (sheet, (CLAMPED,), 1e-3),
    "on a smooth ball": (sheet, (HELD, BALL.format(friction=0.0), CONTACT), 2e-4),
    "on a rough ball": (sheet, (BALL.format(friction=0.4), CONTACT), 2e-5),
}


def check_order(design: DrapeDesign, dX: np.ndarray, step: float) -> None:
    """The remainder falls with the square of the step, from one that is seen."""
    first, second = design.remainders(dX, step)
    assert second > 1e-10, "nothing to compare with"
    assert 1.8 < np.log2(first / second) < 2.2


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("drape", DRAPES)
def test_remainder_is_of_second_order(tmp_path, drape, kind):
    text, tables, step = DRAPES[drape]
    design = DrapeDesign(tmp_path, text(kind, *tables))
    check_order(design, design.direction(), step)


@pytest.mark.parametrize("kind", ["morley", "hinge"])
def test_moving_the_pattern_in_its_plane_moves_what_is_held_with_it(tmp_path, kind):
    # Pins are where the scene lays the flat cloth: all goes with the material.
    design = DrapeDesign(tmp_path, sheet(kind, HELD, size=0.05))
    s = design.hand(np.broadcast_to([0.6, -0.8], design.X.shape).copy())
    expected = np.zeros_like(s)
    expected[design.problem.corner_number] = [0.6, -0.8, 0.0]
    np.testing.assert_allclose(s, expected, atol=1e-8)


def test_cloth_that_is_not_at_rest_has_no_derivative(tmp_path):
    design = DrapeDesign(tmp_path, sheet("hinge", HELD, size=0.05))
    design.analysis.state.report.converged = False
    with pytest.raises(ReplayProblem, match="not at rest"):
        design.hand(design.direction())
