"""Suggestions against an enumeration that leaves out nothing, and against the full test."""

from itertools import combinations as choose
from math import comb

import numpy as np
import pytest
from restshape_apps.furniture.pieces import bookshelf_20, cantilever, chair, piece_28, scales, shelf_1, shelf_2, table

from restshape.guidance.force_space import (
    LEAST_GAIN,
    LONGEST,
    ForceSpace,
    combinations,
    contact_space,
    durability_space,
    forecast,
    stability_space,
)
from restshape.guidance.reconnect import reconnections
from restshape.guidance.suggestions import MENDED, suggest
from restshape.guidance.support_planks import FLOOR, support_planks
from restshape.physics.furniture import ALL, LOST, UNSTABLE, WEAK, Furniture
from restshape.shape.design_modes import DesignModes


def model(piece) -> tuple[Furniture, DesignModes]:
    """A tested model and its modes."""
    furniture = Furniture(piece)
    furniture.test()
    return furniture, DesignModes.of(piece, furniture.kernel.freedoms())


def enumerated(space: ForceSpace, most: int) -> dict[tuple[int, ...], tuple[np.ndarray, float, float]]:
    """Every combination that (6.18) to (6.21) let through, one by one, by least squares of LAPACK."""
    found: dict[tuple[int, ...], tuple[np.ndarray, float, float]] = {}
    for count in range(1, most + 1):
        for modes in choose(range(len(space.K)), count):
            if any(set(smaller) <= set(modes) for smaller in found):
                continue
            K = space.K[list(modes)].T
            sizes = np.linalg.norm(K, axis=0)
            if sizes.min() == 0.0 or np.linalg.svd(K / sizes, compute_uv=False)[-1] < 1e-4:
                continue
            y = np.linalg.lstsq(K, -space.gap, rcond=None)[0]
            if not y.any():
                continue
            s = y / np.linalg.norm(y)
            slope = K @ s
            if np.linalg.norm(slope) < LEAST_GAIN:
                continue
            with np.errstate(divide="ignore", invalid="ignore"):
                first, last = (space.low - space.h) / slope, (space.high - space.h) / slope
            enters = max(0.0, np.where(slope > 0, first, np.where(slope < 0, last, 0.0)).max())
            leaves = min(LONGEST, np.where(slope > 0, last, np.where(slope < 0, first, np.inf)).min())
            still = (slope == 0) & ((space.h < space.low) | (space.h > space.high))
            if enters <= leaves and not still.any():
                found[modes] = (s, enters, leaves)
    return found


@pytest.mark.parametrize("make", [table, shelf_1, shelf_2])
def test_rays_are_those_of_the_enumeration_that_leaves_out_nothing(make) -> None:
    furniture, modes = model(make())
    unstable = furniture.test().flaws & UNSTABLE
    space = (stability_space if unstable else durability_space)(furniture, modes)
    few = 22
    space = ForceSpace(np.ascontiguousarray(space.K[:few]), space.h, space.gap, space.low, space.high)
    rays, expected = combinations(space), enumerated(space, 3)
    found = {tuple(int(m) for m in row if m >= 0): k for k, row in enumerate(rays.modes)}
    # A mode that nearly depends on others is left out by one test or the other.
    for key in set(found) ^ set(expected):
        K = space.K[list(key)].T
        assert np.linalg.svd(K / np.linalg.norm(K, axis=0), compute_uv=False)[-1] < 2e-4
    for key in set(found) & set(expected):
        s, enters, leaves = expected[key]
        assert rays.parts[found[key]][: len(key)] == pytest.approx(s, abs=1e-6)
        assert rays.spans[found[key]] == pytest.approx([enters, leaves], abs=1e-6)


def test_rays_in_a_random_force_space_are_those_of_the_enumeration() -> None:
    rng = np.random.default_rng(11)
    for trial in range(6):
        K, h = rng.normal(size=(14, 5)), 1.2 * rng.normal(size=5)
        gap = h if trial % 2 else np.minimum(h, 0.0)
        low, high = (-np.ones(5), np.ones(5)) if trial % 2 else (np.zeros(5), np.full(5, np.inf))
        space = ForceSpace(K, h, gap, low, high)
        if not np.any((h < low) | (h > high)):
            continue
        for most in (1, 2, 3, 4):
            rays, expected = combinations(space, most=most), enumerated(space, most)
            assert {tuple(int(m) for m in row if m >= 0) for row in rays.modes} == set(expected)


def test_the_widest_of_each_leading_mode_are_kept() -> None:
    furniture, modes = model(bookshelf_20())
    space = durability_space(furniture, modes)
    every, kept = combinations(space), combinations(space, keep=1)
    assert kept.tried == every.tried
    best: dict[tuple[int, int], float] = {}
    for row, parts, span in zip(every.modes, every.parts, every.spans):
        key = int((row >= 0).sum()), int(row[np.argmax(np.abs(parts))])
        best[key] = max(best.get(key, 0.0), span[1] - span[0])
    assert sorted(best.values()) == pytest.approx(sorted(kept.spans[:, 1] - kept.spans[:, 0]))


def test_a_forecast_counts_all_combinations() -> None:
    assert forecast(224, 3).combinations == comb(224, 3) + comb(224, 2) + 224
    assert forecast(224, 4).seconds > 50 * forecast(224, 3).seconds


