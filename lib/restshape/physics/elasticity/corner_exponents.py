"""How stress grows towards a corner of an elastic body: exponents of the fields r^lambda there."""

from functools import lru_cache
from typing import NamedTuple

import numpy as np

Condition = tuple[tuple[float, float], ...]
"""Directions (x, y), of length 1, in which a side of a corner is constrained: none is free, two are clamped."""
FREE: Condition = ()
CLAMPED: Condition = ((1.0, 0.0), (0.0, 1.0))


class Sector(NamedTuple):
    """A part of a wedge that is of one material.

    Args:
        angle: [rad].
        kappa: Kolosov's constant.
        stiffness: shear modulus times thickness [N/m].
    """

    angle: float
    kappa: float
    stiffness: float


LEAST, MOST = 0.02, 0.999
"""Between which real parts roots are looked for: rigid displacements have 0, rotations and even stress 1."""
STARTS = (20, 6)
"""Points in both directions from which roots are looked for."""
STEPS = 45
FOUND = 1e-13
"""Change of a root in a step below which it is looked for no further; nor is it far from the strip."""
CLOSE = 1e-6
"""Change of a root in the last step that counts as none: double roots, as of a crack, are found to 1e-8."""


def kolosov(nu: float, plane_strain: bool) -> float:
    """Kolosov's constant of plane strain or plane stress by Poisson's ratio."""
    return 3.0 - 4.0 * nu if plane_strain else (3.0 - nu) / (1.0 + nu)


@lru_cache(maxsize=256)
def exponent(angle: float, first: Condition, last: Condition, kappa: float) -> complex | None:
    """The exponent lambda of the least real part: displacements go as r^lambda, stress as r^(lambda - 1).

    Args:
        angle: of the body at the corner [rad], counter-clockwise from the first side to the last one.
        first, last: directions in which the sides are constrained, in axes of which x points along the first side.
        kappa: Kolosov's constant, where a side is constrained.

    Returns:
        None where stress stays finite: no exponent has a real part below 0.999.

    Source: M. L. Williams, Journal of Applied Mechanics 19 (1952), 526-528. Of free sides the exponents solve
    sin(lambda angle) = +- lambda sin(angle).
    """
    if not (first or last):
        return _free(angle)
    if len(first) != 1 and len(last) != 1:
        # Of sides that are free or constrained all around: the mirror image has the same exponents.
        first, last = sorted((CLAMPED[: len(first)], CLAMPED[: len(last)]))
    return least_root(angle, first, last, kappa)


@lru_cache(maxsize=256)
def bonded_exponent(sectors: tuple[Sector, ...], first: Condition | None, last: Condition | None) -> complex | None:
    """As `exponent`, of a wedge of several materials, bonded to each other.

    Args:
        sectors: counter-clockwise from the first side.
        first, last: as of `exponent`; None where the sectors are all around the point, the last bonded to the first.

    Source: D. B. Bogy, Journal of Applied Mechanics 38 (1971), 377-386, by the terms of each sector.
    """
    return _least_root(sectors, None if first is None or last is None else (first, last))


def _free(angle: float) -> complex | None:
    """The exponent between free sides: that of the fields that are symmetric to the bisector of the angle."""
    from scipy.optimize import brentq

    if angle <= np.pi:
        return None
    root = brentq(lambda lam: np.sin(lam * angle) + lam * np.sin(angle), 0.5 - 1e-9, 1.0, xtol=1e-12)
    return complex(root) if root < MOST else None


@lru_cache(maxsize=256)
def least_root(angle: float, first: Condition, last: Condition, kappa: float) -> complex | None:
    """The root of the least real part of the determinant of the conditions at both sides; as `exponent`."""
    return _least_root((Sector(angle, kappa, 1.0),), (first, last))


