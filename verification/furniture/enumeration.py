"""Suggestions by trying every combination of modes one by one, with nothing left out: what a search must find too.

It shares the force space and the full test with the search, and nothing else: least squares are LAPACK's, every
combination is looked at, single modes at dense places, and only in the end those are left out that hold a smaller one
that works.
"""

from itertools import combinations as choose

import numpy as np
from restshape_apps.furniture.physics.furniture import ALL, Furniture
from restshape_apps.furniture.shape.design_modes import DesignModes

from restshape.guidance.force_space import LEAST_GAIN, LONGEST, ForceSpace

DEPENDENT = 1e-5
"""Singular values, in parts of the largest, that count as none."""

PLACES = (0.03, 0.15, 0.4, 0.8)
"""Where along a predicted span the full test is made."""

FURTHER = (1.15, 1.5)
"""And in parts of where the box is entered."""

DENSE = 401
"""Places of the full test along each mode alone, both ways."""

Ray = tuple[np.ndarray, float, float]


def rays(space: ForceSpace, most: int) -> dict[tuple[int, ...], Ray]:
    """Direction, entry to the box and exit of each combination that (6.18) to (6.21) let through."""
    found: dict[tuple[int, ...], Ray] = {}
    for count in range(1, most + 1):
        for modes in choose(range(len(space.K)), count):
            if (ray := _ray(space, space.K[list(modes)].T)) is not None:
                found[modes] = ray
    return found


def _ray(space: ForceSpace, K: np.ndarray) -> Ray | None:
    y = np.linalg.lstsq(K, -space.gap, rcond=DEPENDENT)[0]
    size = np.linalg.norm(y)
    # A mode that takes no part makes it another combination.
    if size == 0.0 or np.abs(y).min() < 1e-6 * size:
        return None
    direction = y / size
    slope = K @ direction
    if np.linalg.norm(slope) < LEAST_GAIN:
        return None
    inside, t = [0.0, LONGEST], np.inf
    for rate, h, low, high in zip(slope, space.h, space.low, space.high):
        if rate == 0.0 and not low <= h <= high:
            return None
        if rate != 0.0:
            t = sorted(((low - h) / rate, (high - h) / rate))
            inside = [max(inside[0], t[0]), min(inside[1], t[1])]
    return (direction, inside[0], inside[1]) if inside[0] <= inside[1] else None


def confirmed(
    furniture: Furniture, modes: DesignModes, found: dict[tuple[int, ...], Ray], wanted: int = ALL
) -> set[tuple[int, ...]]:
    """Those rays along which the full test holds somewhere."""
    good = set()
    for some, (direction, enters, leaves) in found.items():
        whole = modes.direction(np.array(some), direction)
        places = [enters + part * (leaves - enters) for part in PLACES] + [part * enters for part in FURTHER]
        if any(0.0 < t <= LONGEST and not furniture.test(t * whole, wanted).flaws & wanted for t in places):
            good.add(some)
    furniture.test()
    return good


def alone(furniture: Furniture, modes: DesignModes, wanted: int = ALL) -> set[tuple[int, ...]]:
    """Modes along which the full test holds alone at one of many places: no force space, no direction, all modes."""
    t = np.linspace(-LONGEST, LONGEST, DENSE)
    directions = [modes.direction(np.array([k]), np.ones(1)) for k in range(len(modes))]
    good = {(k,) for k, way in enumerate(directions) if (furniture.kernel.scan(way, t, wanted)[0] == 0).any()}
    furniture.test()
    return good


def distinct(found: set[tuple[int, ...]]) -> set[tuple[int, ...]]:
    """Those that hold no other one."""
    return {some for some in found if not any(set(other) < set(some) for other in found)}


def apart(found: set[tuple[int, ...]], expected: set[tuple[int, ...]]) -> tuple[set, set]:
    """What is expected of which nothing is found, and what is found that is no part of what is expected.

    A search also tries what it finds with modes left out, and then has the part in place of the whole.
    """
    missed = {some for some in expected if not any(set(less) <= set(some) for less in found)}
    return missed, {some for some in found if not any(set(some) <= set(whole) for whole in expected)}
