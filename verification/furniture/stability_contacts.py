"""Hard cases of contacts, and of planks beside each other: lines, two planes, slides, mirrors, hardly parallel."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from restshape_apps.furniture.guidance.suggestions import suggest
from restshape_apps.furniture.physics.derivatives import stability_derivative
from restshape_apps.furniture.physics.furniture import LOST, OVERLAPPING, UNSTABLE, Compliance, Furniture
from restshape_apps.furniture.physics.plank_findings import FAULTS, SLANT
from restshape_apps.furniture.pieces import shelf_1, stool_chair, table
from restshape_apps.furniture.shape.planks import Foot, Load, Piece, Plane, Plank
from restshape_apps.furniture.small_pieces import THIN, block, cantilever, ladder, mirrored, stool
from restshape_studies.stability.case import Statement, Trial, below, near, true
from restshape_studies.stability.known_bounds import DIRECT, EXACT

G = 9.80665
FINE = Compliance(least_overlap=1e-6)
"""For legs that stand on lines and points."""


def falls(piece: Piece, compliance: Compliance | None = None) -> bool:
    """Whether the full test finds a piece unstable."""
    return bool(Furniture(piece, compliance).test().flaws & UNSTABLE)


def balanced(furniture: Furniture, case: int = 0) -> Statement:
    """The statement that contacts bear the loads of the last test, and nothing else."""
    own = furniture.geometry().mass.sum() * np.array(furniture.piece.gravity)
    loads = furniture.cases[case].sum(axis=0) + own
    left = furniture.forces(case).contacts.sum(axis=0) + loads
    return below("loads that contacts leave, in parts of them", float(np.abs(left).max() / np.abs(loads).max()), DIRECT)


def rows_of(furniture: Furniture, case: int = 0) -> np.ndarray:
    """What holds a piece down, by the rows of stability."""
    return stability_derivative(furniture, np.zeros((1, 8 * len(furniture.piece.planks))), case)[0]


def feet_in_a_line(trial: Trial) -> Iterator[Statement]:
    """All feet in one line: it stands while the weight is above it, to a part of a leg's thickness, and else falls."""
    for aside, down in ((0.0, False), (0.4 * THIN, False), (0.6 * THIN, True), (0.05, True)):
        piece = stool([(-0.4, 0.0), (0.4, 0.0)], (0.1, aside), 1e4)
        yield true(f"weight {aside:g} m beside it: it {'falls' if down else 'stands'}", falls(piece, FINE) is down)
    furniture = Furniture(stool([(-0.4, 0.0), (0.4, 0.0)], (0.1, 0.0), 20.0), FINE)
    furniture.test()
    yield balanced(furniture)
    reactions = furniture.forces().contacts.reshape(-1, 4, 3)[:, :, 2].sum(axis=1)
    own = furniture.geometry().mass * G
    load = 20.0 * G
    by_hand = np.array([3.0, 5.0]) / 8.0 * load + 0.5 * own[0] + own[1:]
    yield near("reactions of the lever", reactions, by_hand, 1e-5)
    # Nothing is as thin as this: its four points of contact are one line.
    sheet = block(1e-7, 0.5, 0.5)
    yield true("a sheet stands on its edge", not falls(sheet))
    push = Load("breath", 0, (0.5, 0.0, 0.0), (1e-3, 0.0, 0.0))
    yield true("and falls where it is breathed upon", falls(replace(sheet, pushes=(push,))))
    aside = Furniture(stool([(-0.4, 0.0), (0.4, 0.0)], (0.0, 0.05), 20.0), FINE)
    aside.test()
    found = suggest(aside).found
    stands = [not Furniture(aside.moved(s.gamma), FINE).test().flaws & UNSTABLE for s in found]
    yield true("what is suggested stands", bool(found) and all(stands), float(len(found)))


def feet_on_two_planes(trial: Trial) -> Iterator[Statement]:
    """A floor and a wall, or two floors of other friction: the full test knows them, rows of stability one plane."""
    for angle in (0.8, 1.2):
        furniture = Furniture(ladder(angle, 0.7))
        furniture.test()
        own = float(furniture.geometry().mass[0]) * G
        wall = own / (2.0 * np.tan(angle))
        feet = furniture.forces().contacts.reshape(-1, 4, 3).sum(axis=1)
        yield near(f"forces of a ladder at {angle} [N]", feet, [[wall, 0.0, own], [-wall, 0.0, 0.0]], DIRECT)
        yield true("no row is reported of it", rows_of(furniture).size == 0)
    sliding = Furniture(ladder(0.7, 0.5))
    yield true("a low ladder slides", bool(sliding.test().flaws & UNSTABLE))
    yield true("nothing is suggested without rows", suggest(sliding).found == ())
    # Half of the feet on a carpet, half on ice: they bear half of what the rows, which take the larger mu, allow.
    half = carpeted(0.0)
    half.test()
    weight = float(half.geometry().mass.sum() * G - sum(load.force[2] for load in half.piece.weights))
    for part, down in ((0.999, False), (1.001, True)):
        pushed = carpeted(0.5 * weight * part)
        pushed.test()
        yield true(f"{part:g} of what a carpet bears: it {'slides' if down else 'stands'}", falls_under(pushed) is down)
        yield near("the row of friction", float(rows_of(pushed, 1)[-1]), 1.0 - 0.5 * part, EXACT)