def _least_root(sectors: tuple[Sector, ...], sides: tuple[Condition, Condition] | None) -> complex | None:
    """The root of the least real part of the determinant of the conditions between sectors and at their sides."""
    real = np.linspace(LEAST, MOST, STARTS[0])
    imaginary = np.linspace(0.0, 1.0, STARTS[1])
    roots = (real[:, None] + 1j * imaginary).ravel()
    change = np.full(len(roots), np.inf, dtype=complex)
    moving = np.arange(len(roots))
    step = 1e-6
    for _ in range(STEPS):
        starts = roots[moving]
        here, beside = np.split(_determinant(np.concatenate([starts, starts + step]), sectors, sides), 2)
        with np.errstate(all="ignore"):
            steps = here / ((beside - here) / step)
        steps = np.where(np.isfinite(steps), steps, 0.0)
        # Long steps leave the strip in which roots are looked for.
        steps *= np.minimum(1.0, 0.1 / np.maximum(np.abs(steps), 1e-300))
        roots[moving], change[moving] = starts - steps, steps
        near = (np.abs(roots[moving].real - 0.5) < 1.0) & (np.abs(roots[moving].imag) < 3.0)
        moving = moving[near & (np.abs(steps) > FOUND)]
        if not len(moving):
            break
    good = (np.abs(change) < CLOSE) & (roots.real > LEAST) & (roots.real < MOST) & (np.abs(roots.imag) < 3.0)
    found = roots[good]
    if not len(found):
        return None
    least = found[np.argmin(np.round(found.real, 7) + 1e-9 * np.abs(found.imag))]
    return complex(least.real, abs(least.imag) if abs(least.imag) > 1e-7 else 0.0)


def _determinant(lam: np.ndarray, sectors: tuple[Sector, ...], sides: tuple[Condition, Condition] | None) -> np.ndarray:
    """What vanishes where fields r^lambda meet all conditions, of many lambda (n,); without sides all around."""
    size = 4 * len(sectors)
    matrix = np.zeros((len(lam), size, size), dtype=complex)
    ends = np.cumsum([0.0, *(sector.angle for sector in sectors)])
    if sides is not None:
        matrix[:, :2, :4] = np.moveaxis(np.array(_conditions(lam, 0.0, sides[0], sectors[0].kappa)), -1, 0)
        matrix[:, 2:4, -4:] = np.moveaxis(np.array(_conditions(lam, ends[-1], sides[1], sectors[-1].kappa)), -1, 0)
    start = 0 if sides is None else 1
    stiffest = max(sector.stiffness for sector in sectors)
    for i in range(start, len(sectors)):
        rows = slice(4 * i, 4 * i + 4)
        # Around the whole point the first sector follows the last one.
        for j, theta, sign in ((i, ends[i], 1.0), ((i - 1) % len(sectors), ends[i] if i else ends[-1], -1.0)):
            displacement, stress = _fields(lam, theta, sectors[j].kappa)
            # Displacements are alike; what stress bears over the thickness is, by the stiffness.
            share = sectors[j].stiffness / stiffest
            terms = np.array([*displacement, *(share * np.array(row) for row in stress)])
            matrix[:, rows, 4 * j : 4 * j + 4] += sign * np.moveaxis(terms, -1, 0)
    return np.linalg.det(matrix)


def _conditions(lam: np.ndarray, theta: float, constrained: Condition, kappa: float) -> list[list[np.ndarray]]:
    """Two rows of four columns (n,): the terms of the stress function in the conditions of a side."""
    displacement, stress = _fields(lam, theta, kappa)
    radial, around = (np.cos(theta), np.sin(theta)), (-np.sin(theta), np.cos(theta))
    if len(constrained) == 2:
        return [displacement[0], displacement[1]]
    if not constrained:
        return [stress[0], stress[1]]
    along = constrained[0]
    across = (-along[1], along[0])

    def part(pair: list[list[np.ndarray]], d: tuple[float, float]) -> list[np.ndarray]:
        shares = (d[0] * radial[0] + d[1] * radial[1], d[0] * around[0] + d[1] * around[1])
        return [shares[0] * one + shares[1] * other for one, other in zip(*pair)]

    return [part(displacement, along), part(stress, across)]


def _fields(lam: np.ndarray, theta: float, kappa: float) -> tuple[list[list[np.ndarray]], list[list[np.ndarray]]]:
    """Displacements (along r and theta) and stresses on a side (r theta, theta theta) of the four terms.

    The stress function is r^(lambda + 1) times sin and cos of (lambda + 1) theta and of (lambda - 1) theta.
    """
    p, m = (lam + 1.0) * theta, (lam - 1.0) * theta
    sp, cp, sm, cm = np.sin(p), np.cos(p), np.sin(m), np.cos(m)
    radial = [-(lam + 1) * sp, -(lam + 1) * cp, (kappa - lam) * sm, (kappa - lam) * cm]
    around = [-(lam + 1) * cp, (lam + 1) * sp, -(kappa + lam) * cm, (kappa + lam) * sm]
    shear = [-(lam + 1) * cp, (lam + 1) * sp, -(lam - 1) * cm, (lam - 1) * sm]
    normal = [(lam + 1) * sp, (lam + 1) * cp, (lam + 1) * sm, (lam + 1) * cm]
    return [radial, around], [shear, normal]
