"""Scans along a way: each place is judged as it is by itself, in less work beside the place before."""

from dataclasses import replace

import numpy as np
import pytest
from restshape_apps.furniture.guidance.design import Design, Guidance
from restshape_apps.furniture.physics.furniture import ALL, LOST, OVERLAPPING, UNSTABLE, Furniture
from restshape_apps.furniture.pieces import SCENES, drawn, table
from restshape_apps.furniture.shape.planks import Load, Piece, Plane

PLACES = 65


def ways(piece: Piece, most: int) -> tuple[Furniture, list[np.ndarray]]:
    """A model of a piece, and directions (n, 8): some of its freedoms, and one that changes three of them."""
    design, rng = Design.closed(piece, Guidance()), np.random.default_rng(7)
    free = sorted(design.freedoms)
    some = [[free[k]] for k in rng.permutation(len(free))[:most]]
    some.append([free[k] for k in rng.permutation(len(free))[:3]])
    directions = []
    for freedoms in some:
        direction = np.zeros((len(piece.planks), 8))
        for plank, number in freedoms:
            direction[plank, number] = rng.normal()
        directions.append(design.design_direction(direction, "way"))
    return design.furniture, [one.high * one.direction for one in directions]


def on_floor(piece: Piece, mu: float) -> Piece:
    """The piece on a floor of another friction, pushed from the side."""
    shove = Load("shove", piece.weights[0].plank if piece.weights else 0, (0.0, 0.2, 0.5), (8.0, 5.0, -3.0))
    return replace(piece, planes=(Plane(mu=mu),), pushes=(*piece.pushes, shove))


PIECES = {path.stem: drawn(path.stem) for path in sorted(SCENES.glob("*.toml"))}
SMOOTH = {
    f"{name} on a floor of {mu:g}": on_floor(PIECES[name], mu) for name in ("table", "chair-1") for mu in (0.0, 0.1)
}


@pytest.mark.parametrize("piece", [*PIECES.values(), *SMOOTH.values()], ids=[*PIECES, *SMOOTH])
def test_a_scan_finds_what_tests_of_each_place_do(piece: Piece) -> None:
    furniture, found = ways(piece, 3)
    t = np.linspace(-1.0, 1.0, PLACES)
    for direction in found:
        for wanted in (ALL, UNSTABLE):
            alone = []
            for part in t:
                furniture.kernel.forget()
                alone.append(furniture.test(part * direction, ALL).flaws & wanted)
            furniture.kernel.forget()
            together = furniture.kernel.scan(direction, t, wanted)[0]
            assert np.array_equal(together == 0, np.array(alone) == 0)


def test_planks_that_overlap_are_found_whatever_separated_them_before() -> None:
    """By the axes of the place before, and by all of them: pairs that pass into each other along a way, and out."""
    changes = 0
    for piece in PIECES.values():
        furniture, found = ways(piece, 2)
        for direction in found:
            before: tuple[tuple[int, int], ...] | None = None
            for part in np.linspace(-3.0, 3.0, 25):
                overlaps = tuple(furniture.test(part * direction, OVERLAPPING).found.overlaps)
                if furniture.test(part * direction, LOST).flaws & LOST:
                    continue
                assert overlaps == furniture.geometry(part * direction).overlaps
                changes += before is not None and before != overlaps
                before = overlaps
    assert changes > 10


def test_the_place_before_says_how_the_next_one_stands() -> None:
    furniture, (direction, *_) = ways(on_floor(table(kilograms=20.0), 0.5), 1)
    t, fits = np.linspace(-0.1, 0.1, PLACES), []
    for alone in (True, False):
        before = furniture.kernel.fits
        for part in t:
            if alone:
                furniture.kernel.forget()
            furniture.kernel.scan(direction, np.array([part]), UNSTABLE)
        fits.append(furniture.kernel.fits - before)
    # One for each of two cases, but where contacts change.
    assert 2 * PLACES <= fits[1] < 2.5 * PLACES < 0.4 * fits[0]


def test_a_quick_test_ends_with_the_first_case_that_breaks_a_joint() -> None:
    furniture = Furniture(on_floor(table(), 0.5))
    steps = []
    for quick in (False, True):
        furniture.kernel.forget()
        before = furniture.kernel.steps
        assert furniture.test(wanted=ALL, quick=quick).flaws
        steps.append(furniture.kernel.steps - before)
    assert 0 < steps[1] <= 0.5 * steps[0]


def test_a_quick_test_ends_with_the_first_case_that_it_falls_in() -> None:
    piece = on_floor(table(kilograms=20.0), 0.0)
    furniture = Furniture(replace(piece, pushes=piece.pushes[-1:] * 2))
    assert len(furniture.test(wanted=UNSTABLE).found.falls) == 2
    assert len(furniture.test(wanted=UNSTABLE, quick=True).found.falls) == 1
