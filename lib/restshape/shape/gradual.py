"""Values of a scene that go evenly from what they are to what they shall be, over some frames."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.given_numbers import value_at
from restshape.scene.load import revise
from restshape.scene.model import Scene


def sweep(scene: Scene, key: str, value: object) -> Callable[[Scene, float], Scene]:
    """What gives a scene with a part, 0 to 1, of the way of a number, or of a list of numbers, at a dotted key.

    The whole of the way ends at the value as it was given.

    Raises:
        UserError: there is no such key, the value does not suit it, or one of both is no number.
    """
    first, last = (_numbers(value_at(given, key), key) for given in (scene, revise(scene, key, value)))
    if first.shape != last.shape:
        raise UserError(f"{key} holds {first.size} numbers, and the value {last.size}", do="give as many")

    def part_of(now: Scene, part: float) -> Scene:
        return revise(now, key, value if part == 1.0 else (first + part * (last - first)).tolist())

    return part_of


def _numbers(value: object, key: str) -> Reals:
    """A number or a list of numbers as an array."""
    values = value if isinstance(value, (list, tuple)) else (value,)
    if not all(isinstance(one, float) for one in values):
        raise UserError(
            f"{key} has no number that could change evenly over frames", do="leave frames out, or give numbers"
        )
    return np.array(value)
