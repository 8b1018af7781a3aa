"""Valid ranges against dense sampling and against limits worked by hand."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.guidance.force_space import durability_space
from restshape_apps.furniture.physics.furniture import ALL, UNSTABLE, Compliance, Furniture
from restshape_apps.furniture.pieces import bookshelf, cantilever, chair, stool_chair, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import FREEDOMS, Load
from restshape_apps.furniture.small_pieces import block, stool

from restshape.guidance.ranges import predicted_ends, valid_ranges


def model(piece) -> tuple[Furniture, DesignModes]:
    """A tested model and its modes."""
    furniture = Furniture(piece)
    furniture.test()
    return furniture, DesignModes.of(piece, furniture.kernel.freedoms())


@pytest.mark.parametrize(
    "piece",
    [table(kilograms=20.0), chair(), stool_chair(), bookshelf((4,), 2, 1, heavy=22.0)],
    ids=lambda p: p.name,
)
def test_ranges_are_those_of_dense_sampling(piece) -> None:
    furniture, modes = model(piece)
    rng = np.random.default_rng(5)
    several = 0
    for number in rng.choice(len(modes), 8, replace=False):
        direction = modes.direction(np.array([number]), np.array([1.0]))
        ranges = valid_ranges(furniture.kernel, direction, -0.5, 0.5, samples=97)
        t = np.linspace(-0.5, 0.5, 1537)
        good = furniture.kernel.scan(direction, t, ALL)[0] == 0
        marks = np.flatnonzero(good[1:] != good[:-1])
        several += len(ranges.intervals) > 0
        # An end that sampling sees lies in its cell; a range narrower than a sample may hide from both.
        ends = np.sort(np.concatenate([ranges.intervals.ravel(), []]))
        ends = ends[np.abs(ends) < 0.5]
        if len(ends) == len(marks):
            assert np.all((t[marks] - 1e-6 <= ends) & (ends <= t[marks + 1] + 1e-6))
        else:
            assert np.all([np.any((t[m] - 1e-6 <= ends) & (ends <= t[m + 1] + 1e-6)) for m in marks if wide(good, m)])
        for left, right in ranges.intervals:
            inside = np.array([left, right])
            assert np.all(furniture.kernel.scan(direction, inside, ALL)[0] == 0)
            outside = np.array([left - 1e-6, right + 1e-6])
            outside = outside[np.abs(outside) < 0.5]
            assert np.all(furniture.kernel.scan(direction, outside, ALL)[0] != 0)
    assert several


def wide(good: np.ndarray, mark: int) -> bool:
    """Whether what lies on both sides of a mark is wider than the samples of a range."""
    runs = 1536 // 96 + 1
    return len(set(good[mark + 1 : mark + 1 + runs])) == 1 and len(set(good[max(mark - runs, 0) : mark + 1])) == 1


def test_the_range_of_a_cantilever_ends_where_its_joint_breaks() -> None:
    arm, kilograms = 0.19, 0.9
    furniture, modes = model(cantilever(arm=arm, kilograms=kilograms))
    number = next(k for k, (p, f) in enumerate(modes.freedoms) if p == 2 and FREEDOMS[f] == "length x")
    direction = modes.direction(np.array([number]), np.array([1.0]))
    ranges = valid_ranges(furniture.kernel, direction, -0.3, 0.5)
    # m g l + rho g b t l^2 / 2 = 5.2 kN/m x 20 mm x 3 x 6 mm.
    own, load = 700.0 * 0.06 * 0.012 * 9.80665 / 2, kilograms * 9.80665
    moment = 5.2e3 * 0.02 * 3 * 0.006
    longest = (-load + np.sqrt(load**2 + 4 * own * moment)) / (2 * own)
    assert ranges.intervals[-1, 1] == pytest.approx((longest - arm) / modes.unit, abs=2e-6)
    assert ranges.holds(0.0)


def test_a_prediction_narrows_the_bracket() -> None:
    furniture, modes = model(cantilever(kilograms=0.9))
    number = next(k for k, (p, f) in enumerate(modes.freedoms) if p == 2 and FREEDOMS[f] == "length x")
    part = np.zeros(len(modes))
    part[number] = 1.0
    hints = predicted_ends(durability_space(furniture, modes), part)
    direction = modes.direction(np.array([number]), np.array([1.0]))
    with_hints = valid_ranges(furniture.kernel, direction, -0.1, 0.5, hints=hints, samples=5)
    without = valid_ranges(furniture.kernel, direction, -0.1, 0.5, samples=97)
    assert with_hints.intervals == pytest.approx(without.intervals, abs=2e-6)


def test_a_load_that_crosses_a_tripod_has_two_ends() -> None:
    # The board slides under its own weight: its middle must stay above the triangle of the feet.
    feet = [(-0.3, -0.3), (0.3, -0.3), (0.0, 0.3)]
    furniture = Furniture(stool(feet, (0.0, 0.0), 30.0), Compliance(least_overlap=1e-6))
    furniture.test()
    direction = np.zeros((4, 8))
    direction[0, 0] = 1.0
    ranges = valid_ranges(furniture.kernel, direction, -0.45, 0.45, wanted=UNSTABLE)
    # At y = 0 the triangle is 0.3 m wide; the legs weigh next to nothing.
    assert ranges.intervals == pytest.approx(np.array([[-0.15, 0.15]]), abs=1e-4)


def test_a_block_stands_until_it_is_too_narrow_for_a_push() -> None:
    base, high, wide, mu = 0.1, 0.5, 0.4, 2.0
    own = Furniture(block(base, high, mu)).geometry().mass[0] * 9.80665
    pushes = tuple(Load(f"push {s}", 0, (0.0, 0.0, 0.0), (0.0, s * 0.3 * own, 0.0)) for s in (-1, 1))
    furniture = Furniture(replace(block(base, high, mu), pushes=pushes))
    assert furniture.test().flaws & UNSTABLE == 0
    direction = np.zeros((1, 8))
    direction[0, 7] = -1.0
    # The push stays 0.3 of the first weight, at half the height: 0.3 W h / 2 < W b^2 / (2 wide).
    ranges = valid_ranges(furniture.kernel, direction, -0.2, 0.3, wanted=UNSTABLE)
    assert ranges.intervals == pytest.approx(np.array([[-0.2, wide - np.sqrt(0.3 * high * wide)]]), abs=1e-6)


def test_a_board_that_passes_another_has_two_intervals() -> None:
    piece = chair()
    furniture = Furniture(piece)
    seat, stretcher = (piece.planks[piece.index(name)] for name in ("seat", "stretcher"))
    direction = np.zeros((len(piece.planks), 8))
    direction[piece.index("stretcher"), 2] = np.sign(stretcher.axes[2, 2])
    ranges = valid_ranges(furniture.kernel, direction, -0.1, 0.35)
    away = seat.centre[2] - stretcher.centre[2]
    gap = 0.012 - 1e-4
    assert ranges.intervals[:, 0] == pytest.approx([-0.1, away + gap], abs=1e-6)
    assert ranges.intervals[0, 1] == pytest.approx(away - gap, abs=1e-6)
