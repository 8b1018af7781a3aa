"""Changes of planks in plain words: how many millimetres or degrees, and which way."""

import numpy as np
from restshape_apps.furniture.shape.directions import room_words
from restshape_apps.furniture.shape.planks import FREEDOMS, Piece, Plank

DIGITS = 3
STRAIGHT = 1.0 - 1e-9
"""Least cosine with an axis of the room for a line to be reported as that axis."""

UNITS = {"m": (1e3, "mm"), "rad": (180.0 / np.pi, "deg")}
"""What people read in place of a unit of design parameters."""


def unit_of(number: int) -> str:
    """The unit of a design parameter."""
    return "rad" if 3 <= number < 6 else "m"


LENGTHS = np.array([unit_of(number) == "m" for number in range(8)])
"""Which design parameters of a plank are moves or lengths."""
EQUAL = 9
"""Decimals to which changes of two parameters are compared."""


def parameters(piece: Piece, direction: np.ndarray) -> list[tuple[int, int]]:
    """Planks and numbers of the design parameters that a direction (n, 8) changes, that which changes most first.

    Moves and lengths count in parts of the piece's size, turns in radians.
    """
    share = _shares(piece, direction)
    return sorted(((int(p), int(f)) for p, f in np.argwhere(direction)), key=lambda one: (-share[one], one))


def leading_parameter(piece: Piece, direction: np.ndarray) -> tuple[int, int]:
    """The first of the parameters that a direction (n, 8) changes."""
    plank, number = divmod(int(_shares(piece, direction).argmax()), direction.shape[1])
    return plank, number


def _shares(piece: Piece, direction: np.ndarray) -> np.ndarray:
    """How much a direction changes each design parameter (n, 8): in parts of the piece's size, or in radians."""
    return np.round(np.abs(direction) / np.where(LENGTHS, piece.size, 1.0), EQUAL)


def named(piece: Piece, direction: np.ndarray) -> str:
    """What a direction (n, 8) changes, without amounts."""
    return " + ".join(f"{piece.planks[p].name}: {FREEDOMS[f]}" for p, f in parameters(piece, direction))


def in_words(piece: Piece, change: np.ndarray) -> str:
    """What a change (n, 8) of the design parameters does, plank by plank, with amounts and directions."""
    return "; ".join(_one(piece, p, f, float(change[p, f])) for p, f in parameters(piece, change))


def amount(value: float, unit: str, digits: int = DIGITS) -> str:
    """A number [m or rad] as people read it."""
    factor, name = UNITS[unit]
    text = np.format_float_positional(factor * value, digits, unique=False, fractional=False, trim="-")
    return f"{text} {name}"


def ends(low: float, high: float, unit: str) -> tuple[str, str]:
    """The ends of a range [m or rad] as people read them, with more digits only where these are needed to tell them
    apart."""
    pairs = ((amount(low, unit, digits), amount(high, unit, digits)) for digits in (DIGITS, 5, 7))
    return next((pair for pair in pairs if pair[0] != pair[1]), (amount(low, unit), amount(high, unit)))


def along(way: np.ndarray) -> str:
    """The line that a unit vector (3,) lies in, whichever way along it: an axis of the room, or a direction."""
    k = int(np.argmax(np.abs(way)))
    if abs(way[k]) > STRAIGHT:
        return f"along {'xyz'[k]}"
    parts = np.round(way * np.sign(way[k]), DIGITS) + 0.0
    return f"along ({', '.join(f'{part:g}' for part in parts)})"


def _one(piece: Piece, p: int, number: int, change: float) -> str:
    """What the change of one design parameter does."""
    plank, (kind, axis) = piece.planks[p], FREEDOMS[number].split()
    column, sign = "xyz".index(axis), "-" if change < 0.0 else "+"
    far = amount(abs(change), unit_of(number))
    if kind == "length":
        longer = "longer" if change > 0.0 else "shorter"
        return f"{plank.name} {far} {longer} along its {axis} ({_ends(piece, p, column)})"
    way = room_words(np.sign(change) * plank.axes[:, column])
    if kind == "move":
        return f"{plank.name} moved {far} along its {sign}{axis} (towards {way})"
    return f"{plank.name} turned {far} about its {sign}{axis} (about {way})"


def _ends(piece: Piece, p: int, axis: int) -> str:
    """Which end of a plank is free to go when its length along an axis changes."""
    joined = {joint.side for joint in piece.joints if joint.i == p} | {f.side for f in piece.feet if f.plank == p}
    free = [side for side in (2 * axis, 2 * axis + 1) if side not in joined]
    return " and ".join(f"at {_side(piece.planks[p], side)}" for side in free)


def _side(plank: Plank, side: int) -> str:
    return room_words((1.0 if side % 2 else -1.0) * plank.axes[:, side // 2])
