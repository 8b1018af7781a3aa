"""Hard cases of furniture: no friction, planks in each other, parts, short legs, limits, mirrors, 60 planks, chance."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from restshape_apps.furniture.analysis.plank_equilibrium import PlankEquilibrium
from restshape_apps.furniture.guidance.suggestions import suggest
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, UNSTABLE, WEAK, Furniture
from restshape_apps.furniture.pieces import PIECES, bookshelf, cantilever, shelf_1, stool_chair, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import Load, Piece, Plane
from restshape_apps.furniture.small_pieces import bench, block, ladder, mirrored, stool
from restshape_studies.stability.case import Case, Statement, Trial, below, near, true
from restshape_studies.stability.known_bounds import CONDITIONED, DIRECT, EXACT
from restshape_verification.furniture.stability_contacts import (
    FINE,
    G,
    balanced,
    falls,
    feet_in_a_line,
    feet_on_two_planes,
    hardly_parallel,
    mirrored_pair,
    sliding_feet,
)

from restshape.guidance.ranges import valid_ranges


def zero_friction(trial: Trial) -> Iterator[Statement]:
    """A floor without friction: slanted legs thrust into their joints alone, and what is pushed slides away."""
    piece = table()
    rough, smooth = Furniture(piece), Furniture(replace(piece, planes=(Plane(mu=0.0),)))
    results = rough.test(), smooth.test()
    yield true("the table stands", not results[1].flaws & UNSTABLE)
    yield below("sideways force of a foot [N]", float(np.abs(smooth.forces().contacts[:, :2]).max()), DIRECT)
    yield true("friction takes load off its weakest joint", results[0].pull < results[1].pull)
    yield balanced(smooth)
    for push in (1e-3, 1.0):
        load = Load("push", 0, (0.0, 0.0, 0.0), (push, 0.0, 0.0))
        yield true(f"a push of {push:g} N makes a block slide", falls(replace(block(0.2, 0.4, 0.0), pushes=(load,))))
    yield true("a steep ladder slides", falls(ladder(1.4, 0.0)))
    found = suggest(smooth).found
    fresh = [Furniture(smooth.moved(s.gamma)).test().valid for s in found]
    yield true("suggestions hold in a test of their own", bool(found) and all(fresh), float(len(found)))


def planks_in_each_other(trial: Trial) -> Iterator[Statement]:
    """A leg's twin stands in its place, in part of it, and flush beside it: seen as such, with finite numbers."""
    piece = bench(leg=0.02)
    for shift, overlap in ((0.0, True), (1e-6, True), (0.005, True), (0.02 - 2e-4, True), (0.02, False), (0.1, False)):
        centre = piece.planks[1].centre + np.array([shift, 0.0, 0.0])
        planks = (*piece.planks, replace(piece.planks[1], name="twin", centre=centre))
        joints, feet = (*piece.joints, replace(piece.joints[0], i=3)), (*piece.feet, replace(piece.feet[0], plank=3))
        furniture = Furniture(replace(piece, planks=planks, joints=joints, feet=feet))
        result = furniture.test()
        words = "overlap" if overlap else "do not"
        yield true(f"twins {shift * 1e3:g} mm apart {words}", bool(result.flaws & OVERLAPPING) is overlap)
        forces = furniture.forces()
        yield true("finite forces", bool(np.isfinite(forces.contacts).all() and np.isfinite(forces.bending).all()))
        yield balanced(furniture)
        if not shift:
            shares = forces.contacts.reshape(-1, 4, 3)[:, :, 2].sum(axis=1)[[0, 2]]
            yield near("each of two in one place bears half", shares[0], shares[1], EXACT)


