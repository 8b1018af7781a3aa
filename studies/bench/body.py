"""Grids of a body's distance: how long they take to make, to read and to ask, and an adaptive one beside them."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any
from unittest import mock

import numpy as np
from restshape_studies.bench.adaptive_distance import AdaptiveDistance

from restshape import _kernels
from restshape.mesh.closed_surface import ClosedSurface, read_closed_surface
from restshape.mesh.surface_distance import SurfaceDistance, away_from_axis, kept_distance, places_in_band
from restshape.physics.cloth.mannequin.mannequin_surface import Mannequin
from restshape.scene.body_sizes import BODIES

ASKED, REPEATS = 10_000, 20
"""Places that are asked at once, and how often; the shortest time counts."""
NEAR = 5e-3
"""Distance from the surface within which they are [m]."""
SIDES = 1e-7
"""Way across a place between which gradients are compared, over the side of the whole [m/m]."""
TOLERANCES = (4.0, 2.0, 1.0)
"""Of the adaptive grid, over the even one's error of 99 % of the places."""


def body_of(file: Path | None, triangles: int) -> ClosedSurface:
    """The surface of a file; without one a mannequin of about so many triangles."""
    if file is not None:
        return read_closed_surface(file)
    sizes = BODIES["standard"].completed()
    made = Mannequin(sizes, sizes.height / 93.0 * np.sqrt(14_276 / triangles))
    return ClosedSurface(made.nodes, made.triangles.astype(np.int32), 1.0)


def grid_times(surface: ClosedSurface, spacing: float | None) -> dict[str, Any]:
    """Seconds that the grid of a surface takes to make and to read again, and milliseconds to ask it.

    Args:
        surface: of a body; spacing: of the grid [m]; None: as its error asks for.
    """
    content = surface.X.tobytes() + surface.cells.tobytes()

    def distance() -> SurfaceDistance:
        return kept_distance(content, lambda: surface, (None, spacing, None))

    with (
        tempfile.TemporaryDirectory(prefix="restshape-body-") as folder,
        mock.patch.dict(os.environ, {"XDG_CACHE_HOME": folder}),
    ):
        made, busy = _seconds(distance, time.process_time)
        read = [_seconds(distance, time.perf_counter)[1] for _ in range(5)]
    body = _kernels.Body.mesh(made.grid, np.zeros(3), np.eye(3))
    x = places_in_band(surface, ASKED, NEAR)
    asked = [_seconds(lambda: body.distance(x), time.perf_counter)[1] for _ in range(REPEATS)]
    facts = made.facts
    return {
        "triangles": facts.triangles, "spacing": facts.spacing, "band": facts.band, "error": facts.error,
        "usual_error": facts.usual_error, "megabytes": 1e-6 * facts.stored, "made": busy, "read": min(read),
        "asked_ms": 1e3 * min(asked), "grid": made.grid,
    }  # fmt: skip


def beside_adaptive(surface: ClosedSurface, found: dict[str, Any], places: int = 20_000) -> list[dict[str, Any]]:
    """The even grid and adaptive ones in the same band: memory, errors, and jumps of the gradient.

    Args:
        surface: of the body; found: of its even grid, as of `grid_times`.
        places: at which errors are measured.
    """
    search, band, grid = _kernels.SurfaceSearch(surface.X, surface.cells), found["band"], found["grid"]
    x = places_in_band(surface, places, band)
    x = x[away_from_axis(search, x, found["spacing"])]
    exact, nearest = search.nearest(x)
    normals = (x - nearest) / exact[:, None]
    low, high = surface.box
    side = float((high - low).max()) + 2.2 * band
    corner = 0.5 * (low + high) - 0.5 * side

    def even(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return grid.at(x)[:2]

    rows = [_errors("even, cubic", found["megabytes"], even, x, exact, normals, side)]
    for factor in TOLERANCES:
        tolerance = factor * found["usual_error"]
        (adaptive, busy) = _seconds(partial(AdaptiveDistance, search, corner, side, band, tolerance), time.process_time)
        row = _errors(f"cubes, {1e3 * tolerance:.2g} mm", adaptive.megabytes, adaptive.at, x, exact, normals, side)
        rows.append(row | {"cubes": adaptive.cubes, "made": busy})
    return rows


def _errors(
    name: str, megabytes: float, at: Callable, x: np.ndarray, exact: np.ndarray, normals: np.ndarray, side: float
) -> dict[str, Any]:
    """What a grid is wrong by at places x (n, 3): its distance, its gradient, and jumps of this."""
    value, gradient = at(x)
    error = np.abs(value - exact)
    slope = np.linalg.norm(gradient - normals, axis=1)
    return {
        "name": name,
        "megabytes": megabytes,
        "error": float(error.max()),
        "usual_error": float(np.quantile(error, 0.99)),
        "gradient": float(np.quantile(slope, 0.99)),
        "jump": float(np.quantile(_jumps(at, x, side), 0.99)),
    }


def _jumps(at: Callable, x: np.ndarray, side: float) -> np.ndarray:
    """How far (n,) the gradient jumps at the faces that ways of a hundredth of a millimetre to 2 mm cross first.

    Places are halved between ends whose gradients differ by more than those of a smooth function would.
    """
    rng = np.random.default_rng(2)
    way = rng.normal(size=x.shape)
    way *= 2e-3 / np.linalg.norm(way, axis=1)[:, None]
    low, high = x.copy(), x + way
    first, last = at(low)[1], at(high)[1]
    while np.linalg.norm(high - low, axis=1).max() > SIDES * side:
        middle = 0.5 * (low + high)
        own = at(middle)[1]
        before = (np.linalg.norm(own - first, axis=1) > np.linalg.norm(last - own, axis=1))[:, None]
        high, last = np.where(before, middle, high), np.where(before, own, last)
        low, first = np.where(before, low, middle), np.where(before, first, own)
    return np.asarray(np.linalg.norm(last - first, axis=1))


def _seconds(run: Callable[[], Any], clock: Callable[[], float]) -> tuple[Any, float]:
    """What it gives, and how long it takes [s]."""
    begin = clock()
    found = run()
    return found, clock() - begin
