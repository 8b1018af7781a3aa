"""What would hold a piece that slides: a rougher floor, or more weight upon it."""

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace

import numpy as np
from restshape_apps.furniture.shape.planks import Piece

ROUGH = 1e6
"""Coefficient of friction of a floor on which nothing slides."""
CLOSE = 1e-3
"""How closely the friction is found that a piece needs, in parts of it."""
ABOVE = 1e-6
"""How far above the ratio of forces it is tested, in parts of it: there the test of stability is beyond rounding."""

Falling = Callable[[Piece], Collection[int]]
"""The cases that a piece falls or slides in."""


def on_floor(piece: Piece, mu: float) -> Piece:
    """The piece on a floor of a friction."""
    floor, *others = piece.planes
    return replace(piece, planes=(replace(floor, mu=mu), *others))


def friction_needed(piece: Piece, load: np.ndarray, case: int, falling: Falling) -> float:
    """The least friction of the floor on which a piece does not slide in a case; inf where none is enough.

    It is the ratio of the forces along the floor and on it, or more where the piece would turn too.

    Args:
        piece: in one part, that slides in that case.
        load: (3,) all that acts in that case [N].
        case: 0: of the weights alone; k + 1: with push k.
        falling: what tests a piece.
    """

    def holds(mu: float) -> bool:
        return case not in falling(on_floor(piece, mu))

    along, on = _along_and_on(piece, load)
    low = (1.0 + ABOVE) * along / on if on > 0.0 else 0.0
    if low > piece.planes[0].mu and holds(low):
        return low
    low = high = max(low, piece.planes[0].mu, CLOSE)
    while not holds(high):
        low, high = high, 2.0 * high
        if high > ROUGH:
            return np.inf
    while high > (1.0 + CLOSE) * low:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high


def mass_needed(piece: Piece, loads: Sequence[np.ndarray], falling: Falling) -> float:
    """How much more mass [kg], spread like what the piece and its weights have, holds one that slides; inf: none.

    Args:
        piece: that slides.
        loads: (3,) all that acts in each case in which it does [N].
        falling: what tests a piece.
    """
    gravity, mu = float(np.linalg.norm(piece.gravity)), piece.planes[0].mu
    part, more = 1.0, 0.0
    for along, on in (_along_and_on(piece, load) for load in loads):
        if not gravity or not mu or on <= 0.0:
            return np.inf
        part = max(part, (1.0 + ABOVE) * along / mu / on)
        more = max(more, (along / mu - on) / gravity)
    weights = tuple(replace(load, force=_times(part, load.force)) for load in piece.weights)
    return np.inf if falling(replace(piece, gravity=_times(part, piece.gravity), weights=weights)) else more


def _times(part: float, force: tuple[float, float, float]) -> tuple[float, float, float]:
    return part * force[0], part * force[1], part * force[2]


def _along_and_on(piece: Piece, load: np.ndarray) -> tuple[float, float]:
    """Sizes of a force along the floor and on it [N]."""
    normal = np.array(piece.planes[0].normal)
    on = -float(load @ normal)
    return float(np.linalg.norm(load + on * normal)), on
