"""Force space: forces in parts of what is allowed, how design modes change them, and combinations that help."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import comb

import numpy as np

from restshape import _kernels
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.physics.derivatives import force_derivative, stability_derivative
from restshape_apps.furniture.shape.design_modes import DesignModes

LONGEST = 0.5
"""Of a step along a unit direction: half the piece's size, or half a radian."""

LEAST_GAIN = 1e-3
"""Of the norm of the change of forces along a unit direction."""

SECONDS_EACH = 4e-8
"""Nominal time of a combination of three; one of k takes k / 3 of it. A named input, not a clock."""

SHEARED = 0.7
"""Use of a joint's shear strength from which on shear has rows of its own."""


@dataclass(frozen=True)
class ForceSpace:
    """Forces h (r,) with their box low <= h <= high, and their change K (m, r) by design modes.

    `gap` (r,) is what a step should take away: all of h for durability (6.19), what lies outside for stability (6.21).
    """

    K: np.ndarray
    h: np.ndarray
    gap: np.ndarray
    low: np.ndarray
    high: np.ndarray


@dataclass(frozen=True)
class Rays:
    """Combinations of modes that lead into the box.

    Args:
        modes: (k, M) numbers of modes, -1 where there are fewer.
        parts: (k, M) unit directions in them.
        spans: (k, 2) where along it the box is entered and left.
        tried: combinations tried of each number of modes.
    """

    modes: np.ndarray
    parts: np.ndarray
    spans: np.ndarray
    tried: tuple[int, ...]

    def each(self) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
        """Modes, parts and span of each."""
        for modes, parts, span in zip(self.modes, self.parts, self.spans):
            used = modes >= 0
            yield modes[used], parts[used], span


@dataclass(frozen=True)
class Forecast:
    """How many combinations there are of at most so many modes, and how long they take [s], before any is tried."""

    combinations: int
    seconds: float


def forecast(modes: int, most: int) -> Forecast:
    """What a search over all combinations of at most `most` of so many modes would take."""
    counts = [comb(modes, k) for k in range(1, most + 1)]
    return Forecast(sum(counts), SECONDS_EACH * sum(count * k / 3 for k, count in enumerate(counts, 1)))


def durability_space(furniture: Furniture, modes: DesignModes) -> ForceSpace:
    """Bending moments of all joints and cases, in parts of what their fasteners bear beside the present pull.

    Fasteners count by the joint's length here, for their whole number has no derivative. Shear forces join them where
    one comes near its strength; their circle is taken for a square.
    """
    nails, directions = furniture.nails(), modes.directions
    pull, shear = furniture.strength.T * nails
    length = furniture.geometry().length
    forces = [furniture.forces(case) for case in range(len(furniture.cases))]
    sheared = any(f.shear_use.max(initial=0.0) > SHEARED for f in forces)
    h, K = [], []
    for case, found in enumerate(forces):
        change = force_derivative(furniture, directions, case)
        bears = 0.5 * furniture.lever * np.maximum(pull - found.tension, 1e-3 * pull)
        longer = change.length / length
        h.append(found.bending / bears)
        K.append(change.bending / bears - h[-1] * longer)
        for k in range(2 if sheared else 0):
            h.append(found.shear[:, k] / shear)
            K.append(change.shear[:, :, k] / shear - h[-1] * longer)
    h, K = np.concatenate(h), np.ascontiguousarray(np.concatenate(K, axis=1))
    one = np.ones_like(h)
    return ForceSpace(K, h, h, -one, one)


def stability_space(furniture: Furniture, modes: DesignModes) -> ForceSpace:
    """What holds the piece down in all cases, which must not be negative."""
    found = [stability_derivative(furniture, modes.directions, case) for case in range(len(furniture.cases))]
    h = np.concatenate([values for values, _ in found])
    K = np.ascontiguousarray(np.concatenate([change for _, change in found], axis=1))
    return ForceSpace(K, h, np.minimum(h, 0.0), np.zeros_like(h), np.full_like(h, np.inf))


def whole_space(furniture: Furniture, modes: DesignModes) -> ForceSpace:
    """Rows of stability and of durability at once: what makes a piece stand is not to break its joints."""
    stable, durable = stability_space(furniture, modes), durability_space(furniture, modes)
    outside = durable.h - np.clip(durable.h, durable.low, durable.high)
    return ForceSpace(
        np.concatenate([stable.K, durable.K], axis=1),
        *(
            np.concatenate(pair)
            for pair in (
                (stable.h, durable.h),
                (stable.gap, outside),
                (stable.low, durable.low),
                (stable.high, durable.high),
            )
        ),
    )


def contact_space(furniture: Furniture, modes: DesignModes, case: int = 0) -> ForceSpace:
    """Normal forces of the contacts of one case, in parts of their sum, which must not be negative (6.16)."""
    normals = np.repeat([furniture.piece.planes[foot.plane].normal for foot in furniture.piece.feet], 4, axis=0)
    pressed = np.einsum("ca,ca->c", furniture.forces(case).contacts, normals)
    scale = max(pressed.sum(), 1e-300)
    K = np.ascontiguousarray(force_derivative(furniture, modes.directions, case).pressed / scale)
    h = pressed / scale
    return ForceSpace(K, h, np.minimum(h, 0.0), np.zeros_like(h), np.full_like(h, np.inf))


def combinations(
    space: ForceSpace,
    most: int = 3,
    least: int = 1,
    barred: Sequence[tuple[int, ...]] = (),
    keep: int = 0,
    longest: float = LONGEST,
    least_gain: float = LEAST_GAIN,
) -> Rays:
    """Combinations of `least` to `most` modes whose least squares direction leads into the box.

    Left out are those with too small a change, and those that hold a barred combination.

    Args:
        space: forces and their derivatives.
        barred: combinations that already work, each with its modes in rising order.
        keep: rays kept for each number of modes and leading mode, the widest first; 0 keeps all.
        longest: step along a unit direction.
        least_gain: norm of the change of forces along a unit direction.

    Source: (6.18) to (6.21) of the thesis.
    """
    modes, parts, spans, tried = _kernels.combinations(
        space.K, space.h, space.gap, space.low, space.high, most, least, least_gain, longest, barred, keep
    )
    return Rays(modes, parts, spans, tuple(tried))
