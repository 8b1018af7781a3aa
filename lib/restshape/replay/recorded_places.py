"""The singular places of a frame as text of its row: quantities that are taken there, and where they are."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from restshape.arrays import Reals

if TYPE_CHECKING:
    from restshape.application import Application
    from restshape.scene.model import Scene

SINGULAR_PLACES = "singular_places"
"""The column."""
PLACES_BYTES = 320
"""Of the column at most."""


@dataclass(frozen=True)
class RecordedPlaces:
    """What a frame has at singular places.

    Args:
        exponents: of displacements, by quantity that has no limit under refinement; 0 at a point load.
        points: (k, 2) places of the shape at rest [m], the worst first.
        more_points, more_quantities: how many did not fit into the column.
    """

    exponents: Mapping[str, float] = field(default_factory=dict)
    points: Reals = field(default_factory=lambda: np.empty((0, 2)))
    more_points: int = 0
    more_quantities: int = 0


def places_wanted(scene: Scene, application: Application) -> bool:
    """Whether replays of a scene look for singular places."""
    return bool(scene.quantities) and any(one.inspect_shape for one in application.physics)


def encode_places(exponents: Mapping[str, float], points: Sequence[Sequence[float]]) -> str:
    """JSON text of what `RecordedPlaces` has, points to six digits; empty without any.

    Where all do not fit into the column, the last places are left out, and then the last quantities; both are counted.
    """
    if not exponents:
        return ""
    named = dict(exponents)
    at = [[float(f"{x:.6g}") for x in point] for point in points]
    left_out: list[int] = []
    while len((text := _compact([named, at, *left_out])).encode()) > PLACES_BYTES:
        if at:
            at.pop()
        else:
            named.popitem()
        left_out = [len(points) - len(at), len(exponents) - len(named)]
    return text


def _compact(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, separators=(",", ":"))


def decode_places(text: str) -> RecordedPlaces:
    """What `encode_places` has written; none where it is another text."""
    try:
        named, at, *left_out = json.loads(text) if text else ({}, [])
        points = np.array(at, dtype=float).reshape(-1, 2)
        exponents = {str(name): float(value) for name, value in named.items()}
        more_points, more_quantities = map(int, left_out or (0, 0))
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError):
        return RecordedPlaces()
    return RecordedPlaces(exponents, points[np.isfinite(points).all(axis=1)], more_points, more_quantities)
