"""Suggestions against an enumeration that leaves out nothing, and against the full test."""

from itertools import combinations as choose
from math import comb

import numpy as np
import pytest
from restshape_apps.furniture.guidance.force_space import contact_space, durability_space, stability_space, whole_space
from restshape_apps.furniture.guidance.searchable_piece import SearchablePiece
from restshape_apps.furniture.guidance.suggestions import suggest
from restshape_apps.furniture.guidance.support_planks import FLOOR, support_planks
from restshape_apps.furniture.physics.furniture import ALL, UNSTABLE, WEAK, Furniture
from restshape_apps.furniture.pieces import bookshelf_20, cantilever, chair, piece_28, scales, shelf_1, shelf_2, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.small_pieces import toppling
from restshape_verification.furniture.enumeration import alone, apart, confirmed, distinct, rays
from restshape_verification.furniture.misses import FIRST_ONLY, MANY

from restshape.guidance.combination_search import Limits, Search
from restshape.guidance.force_space import LONGEST, ForceSpace, combinations, forecast


def model(piece) -> tuple[Furniture, DesignModes]:
    """A tested model and its modes."""
    furniture = Furniture(piece)
    furniture.test()
    return furniture, DesignModes.of(piece, furniture.kernel.freedoms())


@pytest.mark.parametrize("make", [table, shelf_1, shelf_2])
def test_rays_are_those_of_the_enumeration_that_leaves_out_nothing(make) -> None:
    furniture, modes = model(make())
    unstable = furniture.test().flaws & UNSTABLE
    space = (stability_space if unstable else durability_space)(furniture, modes)
    few = 22
    space = ForceSpace(np.ascontiguousarray(space.K[:few]), space.h, space.gap, space.low, space.high)
    found = {tuple(map(int, some)): (parts, span) for some, parts, span in combinations(space).each()}
    expected = rays(space, 3)
    assert len(found) > 50
    # A mode that takes next to no part counts, or depends on others, by rounding.
    for key in set(found) ^ set(expected):
        assert np.abs((found.get(key) or expected[key])[0]).min() < 1e-4
    for key in set(found) & set(expected):
        direction, enters, leaves = expected[key]
        assert found[key][0] == pytest.approx(direction, abs=1e-3)
        assert found[key][1] == pytest.approx([enters, leaves], abs=1e-3)


@pytest.mark.slow
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
            found, expected = combinations(space, most=most), rays(space, most)
            assert {tuple(map(int, some)) for some, _, _ in found.each()} == set(expected)


def test_of_modes_that_do_the_same_the_shortest_change_is_taken() -> None:
    # Two and three equal columns, one of twice the size, and one of its own: by the pseudoinverse of numpy.
    K = np.array([[1.0, 0.0], [1.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.3, 1.0]])
    h = np.array([1.3, 0.4])
    space = ForceSpace(K, h, h, -np.ones(2), np.ones(2))
    found = {tuple(map(int, some)): parts for some, parts, _ in combinations(space, longest=2.0).each()}
    assert len(found) == 5 + 10 + 10
    for some, parts in found.items():
        y = np.linalg.pinv(K[list(some)].T) @ -h
        assert parts == pytest.approx(y / np.linalg.norm(y), abs=1e-9)


def test_what_holds_a_barred_combination_is_left_out() -> None:
    rng = np.random.default_rng(3)
    h = np.array([1.4, -1.2, 1.1])
    space = ForceSpace(rng.normal(size=(12, 3)), h, h, -np.ones(3), np.ones(3))
    barred = [(2,), (0, 5), (1, 4, 7)]
    every, left = (
        {tuple(map(int, some)) for some, _, _ in combinations(space, 4, barred=bars).each()} for bars in ((), barred)
    )
    assert left == {some for some in every if not any(set(bar) <= set(some) for bar in barred)} < every


