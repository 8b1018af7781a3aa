"""Arrays of frozen states that are computed when they are asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import cast

import numpy as np


class LateArray:
    """An attribute of a dataclass: an array, or what makes it, called when it is read for the first time."""

    def __set_name__(self, owner: type, name: str) -> None:
        self._key = f"_{name}"

    def __get__(self, instance: object, owner: type | None = None) -> np.ndarray:
        if instance is None:
            # What dataclasses take for the default.
            return _none  # type: ignore[return-value]
        known = instance.__dict__[self._key]
        if callable(known):
            known = instance.__dict__[self._key] = known()
        found: np.ndarray = known
        return found

    def __set__(self, instance: object, value: np.ndarray | Callable[[], np.ndarray]) -> None:
        instance.__dict__[self._key] = value


def _none() -> np.ndarray:
    """No unknowns."""
    return np.zeros((0, 2))


LATE = cast(np.ndarray, LateArray())
"""The value that a dataclass gives such an attribute, which it declares as an array."""