def parts(trial: Trial) -> Iterator[Statement]:
    """Two benches that nothing joins, on the floor or one in the air: each has the forces that it has alone."""
    one = bench(leg=0.02)
    alone = Furniture(one)
    alone.test()
    for lift in (0.0, 0.3):
        away = np.array([0.0, 2.0, lift])
        twins = (replace(p, centre=p.centre + away, name=p.name + "'") for p in one.planks)
        feet = tuple(replace(f, plank=f.plank + 3) for f in one.feet) if not lift else ()
        both = Furniture(
            Piece(
                (*one.planks, *twins),
                (*one.joints, *(replace(j, i=j.i + 3, j=j.j + 3) for j in one.joints)),
                (*one.feet, *feet),
                one.planes,
                (*one.weights, *(replace(w, plank=w.plank + 3) for w in one.weights)),
            )
        )
        result = both.test()
        yield true("two parts are seen", both.kernel.parts == 2)
        yield true(f"with one {lift:g} m in the air it {'falls' if lift else 'stands'}", falls_as(result.flaws, lift))
        yield near("moments of the first as alone", both.forces().bending[:2], alone.forces().bending, DIRECT)


def falls_as(flaws: int, lift: float) -> bool:
    """Whether what is in the air falls, and what is not stands."""
    return bool(flaws & UNSTABLE) is (lift > 0.0)


CORNERS = [(-0.4, -0.4), (0.4, -0.4), (-0.4, 0.4), (0.4, 0.4)]


def unequal_legs(trial: Trial) -> Iterator[Statement]:
    """A stool with one of four legs short, or with all of them but a load aside: three bear, and none pulls."""
    for at, down in (((0.05, -0.1), False), ((0.2, 0.2), True)):
        piece = stool(CORNERS, at, 200.0, short=3)
        yield true(f"a load at {at}: it {'falls' if down else 'stands'}", falls(piece, FINE) is down)
    furniture = Furniture(stool(CORNERS, (0.3, 0.3), 50.0), FINE)
    result = furniture.test()
    yield true("four legs stand where springs would pull", not result.flaws & UNSTABLE)
    yield below("pull of a foot [N]", -float(furniture.forces().contacts[:, 2].min()), EXACT)
    yield balanced(furniture)


def at_the_limit(trial: Trial) -> Iterator[Statement]:
    """Exactly at the limit of friction, of tipping, and of nails: it holds, and a millionth beyond it does not."""
    beyond = 1e-5
    angle = float(np.arctan(1.0))
    yield true("a ladder stands at its angle of friction", not falls(ladder(angle, 0.5)))
    yield true("and slides below", falls(ladder(angle - beyond, 0.5)))
    for base, high, mu in ((0.1, 0.5, 0.5), (0.25, 0.5, 0.25)):
        limit = float(np.arctan(min(mu, base / high)))
        yield true(f"a block of {base} x {high} m stands at its angle", not falls(block(base, high, mu, limit)))
        yield true("and not beyond", falls(block(base, high, mu, limit + beyond)))
    own = 700.0 * 0.06 * 0.012 * 0.19 * G
    most = (0.02 * 5.2e3 * 0.006 * 3 - own * 0.095) / 0.19 / G
    for part, weak in ((1.0 - 1e-9, False), (1.0 + 1e-9, True)):
        result = Furniture(cantilever(kilograms=part * most)).test()
        yield true(f"nails at 1 {part - 1.0:+.0e} of what they bear", bool(result.flaws & WEAK) is weak)


def mirror(trial: Trial) -> Iterator[Statement]:
    """Every piece and its mirror image: the same flaws, utilisations, freedoms, and suggestions as wide."""
    for name, make in PIECES.items():
        piece = make()
        one, other = Furniture(piece), Furniture(mirrored(piece))
        a, b = one.test(), other.test()
        yield true(f"{name}: same flaws", a.flaws == b.flaws)
        yield near(f"{name}: same utilisations", [a.pull, a.shear], [b.pull, b.shear], EXACT)
        yield true(f"{name}: same freedoms", one.kernel.freedoms() == other.kernel.freedoms())
        if len(piece.planks) <= 10:
            # Single modes: all of them are tested, in no order.
            spans = [sorted(s.span[1] - s.span[0] for s in suggest(f, most=1, shown=99).found) for f in (one, other)]
            same = len(spans[0]) == len(spans[1]) and np.allclose(*spans, atol=1e-2)
            yield true(f"{name}: {len(spans[0])} suggestions of one mode, as wide", bool(same))