@pytest.mark.slow
@pytest.mark.parametrize("make", [scales, table, shelf_1, shelf_2, toppling], ids=lambda make: make.__name__)
def test_suggestions_are_those_of_the_enumeration_that_leaves_out_nothing(make) -> None:
    furniture, modes = model(make())
    unstable = furniture.test().flaws & UNSTABLE
    for forces in (stability_space, whole_space) if unstable else (durability_space,):
        furniture.test()
        every = rays(forces(furniture, modes), 3)
        expected = distinct(alone(furniture, modes) | confirmed(furniture, modes, every))
        search = Search(SearchablePiece(furniture, modes, forces), ALL, FIRST_ONLY)
        assert apart({one.modes for one in search.run(3, MANY)}, expected) == (set(), set())
        assert expected


@pytest.mark.slow
def test_what_the_full_test_rejects_bars_nothing() -> None:
    # A pair whose ray enters the box and fails must not take with it the triples that hold it.
    furniture, modes = model(table())
    every = rays(durability_space(furniture, modes), 3)
    good = alone(furniture, modes) | confirmed(furniture, modes, every)
    failed = [set(some) for some in every if len(some) == 2 and some not in good]
    kept = [some for some in distinct(good) if any(pair < set(some) for pair in failed)]
    found = {one.modes for one in suggest(furniture, shown=MANY, limits=FIRST_ONLY).found}
    assert kept
    assert apart(found, set(kept))[0] == set()


@pytest.mark.slow
def test_with_its_limits_a_search_shows_what_the_enumeration_has() -> None:
    for make in (table, shelf_1, shelf_2):
        furniture, modes = model(make())
        unstable = furniture.test().flaws & UNSTABLE
        expected: set[tuple[int, ...]] = set()
        for forces in (stability_space, whole_space) if unstable else (durability_space,):
            furniture.test()
            expected |= confirmed(furniture, modes, rays(forces(furniture, modes), 3))
        expected = distinct(alone(furniture, modes) | expected)
        limits = Limits(mended=0, continued=0)
        found = {one.modes for one in suggest(furniture, limits=limits).found}
        assert apart(found, expected)[1] == set()
        assert len(found) >= min(3, len(expected))


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
        fresh = Furniture(Furniture(piece).moved(one.gamma))
        assert fresh.test().valid
        left, right = one.span
        assert left <= one.t <= right
        inside = Furniture(piece).kernel.scan(one.direction, np.linspace(left, right, 24)[1:-1], ALL)[0]
        assert not inside.any()
        assert np.linalg.norm(one.parts) == pytest.approx(1.0)
    for a, b in choose(suggestions.found, 2):
        assert set(a.modes) != set(b.modes)
        assert not set(a.modes) < set(b.modes) or len(a.modes) > 1


def test_a_valid_piece_needs_no_suggestion() -> None:
    assert suggest(Furniture(chair())).found == ()


@pytest.mark.parametrize("make", [scales, shelf_1, shelf_2, bookshelf_20])
def test_ends_of_shown_ranges_are_sharp(make) -> None:
    furniture = Furniture(make())
    for one in suggest(furniture).found:
        for end, out in zip(one.span, (-1.0, 1.0)):
            if end >= LONGEST:
                assert one.beyond
                continue
            t = np.array([end - 2e-6 * out, end + 2e-6 * out])
            inside, outside = furniture.kernel.scan(one.direction, t, ALL)[0]
            assert inside == 0
            assert outside != 0


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


def test_a_support_plank_relieves_a_weak_joint() -> None:
    piece = table(kilograms=41.0)
    furniture = Furniture(piece)
    before = furniture.test()
    assert before.flaws == WEAK
    found = support_planks(furniture)
    assert found
    for one in found:
        assert len(one.piece.planks) == len(piece.planks) + 1
        result = Furniture(one.piece).test()
        assert result.valid
        assert result.pull < before.pull
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


@pytest.mark.slow
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
        assert not one.result.valid