@pytest.mark.parametrize("make", [table, shelf_1, shelf_2, bookshelf_20, piece_28])
def test_every_suggestion_holds_in_the_full_test(make) -> None:
    piece = make()
    suggestions = suggest(Furniture(piece))
    assert 1 <= len(suggestions.found) <= 8
    assert sum(suggestions.tried) > 0
    for one in suggestions.found:
        # A model of its own, from the piece that is shown.
        fresh = Furniture(one.piece(Furniture(piece)))
        assert fresh.test().valid
        left, right = one.span
        assert left <= one.t <= right
        inside = Furniture(piece)
        assert inside.test(0.5 * (left + right) * one.direction).valid or right - left < 0.02
        assert np.linalg.norm(one.parts) == pytest.approx(1.0)
    for a, b in choose(suggestions.found, 2):
        assert set(a.modes) != set(b.modes)
        assert not set(a.modes) < set(b.modes) or len(a.modes) > 1


def test_a_valid_piece_needs_no_suggestion() -> None:
    assert suggest(Furniture(chair())).found == ()


def test_suggestions_are_not_missed_that_a_grid_finds() -> None:
    # Every pair of modes of a weak piece of 3 planks, on a grid of the full test.
    piece = cantilever_too_weak()
    furniture, modes = model(piece)
    assert furniture.test().flaws == WEAK
    grid = np.linspace(-0.35, 0.35, 9)
    alone, pairs = set(), set()
    for number in range(len(modes)):
        d = modes.direction(np.array([number]), np.array([1.0]))
        if (furniture.kernel.scan(d, grid, ALL)[0] == 0).any():
            alone.add(number)
    for a, b in choose(set(range(len(modes))) - alone, 2):
        for t in grid:
            d = modes.direction(np.array([a, b]), np.array([1.0, t]))
            if (furniture.kernel.scan(d, grid, ALL)[0] == 0).any():
                pairs.add((a, b))
    found = suggest(furniture, shown=100).found
    singles = {one.modes[0] for one in found if len(one.modes) == 1}
    assert alone
    assert alone <= singles
    assert pairs <= {tuple(one.modes) for one in found if len(one.modes) == 2}


def cantilever_too_weak():
    """The nail cantilever under twice what it bears."""
    return cantilever(kilograms=1.8)


def test_contact_forces_are_a_force_space_too() -> None:
    furniture, modes = model(table())
    space = contact_space(furniture, modes)
    assert space.h.sum() == pytest.approx(1.0)
    assert np.abs(space.K.sum(axis=1)).max() < 1.0


def test_lost_joints_are_brought_back() -> None:
    piece = table()
    away = np.zeros((len(piece.planks), 8))
    away[1, 1] = -0.2
    lost = Furniture(Furniture(piece).moved(away))
    assert lost.test().flaws & LOST
    ways = reconnections(lost)
    assert len(ways) >= 3
    for way in ways:
        assert not lost.test(way.t * way.direction).flaws & LOST
        assert lost.test((way.span[0] - 1e-4) * way.direction).flaws & LOST
    # Back by a quarter of what it was moved: the leg's half width of 60 mm must meet the top by 10 mm.
    back = next(way for way in ways if way.mode == "leg-1: move y")
    assert back.span[0] * DesignModes.of(lost.piece, []).unit == pytest.approx(0.05, abs=1e-4)


def test_a_support_plank_relieves_a_weak_joint() -> None:
    piece = table(kilograms=41.0)
    furniture = Furniture(piece)
    before = furniture.test()
    assert before.flaws == WEAK
    found = support_planks(furniture)
    assert found
    for one in found:
        assert len(one.piece.planks) == len(piece.planks) + 1
        verdict = Furniture(one.piece).test()
        assert verdict.valid
        assert verdict.pull < before.pull
        assert not Furniture(one.piece).geometry().overlaps


def test_the_floor_counts_as_a_plank_that_a_support_stands_on() -> None:
    piece = shelf_1()
    furniture = Furniture(piece)
    furniture.test()
    (found,) = support_planks(furniture)
    bracket, upright = piece.joints[found.relieved[0]].i, piece.joints[found.relieved[0]].j
    assert (found.between, found.third) == ((bracket, FLOOR), upright)
    post = found.piece.planks[-1]
    # From the floor to the lower face of the bracket.
    under = piece.planks[bracket].centre[2] - 0.5 * piece.planks[bracket].size[2]
    assert sorted(post.end(side)[2] for side in (0, 1)) == pytest.approx([0.0, under], abs=1e-6)
    assert Furniture(found.piece).test().valid


def test_a_support_plank_relieves_its_joint_and_overloads_none() -> None:
    piece = bookshelf_20()
    before, furniture = weak(piece), Furniture(piece)
    furniture.test()
    found = support_planks(furniture)
    assert len(before) == 3
    assert len(found) == 2
    for one in found:
        assert weak(one.piece) == before - set(one.relieved)
        assert one.relieved
        assert not one.verdict.valid


def weak(piece) -> set[int]:
    """Numbers of joints that break."""
    furniture = Furniture(piece)
    furniture.test()
    forces = furniture.forces()
    return set(np.flatnonzero(np.maximum(forces.pull_use, forces.shear_use) > 1.0).tolist())


def test_a_search_looks_for_a_few_directions_again() -> None:
    once, again = suggest(Furniture(scales()), mended=0), suggest(Furniture(scales()))
    assert once.mended == 0
    assert 0 < again.mended <= MENDED
    assert len(again.found) > len(once.found)
    for one in again.found:
        assert Furniture(one.piece(Furniture(scales()))).test().valid


@pytest.mark.parametrize("make", [scales, table])
def test_the_range_of_a_suggestion_is_followed_beyond_its_prediction(make) -> None:
    furniture = Furniture(make())
    for one in suggest(furniture).found:
        t = np.linspace(*one.span, 33)[1:-1]
        good = furniture.kernel.scan(one.direction, t, ALL)[0] == 0
        assert good.mean() > 0.9
        beyond = one.span[1] + 0.01
        if beyond < LONGEST:
            assert furniture.kernel.scan(one.direction, np.array([beyond]), ALL)[0][0] != 0
