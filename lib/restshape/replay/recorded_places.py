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
    """

    exponents: Mapping[str, float] = field(default_factory=dict)
    points: Reals = field(default_factory=lambda: np.empty((0, 2)))


def places_wanted(scene: Scene, application: Application) -> bool:
    """Whether replays of a scene look for singular places."""
    return bool(scene.quantities) and any(one.inspect_shape for one in application.physics)


def encode_places(exponents: Mapping[str, float], points: Sequence[Sequence[float]]) -> str:
    """JSON text of what `RecordedPlaces` has, points to six digits; empty without any.

    Where all do not fit into the column, the last places are left out, and then the last quantities.
    """
    if not exponents:
        return ""
    named = dict(exponents)
    at = [[float(f"{x:.6g}") for x in point] for point in points]
    while len((text := json.dumps([named, at], ensure_ascii=False, separators=(",", ":"))).encode()) > PLACES_BYTES:
        if at:
            at.pop()
        else:
            named.popitem()
    return text


def decode_places(text: str) -> RecordedPlaces:
    """What `encode_places` has written; none where it is another text."""
    try:
        named, at = json.loads(text) if text else ({}, [])
        points = np.array(at, dtype=float).reshape(-1, 2)
        exponents = {str(name): float(value) for name, value in named.items()}
    except (ValueError, TypeError, AttributeError, OverflowError, RecursionError):
        return RecordedPlaces()
    return RecordedPlaces(exponents, points[np.isfinite(points).all(axis=1)])
