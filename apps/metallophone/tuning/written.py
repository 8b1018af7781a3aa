"""Tuned numbers as a scene's file has them: in the unit that stood there."""

from restshape.scene.given_numbers import value_below
from restshape.scene.model import Scene
from restshape.scene.units import NUMBER_UNIT, unit

DIGITS = 10
"""More than tuned numbers have, so that a unit costs none of theirs."""


def written(scene: Scene, key: tuple[str, ...], value: float) -> float | str:
    """A value [SI] as it is to stand at a key of a scene: with the unit of the text that is there, or as a number."""
    before = value_below(scene.raw, key)
    match = NUMBER_UNIT.match(before) if isinstance(before, str) else None
    if match is None or not match[2]:
        return value
    return f"{value / unit(match[2])[0]:.{DIGITS}g} {match[2].strip()}"
