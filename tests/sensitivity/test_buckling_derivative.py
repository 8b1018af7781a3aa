"""Design derivatives of critical load factors: Taylor remainders, homogeneity, coinciding ones, prediction."""

import numpy as np
import pytest
from columns import FOOT, HINGES, PUSHED, TWINS, Column, column
from small_scenes import across, drag, make_replay, rows_of, write_scene, write_script

from restshape.analysis.buckling.buckling import BucklingAnalysis
from restshape.sensitivity.frequency_derivative import parted
from restshape.sensitivity.load_factor_derivative import load_factor_rates
from restshape.sensitivity.steady_derivative import design_derivative

TOLERANCE = 1e-11
HINGED = (HINGES, PUSHED.format(1e3))
WEIGHT = "\n[effects.gravity]\ng = [-10, 0.1]\n"
PRESSED = '\n[supports.head]\non = "right"\nfix = { x = "-1e-5*(1 + y)", y = 0 }\n'
SIDE = '\n[loads.wind]\non = "top"\npressure = "1e3*(1 + x*y)"\n'


def smooth(X: np.ndarray, seed: int = 3) -> np.ndarray:
    """A smooth motion (n, 2) of all nodes that leaves no side straight."""
    a, b, c = np.random.default_rng(seed).uniform(-1.0, 1.0, (3, 2))
    x, y = X.T[:, :, None]
    return 0.05 * (a * np.sin(2 * x + y) + b * y * np.cos(3 * x) + c * y)


def load_factor_derivatives(analysis: BucklingAnalysis, dX: np.ndarray, tolerance: float) -> np.ndarray:
    """Derivatives (k,) of the load factors where nodes move with dX (n, 2), those of coinciding ones ascending."""
    s = design_derivative(analysis.prebuckling, np.stack([dX, np.zeros_like(dX)]), tolerance)[0]
    factors = analysis.state.modes.load_factors
    return parted(factors, load_factor_rates(analysis.state, dX, s), analysis.solver.reach)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(
    "parts",
    [HINGED, (FOOT, WEIGHT), (FOOT, PRESSED), (FOOT, PUSHED.format(1e3), SIDE)],
    ids=["hinged", "weight", "moving support", "wind"],
)
def test_remainder_is_of_second_order(tmp_path, order, parts):
    text = column(*parts, height=0.15, size=0.06, order=order, nu=0.3).replace("tolerance = 1e-9", "tolerance = 1e-12")
    design = Column(tmp_path, text)
    dX = smooth(design.X)
    rates = load_factor_derivatives(design.analysis, dX, TOLERANCE)
    remainders = [np.abs(design.move(h * dX) - design.load_factors - h * rates) for h in (0.04, 0.02)]
    assert np.all(remainders[0] > 1e-7 * design.load_factors), "nothing to compare with"
    np.testing.assert_allclose(np.log2(remainders[0] / remainders[1]), 2.0, atol=0.1)


def test_incompressible(tmp_path):
    text = column(height=0.2, size=0.1, nu=0.4999, model="plane_strain")
    design = Column(tmp_path, text.replace("tolerance = 1e-9", "tolerance = 1e-12"))
    prebuckling = design.analysis.state.prebuckling
    assert "dilatation" in prebuckling.problem.geometric_stiffness(prebuckling.x).element.name
    dX = smooth(design.X)
    rates = load_factor_derivatives(design.analysis, dX, TOLERANCE)
    remainders = [np.abs(design.move(h * dX) - design.load_factors - h * rates) for h in (0.02, 0.01)]
    np.testing.assert_allclose(np.log2(remainders[0] / remainders[1]), 2.0, atol=0.1)


def test_growing_and_moving_the_whole_design(tmp_path):
    """Under forces load factors of a plane body go with its size; a move or a turn with its forces changes nothing."""
    design = Column(tmp_path, column(*HINGED))
    analysis = design.analysis
    grown = load_factor_derivatives(analysis, design.X.copy(), TOLERANCE)
    np.testing.assert_allclose(grown, analysis.load_factors, rtol=1e-7)
    moved = load_factor_derivatives(analysis, np.broadcast_to([0.6, -0.8], design.X.shape).copy(), TOLERANCE)
    assert np.abs(moved).max() < 1e-7 * analysis.load_factors.max()


def test_thinner_columns(tmp_path):
    """P goes with h^3 / L^2: d mu / d ln h = 3 mu, d mu / d ln L = -2 mu, up to shear."""
    design = Column(tmp_path, column(height=0.01, size=0.012))
    x, y = design.X.T
    thicker = load_factor_derivatives(design.analysis, np.column_stack([0 * x, y]), TOLERANCE)
    longer = load_factor_derivatives(design.analysis, np.column_stack([x, 0 * y]), TOLERANCE)
    np.testing.assert_allclose(thicker, 3.0 * design.load_factors, rtol=2e-3)
    np.testing.assert_allclose(longer, -2.0 * design.load_factors, rtol=2e-3)


@pytest.mark.parametrize("inner", [0.05, 0.04999, 0.05001])
def test_twins(tmp_path, inner):
    """Two masts on one base have nearly one load factor twice: with the left one made thinner, its own falls."""
    text = TWINS.replace("f = [0.05, 0.1]", f"f = [{inner}, 0.1]").replace("g = [0.05, 1]", f"g = [{inner}, 1]")
    design = Column(tmp_path, text)
    found = design.load_factors
    assert found[1] / found[0] - 1.0 < 1e-3 and found[2] > 2.0 * found[1]
    x, y = design.X.T
    dX = np.column_stack([np.where(x < 0.3, 0.025 - x, 0.0), 0 * y])
    rates = load_factor_derivatives(design.analysis, dX, TOLERANCE)[:2]
    # P goes with the third power of the width, and the load with the width; the base gives a little.
    np.testing.assert_allclose(np.sort(rates / found[:2]), [-2.0, 0.0], atol=0.05)
    h = 2e-6
    by_rank = (design.move(h * dX) - design.move(-h * dX))[:2] / (2 * h)
    np.testing.assert_allclose(rates / found[:2], by_rank / found[:2], atol=1e-4)
    remainders = [np.abs(design.move(h * dX)[:2] - np.sort(found[:2] + h * rates)).max() for h in (0.04, 0.02)]
    assert remainders[0] / remainders[1] == pytest.approx(4.0, rel=0.1)


def test_a_drag_is_predicted(tmp_path):
    scene = write_scene(tmp_path, column(height=0.05, size=0.03))
    script = write_script(tmp_path, drag("top", (0.5, 0.05), across((0.5, 0.05), (0.5, 0.048), 8)))
    predicted, solved = (rows_of(make_replay(scene, script, predict=way)) for way in ("linear", "none"))
    assert [row["predicted"] for row in predicted] == [0, 0, *[1] * 8, 0]
    errors = [abs(one["q_first"] - two["q_first"]) / two["q_first"] for one, two in zip(predicted, solved)]
    assert errors[9] / errors[5] == pytest.approx(4.0, rel=0.1) and 1e-4 < errors[9] < 1e-2
    assert errors[10] < 1e-7
    for row in predicted[2:10]:
        assert row["iterations"] == 0 and row["ms_krylov"] == row["ms_values"] == 0.0