def sixty_planks(trial: Trial) -> Iterator[Statement]:
    """A bookshelf of 60 planks: equilibrium both ways, ranges, suggestions."""
    piece = bookshelf((14, 14, 14), dividers=13, brackets=1, kilograms=1.0, heavy=40.0)
    yield true("60 planks", len(piece.planks) == 60)
    furniture = Furniture(piece)
    result = furniture.test()
    yield true("its joints are closed, and it stands", not result.flaws & (LOST | UNSTABLE | OVERLAPPING))
    yield true("a joint is weak", bool(result.flaws & WEAK))
    yield balanced(furniture)
    quick = furniture.forces()
    solver = PlankEquilibrium(furniture)
    slow = solver.solve()
    solver.destroy()
    size = np.abs(quick.bending).max()
    yield below(
        "moments by SNES beside these, relative", float(np.abs(slow.bending - quick.bending).max() / size), DIRECT
    )
    found = suggest(furniture)
    yield true("there are suggestions", 1 <= len(found.found) <= 8, float(len(found.found)))
    fresh = [Furniture(furniture.moved(one.gamma)).test().valid for one in found.found]
    yield true("that hold in a test of their own", all(fresh))
    ranges = valid_ranges(furniture.kernel, found.found[0].direction, -0.5, 0.5)
    yield true("the range of the first holds where it is shown", ranges.holds(found.found[0].t))


def thrown_about(trial: Trial) -> Iterator[Statement]:
    """Thousands of designs at random, far from each other: finite numbers, and those of a model that restarts."""
    for piece in (shelf_1(), table(push=60.0), stool_chair(lean=0.3, kilograms=80.0)):
        furniture = Furniture(piece)
        furniture.test()
        modes = DesignModes.of(piece, furniture.kernel.freedoms())
        rng, differ, wrong = np.random.default_rng(0), 0.0, 0
        for _ in range(trial.count(1000, 50)):
            size = 10.0 ** rng.uniform(-3.0, 0.5)
            gamma = (size * rng.normal(size=len(modes)) / np.sqrt(len(modes)) @ modes.directions).reshape(-1, 8)
            warm = furniture.test(gamma)
            furniture.kernel.forget()
            cold = furniture.test(gamma)
            # Where a plank has no length left there is nothing to be used.
            gone = bool(warm.flaws & LOST) and np.isinf([warm.pull, warm.shear, warm.unbalanced]).all()
            wrong += not (gone or np.isfinite([warm.pull, warm.shear, warm.unbalanced]).all())
            wrong += warm.flaws != cold.flaws
            if not gone:
                differ = max(differ, abs(warm.pull - cold.pull) / max(abs(cold.pull), 1e-3))
        yield below(f"{piece.name}: designs with other flaws or no number", float(wrong), 0.0)
        yield below(f"{piece.name}: difference from a fresh start, relative", differ, CONDITIONED)


CASES: dict[str, Case] = {
    "zero_friction": Case(zero_friction),
    "planks_in_each_other": Case(planks_in_each_other),
    "parts": Case(parts),
    "hardly_parallel": Case(hardly_parallel),
    "feet_in_a_line": Case(feet_in_a_line),
    "feet_on_two_planes": Case(feet_on_two_planes),
    "sliding_feet": Case(sliding_feet),
    "unequal_legs": Case(unequal_legs),
    "at_the_limit": Case(at_the_limit),
    "mirror": Case(mirror),
    "mirrored_pair": Case(mirrored_pair),
    "sixty_planks": Case(sixty_planks),
    "thrown_about": Case(thrown_about, share=0.1),
}
