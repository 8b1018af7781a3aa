"""Validation of furniture against statics worked by hand: reactions, moments, and loads or angles at which it gives."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from petsc4py import PETSc
from restshape_apps.furniture.physics.furniture import UNSTABLE, WEAK, Compliance, Furniture
from restshape_apps.furniture.pieces import cantilever
from restshape_apps.furniture.shape.planks import Load, Piece
from restshape_apps.furniture.small_pieces import bench, block, ladder, stool
from restshape_studies.validation.case import CLOSED_FORM, PUBLISHED, ROUNDING, Check, Kind

G = 9.80665
LEAST = 2e-6
"""Tolerance of what gives way or stands on points: feet and joints overlap by a millionth of a metre at least."""
FINE = Compliance(least_overlap=1e-6)
"""For legs that stand on lines and points."""


def in_equilibrium(piece: Piece, compliance: Compliance | None = None) -> Furniture:
    """The model of a piece after its test."""
    furniture = Furniture(piece, compliance)
    furniture.test()
    return furniture


def reactions(furniture: Furniture) -> np.ndarray:
    """The upward force (f,) of each foot [N]."""
    return furniture.forces().contacts.reshape(-1, 4, 3).sum(axis=1)[:, 2]


def gives_way(make: Callable[[float], Piece], good: float, bad: float, flaw: int) -> float:
    """The number between a good and a bad one from which on a piece made with it has a flaw, by bisection."""
    for _ in range(44):
        middle = 0.5 * (good + bad)
        if Furniture(make(middle)).test().flaws & flaw:
            bad = middle
        else:
            good = middle
    return good


def two_supports(comm: PETSc.Comm) -> list[Check]:
    """A board on two upright ones with a mass aside of the middle: reactions of the lever."""
    place, load = 0.1, 20.0 * G
    furniture = in_equilibrium(bench(place, mu=0.0), FINE)
    own = furniture.geometry().mass * G
    wanted = np.array([0.5 - place, 0.5 + place]) * load + 0.5 * own[0] + own[1:]
    found = reactions(furniture)
    source = "R = W (L - x) / L and W x / L, and half of the board's weight"
    return [
        Check(f"reaction of {name} [N]", float(value), float(expected), LEAST, source, CLOSED_FORM)
        for name, value, expected in zip(("the left leg", "the right leg"), found, wanted)
    ]


def cantilever_moment(comm: PETSc.Comm) -> list[Check]:
    """A board nailed end-on to an upright one with a mass at its tip: moment and shear of the joint."""
    arm, kilograms = 0.19, 0.8
    furniture = in_equilibrium(cantilever(arm=arm, kilograms=kilograms))
    own = float(furniture.geometry().mass[2]) * G
    forces = furniture.forces()
    wanted = kilograms * G * arm + own * arm / 2
    moment, shear = abs(float(forces.bending[1])), float(np.hypot(*forces.shear[1]))
    return [
        Check("bending moment [N m]", moment, wanted, ROUNDING, "W l + w l^2 / 2", CLOSED_FORM),
        Check("shear force [N]", shear, kilograms * G + own, ROUNDING, "W + w l", CLOSED_FORM),
    ]


def tripod(comm: PETSc.Comm) -> list[Check]:
    """A stool on three points with a mass aside of the middle: barycentric reactions."""
    feet, at, load = [(-0.4, -0.3), (0.45, -0.2), (0.0, 0.4)], (0.1, 0.05), 30.0 * G
    furniture = in_equilibrium(stool(feet, at, 30.0, mu=0.0), FINE)
    corners, own = np.vstack([np.array(feet).T, np.ones(3)]), furniture.geometry().mass * G
    source = "barycentric coordinates, 3 x 3 system"
    wanted = load * np.linalg.solve(corners, [*at, 1.0]) + own[0] * np.linalg.solve(corners, [0, 0, 1.0]) + own[1:]
    return [
        Check(f"reaction of leg {k} [N]", float(value), float(expected), LEAST, source, CLOSED_FORM)
        for k, (value, expected) in enumerate(zip(reactions(furniture), wanted), 1)
    ]


def leaning(comm: PETSc.Comm) -> list[Check]:
    """A plank that leans against a smooth wall: the angle from which on it slides."""
    return [
        Check(
            f"least angle with mu = {mu} [rad]",
            gives_way(lambda angle, mu=mu: ladder(angle, mu), 1.5, 0.1, UNSTABLE),
            float(np.arctan(1.0 / (2.0 * mu))),
            LEAST,
            "tan = 1 / (2 mu) for a uniform ladder",
            CLOSED_FORM,
        )
        for mu in (0.3, 0.5, 0.8)
    ]


def tipping(comm: PETSc.Comm) -> list[Check]:
    """A block that is pushed sideways: it slides where it is pushed low, and tips where it is pushed high."""
    base, high, mu = 0.2, 0.5, 0.4
    piece = block(base, high, mu)
    own = float(Furniture(piece).geometry().mass[0]) * G

    def pushed(height: float) -> Callable[[float], Piece]:
        place = (height / high - 0.5, 0.0, 0.0)
        return lambda force: replace(piece, pushes=(Load("push", 0, place, (force, 0.0, 0.0)),))

    return [
        Check(
            f"push at {height} m that it bears [N]",
            gives_way(pushed(height), 0.0, 2.0 * own, UNSTABLE),
            min(mu * own, own * 0.5 * base / height),
            LEAST,
            "the lesser of mu W and W b / (2 h)",
            CLOSED_FORM,
        )
        for height in (0.05, 0.25, 0.5)
    ]


def incline(comm: PETSc.Comm) -> list[Check]:
    """A block on an incline: it slides where it is low, and tips where it is high."""
    return [
        Check(
            f"angle at which a block of {base} x {high} m {verb}, mu = {mu} [rad]",
            gives_way(lambda angle, b=base, h=high, m=mu: block(b, h, m, angle), 0.0, 0.9, UNSTABLE),
            float(np.arctan(min(mu, base / high))),
            LEAST,
            "tan = the lesser of mu and b / h",
            CLOSED_FORM,
        )
        for base, high, mu, verb in ((0.1, 0.5, 0.5, "tips"), (0.3, 0.5, 0.3, "slides"), (0.2, 1.0, 0.15, "slides"))
    ]


def nail_cantilever(comm: PETSc.Comm) -> list[Check]:
    """The nail cantilever of section 6.6.1 of the thesis, loaded until its joint of three nails breaks."""
    checks = []
    fitted = "the thesis's 1.86 N m, which the strength of nail-experiment was fitted to: only the statics are tested"
    rows: tuple[tuple[str, float, float, str, Kind], ...] = (
        ("nail-thesis", 12.6, ROUNDING, "20 mm x 35 kN/m x 6 mm x 3 nails", CLOSED_FORM),
        ("nail-experiment", 1.86, 0.01, fitted, PUBLISHED),
    )
    for name, moment, tolerance, source, kind in rows:

        def loaded(kilograms: float, name: str = name) -> Piece:
            return cantilever(kilograms=kilograms, fastener=name)

        most = gives_way(loaded, 0.1, 20.0, WEAK)
        furniture = in_equilibrium(loaded(most))
        bears = abs(float(furniture.forces().bending[1]))
        own = float(furniture.geometry().mass[2]) * G * 0.095
        checks += [
            Check(f"moment at which {name} breaks [N m]", bears, moment, tolerance, source, kind),
            Check(
                f"mass at its tip then, {name} [kg]",
                most,
                (moment - own) / 0.19 / G,
                tolerance,
                "that moment less the board's own, over 0.19 m" + ("; fitted" if kind == PUBLISHED else ""),
                kind,
            ),
        ]
    return checks
