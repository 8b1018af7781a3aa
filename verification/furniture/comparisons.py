"""What guides a designer beside restshape's own full test: ends of valid ranges, and suggestions that are missed."""

import numpy as np
from petsc4py import PETSc
from restshape_apps.furniture.guidance.force_space import durability_space, stability_space, whole_space
from restshape_apps.furniture.guidance.searchable_piece import SearchablePiece
from restshape_apps.furniture.physics.furniture import ALL, UNSTABLE, Furniture
from restshape_apps.furniture.pieces import chair, scales, shelf_1, shelf_2, stool_chair, table
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import OWN, Case, Check
from restshape_verification.furniture.enumeration import alone, apart, confirmed, distinct, rays
from restshape_verification.furniture.misses import FIRST_ONLY, MANY, SMALL, UNLIMITED, Grid
from restshape_verification.furniture.validation_guidance import modes_of
from restshape_verification.furniture.validation_statics import in_equilibrium

from restshape.guidance.combination_search import Search
from restshape.guidance.ranges import valid_ranges

FIRST, SECOND = 1001, 1001
"""Places of a dense sampling, and of the cells where it sees an end."""


def sampled_ranges(comm: PETSc.Comm) -> list[Check]:
    """Ends of valid ranges of single modes, by dense sampling of the full test."""
    checks = []
    for piece in (table(kilograms=20.0), chair(), stool_chair()):
        worst, seen, met = 0.0, 0, 0
        furniture = in_equilibrium(piece)
        modes = modes_of(furniture)
        for number in np.random.default_rng(5).choice(len(modes), 5, replace=False):
            direction = modes.direction(np.array([number]), np.array([1.0]))
            ends = valid_ranges(furniture.kernel, direction, -0.5, 0.5, samples=97).intervals.ravel()
            for place in sampled_ends(furniture, direction):
                away = float(np.abs(ends - place).min()) if len(ends) else np.inf
                seen, met = seen + 1, met + (away <= 1e-3)
                worst = max(worst, away) if away <= 1e-3 else worst
        source = "1001 samples of the full test, and 1001 in each cell that changes"
        checks += [
            Check(f"{piece.name}: largest distance of {met} ends", worst, 0.0, 1.5e-6, source, OWN),
            Check(f"{piece.name}: ends found", float(met), float(seen), 0.0, source, OWN),
        ]
    return checks


def sampled_ends(furniture: Furniture, direction: np.ndarray) -> list[float]:
    """Where the full test changes its mind along -0.5 <= t <= 0.5, by sampling in two stages."""
    ends = []
    t = np.linspace(-0.5, 0.5, FIRST)
    good = furniture.kernel.scan(direction, t, ALL)[0] == 0
    for k in np.flatnonzero(good[1:] != good[:-1]):
        fine = np.linspace(t[k], t[k + 1], SECOND)
        inside = furniture.kernel.scan(direction, fine, ALL)[0] == 0
        ends += [0.5 * float(fine[m] + fine[m + 1]) for m in np.flatnonzero(inside[1:] != inside[:-1])]
    return ends


@each_week(SMALL=dict(list(SMALL.items())[:2]))
def missed(comm: PETSc.Comm) -> list[Check]:
    """Ways of one and two modes that a grid of the full test finds and suggestions do not, on 3 and 4 planks."""
    source = "grids of 201 and 21 x 21 full tests"
    checks = []
    for name, make in SMALL.items():
        grid = Grid.of(make())
        for words, found in (("as shown", grid.as_shown()), ("without limits", grid.beside(UNLIMITED))):
            for less, what in enumerate(("modes", "pairs")):
                title = f"{name}: {what} missed of {found.there[less]}, {words}"
                checks.append(Check(title, float(found.missed[less]), 0.0, 0.0, source, OWN))
    return checks


# apps/furniture/tests/test_suggestions.py compares the same pieces every day.
@each_week()
def enumerated(comm: PETSc.Comm) -> list[Check]:
    """Suggestions beside those of every combination of modes, tried one by one with nothing left out."""
    checks = []
    for piece in (scales(), table(), shelf_1(), shelf_2(), SMALL["cantilever that falls"]()):
        furniture = in_equilibrium(piece)
        modes, unstable = modes_of(furniture), furniture.test().flaws & UNSTABLE
        for forces in (stability_space, whole_space) if unstable else (durability_space,):
            furniture.test()
            rest = confirmed(furniture, modes, rays(forces(furniture, modes), 3))
            expected = distinct(alone(furniture, modes) | rest)
            search = Search(SearchablePiece(furniture, modes, forces), ALL, FIRST_ONLY)
            found = {one.modes for one in search.run(3, MANY)}
            what = f"{piece.name}, {'stability and joints' if forces is whole_space else 'one of both'}"
            source = "401 places of each mode, least squares of each combination of at most 3"
            missed, others = apart(found, expected)
            checks += [
                Check(f"{what}: missed of {len(expected)}", float(len(missed)), 0.0, 0.0, source, OWN),
                Check(f"{what}: others", float(len(others)), 0.0, 0.0, source, OWN),
            ]
    return checks


COMPARISONS: dict[str, Case] = {"sampled_ranges": sampled_ranges, "enumerated": enumerated, "missed": missed}
