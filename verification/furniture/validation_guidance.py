"""Validation of what guides a designer: derivatives, ends of valid ranges, and suggestions that are missed."""

import numpy as np
from petsc4py import PETSc
from restshape_apps.furniture.guidance.force_space import durability_space, stability_space, whole_space
from restshape_apps.furniture.guidance.searchable_piece import SearchablePiece
from restshape_apps.furniture.physics.derivatives import force_derivative
from restshape_apps.furniture.physics.furniture import ALL, UNSTABLE, Furniture
from restshape_apps.furniture.pieces import cantilever, chair, scales, shelf_1, shelf_2, stool_chair, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import FREEDOMS
from restshape_studies.validation.case import Check
from restshape_verification.furniture.enumeration import alone, apart, confirmed, distinct, rays
from restshape_verification.furniture.misses import FIRST_ONLY, MANY, SMALL, UNLIMITED, Grid
from restshape_verification.furniture.validation_statics import G, in_equilibrium

from restshape.guidance.combination_search import Search
from restshape.guidance.ranges import valid_ranges

STEPS = np.array([4e-3, 2e-3, 1e-3])
FIRST, SECOND = 1001, 1001
"""Places of a dense sampling, and of the cells where it sees an end."""


def modes_of(furniture: Furniture) -> DesignModes:
    """The valid design modes of a model."""
    return DesignModes.of(furniture.piece, furniture.kernel.freedoms())


def taylor(comm: PETSc.Comm) -> list[Check]:
    """What the derivatives of forces leave over as a design step is halved."""
    checks = []
    for piece in (table(), table(push=30.0), shelf_1()):
        furniture = in_equilibrium(piece)
        modes, case = modes_of(furniture), len(furniture.cases) - 1
        weights = np.random.default_rng(7).normal(size=len(modes))
        weights /= np.linalg.norm(weights)
        change, base = force_derivative(furniture, modes.directions, case), furniture.forces(case)
        gamma = (weights @ modes.directions).reshape(-1, 8)
        for name in ("u", "tension", "bending", "shear"):
            rest, slope = [], np.tensordot(weights, getattr(change, name), axes=1)
            for step in STEPS:
                furniture.test(step * gamma)
                rest.append(
                    float(np.abs(getattr(furniture.forces(case), name) - getattr(base, name) - step * slope).max())
                )
            furniture.test()
            pushed = " pushed" if case else ""
            order = float(np.log2(rest[0] / rest[-1]) / (len(STEPS) - 1))
            checks.append(Check(f"{piece.name}{pushed}: order of the remainder of {name}", order, 2.0, 0.05, "Taylor"))
    return checks


def range_ends(comm: PETSc.Comm) -> list[Check]:
    """Ends of valid ranges: of a cantilever's length by hand, and of single modes by dense sampling."""
    furniture = in_equilibrium(cantilever(kilograms=0.9))
    modes = modes_of(furniture)
    number = next(k for k, (p, f) in enumerate(modes.freedoms) if p == 2 and FREEDOMS[f] == "length x")
    ranges = valid_ranges(furniture.kernel, modes.direction(np.array([number]), np.array([1.0])), -0.3, 0.5)
    own, load, moment = 700.0 * 0.06 * 0.012 * G / 2, 0.9 * G, 5.2e3 * 0.02 * 3 * 0.006
    longest = (-load + np.sqrt(load**2 + 4 * own * moment)) / (2 * own)
    source = "W l + w l^2 / 2 = what its nails bear"
    by_hand = float(0.19 + ranges.intervals[-1, 1] * modes.unit)
    checks = [Check("longest arm of a nail cantilever [m]", by_hand, float(longest), 1e-5, source)]
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
            Check(f"{piece.name}: largest distance of {met} ends", worst, 0.0, 1.5e-6, source),
            Check(f"{piece.name}: ends found", float(met), float(seen), 0.0, source),
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


def missed(comm: PETSc.Comm) -> list[Check]:
    """Ways of one and two modes that a grid of the full test finds and suggestions do not, on 3 and 4 planks."""
    source = "grids of 201 and 21 x 21 full tests"
    checks = []
    for name, make in SMALL.items():
        grid = Grid.of(make())
        for words, found in (("as shown", grid.as_shown()), ("without limits", grid.beside(UNLIMITED))):
            for less, what in enumerate(("modes", "pairs")):
                title = f"{name}: {what} missed of {found.there[less]}, {words}"
                checks.append(Check(title, float(found.missed[less]), 0.0, 0.0, source))
    return checks


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
                Check(f"{what}: missed of {len(expected)}", float(len(missed)), 0.0, 0.0, source),
                Check(f"{what}: others", float(len(others)), 0.0, 0.0, source),
            ]
    return checks