def weak(piece) -> set[int]:
    """Numbers of joints that break."""
    furniture = Furniture(piece)
    furniture.test()
    forces = furniture.forces()
    return set(np.flatnonzero(np.maximum(forces.pull_utilisation, forces.shear_utilisation) > 1.0).tolist())


def test_a_search_looks_for_a_few_directions_again() -> None:
    once, again = suggest(Furniture(scales()), limits=Limits(mended=0)), suggest(Furniture(scales()))
    assert once.mended == 0
    assert again.mended > 0
    assert len(again.found) > len(once.found)
    for one in again.found:
        assert Furniture(Furniture(scales()).moved(one.gamma)).test().valid


def test_one_more_mode_is_found_where_a_single_one_fails() -> None:
    # A wider bracket has no wider joint than the upright is wide: by derivatives where the bracket is wider already.
    piece = shelf_1()
    first, onward = (suggest(Furniture(piece), limits=Limits(continued=count)).found for count in (0, 4))
    new = {one.words for one in onward} - {one.words for one in first}
    assert new == {("upright-1: length y", "bracket-1: length y")}
    (wide,) = (one for one in onward if one.words in new)
    joint = piece.joints.index(next(joint for joint in piece.joints if piece.planks[joint.i].name == "bracket-1"))
    uprights = Furniture(Furniture(piece).moved(wide.gamma))
    assert uprights.geometry().length[joint] > piece.planks[piece.index("upright-1")].size[1]


@pytest.mark.parametrize("make", [scales, table])
def test_the_range_of_a_suggestion_is_followed_beyond_its_prediction(make) -> None:
    furniture = Furniture(make())
    for one in suggest(furniture).found:
        t = np.linspace(*one.span, 33)[1:-1]
        assert not furniture.kernel.scan(one.direction, t, ALL)[0].any()
        beyond = one.span[1] + 0.01
        if beyond < LONGEST:
            assert furniture.kernel.scan(one.direction, np.array([beyond]), ALL)[0][0] != 0


@pytest.mark.parametrize(
    "make",
    [
        lambda: cantilever(kilograms=2.0),
        lambda: cantilever(kilograms=2.8),
        lambda: cantilever(width=0.05, arm=0.3, kilograms=1.5),
        table,
        shelf_2,
        toppling,
    ],
    ids=["2.0 kg", "2.8 kg", "narrow", "table", "shelf 2", "falls"],
)
def test_every_single_mode_that_holds_somewhere_is_found(make) -> None:
    # Dense samples of the full test along each mode, which share no place, direction or derivative with the search.
    furniture, modes = model(make())
    expected = alone(furniture, modes)
    found = {one.modes for one in suggest(furniture, 1, MANY).found}
    assert len(expected) >= 3
    assert found >= expected


def test_a_wider_arm_alone_mends_a_cantilever_far_beyond_what_it_bears() -> None:
    # Fasteners are whole: the use of 2.04 becomes less than one with the eighth nail of 20 mm, where there were three.
    furniture = Furniture(cantilever(kilograms=2.0))
    found = suggest(furniture).found
    words = {one.words for one in found}
    assert ("beam: length y",) in words
    assert all(len(one) == 1 for one in words)


@pytest.mark.parametrize("width, kilograms", [(0.05, 1.6), (0.06, 2.0), (0.08, 1.8)])
def test_no_invalid_stretch_hides_in_a_range_that_is_shown(width, kilograms) -> None:
    # The whole number of nails cuts what looks like one range in two.
    piece = scales(width=width, kilograms=kilograms)
    suggestions = suggest(Furniture(piece)).found
    assert suggestions
    for one in suggestions:
        t = np.linspace(*one.span, 101)[1:-1]
        assert not Furniture(piece).kernel.scan(one.direction, t, ALL)[0].any()
        assert one.span[0] <= one.t <= one.span[1]
