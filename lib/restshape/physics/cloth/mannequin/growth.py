"""Mannequins whose sizes change: their surfaces and distances, and where what lies on them goes."""

from __future__ import annotations

import json
from dataclasses import astuple
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from restshape.mesh.closed_surface import ClosedSurface
from restshape.mesh.surface_distance import SurfaceDistance, kept_distance
from restshape.scene.bodies import MannequinBody
from restshape.scene.body_sizes import Sizes

if TYPE_CHECKING:
    from restshape.physics.cloth.mannequin.body_shape import BodyShape

FINE = 93
"""Triangles along the height, where no size is given."""
LIKENESS = 1
"""Of what is made from sizes; another one makes all grids of the cache again."""
ROUNDS = 3
"""Steps of Newton's method by which a place comes to the same distance from the other surface."""
LONGEST = 0.02
"""Such a step at most, over the height."""


@lru_cache(maxsize=8)
def mannequin_surface(sizes: Sizes, size: float | None) -> ClosedSurface:
    """The surface of a mannequin.

    Args:
        sizes: all of them.
        size: of triangles [m]; None: a share of the height.

    Raises:
        UserError: no body has these sizes.
    """
    # Imported here, as below: few scenes have mannequins, whose surfaces take VTK and splines.
    from restshape.physics.cloth.mannequin.mannequin_surface import Mannequin

    made = Mannequin(sizes, size or sizes.height / FINE)
    return ClosedSurface(made.nodes, made.triangles.astype(np.int32), 1.0)


@lru_cache(maxsize=8)
def mannequin_distance(sizes: Sizes, size: float | None, spacing: float | None, band: float | None) -> SurfaceDistance:
    """The distance from a mannequin, of the cache or made now.

    Args:
        sizes, size: as of `mannequin_surface`; spacing, band: as of `distance_of_file`.

    Raises:
        UserError: no body has these sizes, or the grid is too large.
    """
    content = json.dumps(["mannequin", LIKENESS, size, *astuple(sizes)]).encode()
    return kept_distance(content, lambda: mannequin_surface(sizes, size), (None, spacing, band))


@lru_cache(maxsize=8)
def body_shape(sizes: Sizes) -> BodyShape:
    """The shape of a mannequin of these sizes, all of them."""
    from restshape.physics.cloth.mannequin.body_shape import BodyShape

    return BodyShape(sizes)


def _distance(form: MannequinBody) -> SurfaceDistance:
    return mannequin_distance(form.sizes, form.size, form.spacing, form.band)


@lru_cache(maxsize=32)
def growth(before: MannequinBody, after: MannequinBody) -> float:
    """How far the surfaces of two mannequins of numbers are apart, at most, in their own coordinates [m]."""
    old, new = _distance(before), _distance(after)
    return float(max(np.abs(new.grid.values(old.X)).max(), np.abs(old.grid.values(new.X)).max()))


def taken_to(before: MannequinBody, after: MannequinBody, places: np.ndarray) -> np.ndarray:
    """Where places (n, 3) [m] on a mannequin are once its sizes are others, as far from its surface; own coordinates.

    Sections of its parts carry them along, as those of trunk, arms and legs do the surface.
    """
    old, new, longest = _distance(before).grid, _distance(after).grid, LONGEST * after.sizes.height
    found = body_shape(before.sizes).taken_to(body_shape(after.sizes), places)
    wanted = old.values(places)
    for _ in range(ROUNDS):
        value, gradient, _ = new.at(found)
        square = np.maximum(np.einsum("ij,ij->i", gradient, gradient), 0.25)
        step = np.clip((wanted - value) / square, -longest, longest)
        found = found + step[:, None] * gradient
    return found
