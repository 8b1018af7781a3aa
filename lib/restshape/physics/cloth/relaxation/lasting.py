"""What stays of cloth at rest while it goes somewhere as it lies: found once for all of these rests."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np

T = TypeVar("T")


class Lasting:
    """What is known of cloth by the places of its parts beside each other and beside bodies: strains, crossings.

    Args:
        x: (n, 3) unknowns that it is of, by identity: of others nothing is known.
        known: by name.
    """

    def __init__(self, x: np.ndarray | None = None, known: dict[str, Any] | None = None) -> None:
        self._x, self._known = x, {} if known is None else known

    def at(self, x: np.ndarray, along: bool) -> Lasting:
        """The same of cloth at x (n, 3) where all of it and all bodies have gone `along`; else nothing is known."""
        return Lasting(x, self._known if along else None)

    def __call__(self, x: np.ndarray, name: str, find: Callable[[], T]) -> T:
        """What has a name of cloth at x (n, 3); `find` gives what is not known."""
        if x is not self._x:
            return find()
        if name not in self._known:
            self._known[name] = find()
        found: T = self._known[name]
        return found