def carpeted(newtons: float) -> Furniture:
    """A stool with two feet on a carpet and two on ice beside it, pushed at the height of the floor."""
    piece = stool([(-0.4, -0.4), (-0.4, 0.4), (0.4, -0.4), (0.4, 0.4)], (0.0, 0.0), 40.0, mu=1.0)
    planes = (Plane(mu=1.0), Plane(mu=0.0))
    feet = tuple(Foot(foot.plank, foot.side, int(k > 1)) for k, foot in enumerate(piece.feet))
    low = Load("push", 0, (0.0, 0.0, -0.41 / 0.02), (newtons, 0.0, 0.0))
    return Furniture(replace(piece, planes=planes, feet=feet, pushes=(low,) if newtons else ()), FINE)


def falls_under(furniture: Furniture) -> bool:
    """Whether contacts fail to balance the last case of the last test."""
    return furniture.forces(len(furniture.cases) - 1).unbalanced > 1e-7


def sliding_feet(trial: Trial) -> Iterator[Statement]:
    """Slanted legs on a floor of hardly any friction: feet slide until joints hold them, and Coulomb's law is kept."""
    seen, worst, least = 0, 0.0, 0.0
    for lean in (0.1, 0.15, 0.2, 0.25, 0.3):
        for kilograms in (1.0, 20.0, 80.0):
            for mu in (0.03, 0.05, 0.08):
                furniture = Furniture(replace(stool_chair(lean=lean, kilograms=kilograms), planes=(Plane(mu=mu),)))
                furniture.test()
                forces = furniture.forces()
                pressed, along = forces.contacts[:, 2], np.hypot(*forces.contacts[:, :2].T)
                most = float((along - mu * pressed).max() / pressed.sum())
                seen += forces.one_sided and bool(np.abs(along - mu * pressed).min() < 1e-6 * pressed.sum())
                worst, least = max(worst, most), min(least, float(pressed.min()))
    yield below("friction beyond its limit, in parts of the weight", worst, EXACT)
    yield below("pull of a foot [N]", -least, EXACT)
    yield true("feet slide in most of 45 chairs", seen > 30, float(seen))


def pair(piece: Piece) -> Piece:
    """A piece and its mirror image, 3 m beside it."""
    other, n = mirrored(piece), len(piece.planks)
    planks = (replace(p, name=f"{p.name}'", centre=p.centre + np.array([3.0, 0.0, 0.0])) for p in other.planks)
    return replace(
        piece,
        planks=(*piece.planks, *planks),
        joints=(*piece.joints, *(replace(j, i=j.i + n, j=j.j + n) for j in other.joints)),
        feet=(*piece.feet, *(replace(f, plank=f.plank + n) for f in other.feet)),
        weights=(*piece.weights, *(replace(w, name=f"{w.name}'", plank=w.plank + n) for w in other.weights)),
    )


def mirrored_pair(trial: Trial) -> Iterator[Statement]:
    """A piece beside its mirror image, as one model of two parts: each joint has the forces of the one opposite."""
    for piece in (table(), shelf_1(), stool_chair()):
        both = Furniture(pair(piece))
        both.test()
        forces, k = both.forces(), len(piece.joints)
        yield true(f"{piece.name}: two parts", both.kernel.parts == 2)
        for name in ("tension", "bending"):
            found = np.abs(getattr(forces, name))
            yield near(f"{piece.name}: {name} of one and the other", found[:k], found[k:], DIRECT)
        feet = forces.contacts.reshape(2, -1, 3).sum(axis=1)
        yield near(f"{piece.name}: what they stand on", feet[0, 2], feet[1, 2], EXACT)


def hardly_parallel(trial: Trial) -> Iterator[Statement]:
    """Boards on each other that are turned by nearly nothing: no axis between their edges leads astray."""
    t, length, wrong = 0.02, 1.0, []
    for angle in (0.0, 1e-14, 1e-12, 1e-10, 1e-8, 1e-6, 1e-5, 1e-4, 1e-3):
        for gap in (-5e-4, -5e-5, 0.0, 1e-3):
            # The lower corner of the upper board goes down by half its length times the angle.
            inside = 0.5 * length * np.sin(angle) + 0.5 * t * (np.cos(angle) - 1.0) - gap
            overlap = bool(inside > 1e-4)
            lower = Plank.between("lower", (-0.5, 0, t / 2), (0.5, 0, t / 2), (0, 0.3, 0), t)
            c, s, middle = 0.5 * np.cos(angle), 0.5 * np.sin(angle), 1.5 * t + gap
            upper = Plank.between("upper", (-c, 0, middle - s), (c, 0, middle + s), (0, 0.3, 0), t)
            result = Furniture(Piece((lower, upper), (), (Foot(0, 4, 0),))).test()
            seen = bool(result.flaws & OVERLAPPING)
            wrong += [] if seen is overlap else [f"{gap:g} m apart, turned by {angle:g}: {seen}"]
    yield true("36 pairs of boards overlap where they are more than 0.1 mm in each other", not wrong, "; ".join(wrong))
    # An end that meets its face at less than a quarter of a right angle's sine has no place on it.
    piece = cantilever()
    for angle, lost in ((1.30, False), (1.317, False), (1.32, True), (1.5, True), (np.pi / 2, True)):
        gamma = np.zeros((3, 8))
        gamma[2, 4] = angle
        result = Furniture(piece).test(gamma)
        flat = any(one.detail == FAULTS[SLANT] for one in result.findings)
        yield true(f"turned by {angle:g} it is {'too flat' if lost else 'not'}", flat is lost)
        yield true("and lost with it", bool(result.flaws & LOST) or not lost)
