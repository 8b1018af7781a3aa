"""Signed distance from a closed surface on even grids, made once and kept in the user's cache."""

from __future__ import annotations

import hashlib
import json
import logging
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, replace
from functools import lru_cache
from pathlib import Path
from time import perf_counter
from zipfile import BadZipFile

import numpy as np

from restshape import _kernels
from restshape.bounds import BODY_BRICKS, BODY_LATTICE
from restshape.errors import UserError, one_line
from restshape.mesh.closed_surface import ClosedSurface, SurfaceHole, read_closed_surface
from restshape.mesh.outer_faces import Search, body_search
from restshape.outputs.atomic_files import replacing

CELLS = 8
"""Cells of a brick along each axis."""
NODES = CELLS + 3
"""Coefficients of a brick along each axis."""
CELL = 1.4e-5
"""Area of a cell at first, over that of the surface: about 2,500 bricks."""
FINEST = 0.25e-3
"""Spacing below which nothing is chosen [m]."""
GOAL = 0.4e-3
"""Error of the distance above which the spacing is made smaller [m], where the scene names none."""
REFINED, TRIES = 1.5, 3
"""By how much, and how often the spacing is chosen, at most."""
BAND, LEAST_BAND = 4.0, 8e-3
"""Band on both sides of the surface, over the spacing, and at least [m]."""
SAMPLES = 4000
"""Places at which the error is measured."""
TURNED = 0.9
"""Cosine of the angle between the directions to the surface two cells apart, below which the medial axis is near."""
SPARE = 1.2
"""Factor on second derivatives between places where they are looked at."""
RAYS, THIN = 2000, 0.05
"""Rays through the body, and the share of them that pass through what is thinner than `SurfaceDistance.thin`."""
SHARP = 0.01
"""Share of the surface that counts as its edges."""
FACE = 0.5
"""Size down to which faces that are partly inside of the body are cut, over the first spacing."""
AROUND = 6
"""Exact places around bricks: what the filter takes from farther ones has fallen to (2 - sqrt 3)^6 = 4e-4 of itself."""
VERSION = 5
"""Of what the cache holds."""
KEPT = 2_000_000_000
"""Bytes that the cache keeps, at most."""

log = logging.getLogger("restshape.mesh")

Settings = tuple[float | None, float | None, float | None]
"""Unit, spacing and band [m]."""
Made = dict[str, np.ndarray]
"""What a grid is made from, by name, as the cache keeps it."""

OUTSIDE, INSIDE = -1, -2
"""What the table has in place of bricks that are not stored."""


@dataclass(frozen=True)
class DistanceFacts:
    """What there is to know of a grid.

    Args:
        unit: metres in one unit of the file; guessed: from the size.
        turned: the file's triangles look inwards.
        triangles: of the file and of what closes its holes.
        holes: that the file has, the widest first.
        spacing: of the grid [m]; band: in which it is stored, on both sides of the surface [m].
        error: the largest difference from the exact distance within the band, away from the medial axis [m].
        usual_error: that of 99 % of the places.
        stored: bytes of the bricks.
        edge: radius of curvature of its edges: all but the sharpest 1 % of its surface is rounder [m].
        thin: half of how thick the body is, but for the thinnest 5 % of its surface [m].
    """

    unit: float
    guessed: bool
    turned: bool
    triangles: int
    holes: tuple[SurfaceHole, ...]
    spacing: float
    band: float
    error: float
    usual_error: float
    stored: int
    edge: float
    thin: float


@dataclass(frozen=True, eq=False)
class SurfaceDistance:
    """The distance from a body's surface, in the coordinates of its file, in metres.

    Args:
        grid: the distance.
        facts: of it.
        X: (n, 3) corners of the surface [m]; cells: (m, 3) its triangles.
    """

    grid: _kernels.GridDistance
    facts: DistanceFacts
    X: np.ndarray
    cells: np.ndarray


def distance_of_file(
    path: Path | str, unit: float | None = None, spacing: float | None = None, band: float | None = None
) -> SurfaceDistance:
    """The distance from the surface of a file: of this process, of the cache, or made now.

    Args:
        path, unit: as of `read_closed_surface`.
        spacing: of the grid [m]; None: as its error asks for.
        band: on both sides of the surface [m], where cloth touches it; None: of the spacing.

    Raises:
        UserError: the file cannot be read, holds no closed surface, or the grid is too large.
    """
    path = Path(path)
    try:
        found = path.stat()
    except OSError as error:
        do = "paths in a scene are relative to the scene's folder"
        raise UserError("there is no such file of a body", str(path), do) from error
    return _loaded(path, found.st_mtime_ns, found.st_size, unit, spacing, band)


@lru_cache(maxsize=8)
def _loaded(
    path: Path, changed: int, size: int, unit: float | None, spacing: float | None, band: float | None
) -> SurfaceDistance:
    """The same; `changed` and `size` are those of the file."""
    content = path.suffix.lower().encode() + path.read_bytes()
    return kept_distance(content, lambda: read_closed_surface(path, unit), (unit, spacing, band), str(path))


def kept_distance(
    content: bytes, surface: Callable[[], ClosedSurface], settings: Settings, where: str = ""
) -> SurfaceDistance:
    """The distance from a surface: of the cache, or made now.

    Args:
        content: that the surface is made from, and nothing else.
        surface: makes it.
        settings: unit, spacing and band, as of `distance_of_file`.
        where: for messages.

    Raises:
        UserError: the surface cannot be made, or the grid is too large.
    """
    place = cache_folder() / f"{_digest(content, settings)}.npz"
    with suppress(OSError, ValueError, KeyError, TypeError, BadZipFile), np.load(place, allow_pickle=False) as kept:
        found = _restored({key: kept[key] for key in kept.files})
        # The last one that was of use is forgotten last.
        os.utime(place)
        return found
    begin = perf_counter()
    with _stage(where):
        made = make_distance(surface(), *settings[1:], where)
    found = _restored(made)
    log.info(
        "A grid of %.3g mm, %.3g MB, took %.3g s",
        1e3 * found.facts.spacing,
        found.facts.stored / 1e6,
        perf_counter() - begin,
    )
    _keep(place, made)
    return found


@contextmanager
def _stage(where: str) -> Iterator[None]:
    """Has a limit that is reached meanwhile say that a grid was being made."""
    of = f" of {one_line(Path(where).name)[:60]}" if where else ""
    log.info("The grid of distances%s is made: once, the cache keeps it", of)
    _kernels.set_stage(f", in the grid of distances{of}, which is made once: a larger spacing of the body takes less")
    try:
        yield
    finally:
        _kernels.set_stage("")


def cache_folder() -> Path:
    """Where grids are kept: below XDG_CACHE_HOME, else in the user's ``.cache``."""
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "restshape" / "bodies"


def _digest(content: bytes, settings: Settings) -> str:
    """What names a grid, by all that it is made from."""
    found = hashlib.sha256(content)
    # Spacing and band are in metres: the digits of all numbers are a part of the name.
    found.update(json.dumps([VERSION, *settings]).encode())
    return found.hexdigest()[:40]


def _keep(place: Path, made: Made) -> None:
    """Puts a grid into the cache, whole or not at all; where nothing can be written it is made again next time.

    Those that were not of use for longest make room.
    """
    with suppress(OSError):
        place.parent.mkdir(parents=True, exist_ok=True)
        with replacing(place) as part:
            np.savez(part, **made)
        _make_room(place)


def _make_room(place: Path) -> None:
    """Takes grids out of the cache, but the one just put into it; others may take some out at the same time."""
    kept = []
    for one in place.parent.glob("*.npz"):
        with suppress(OSError):
            kept.append((one.stat(), one))
    kept.sort(key=lambda one: -one[0].st_mtime_ns)
    for size, (_, one) in zip(np.cumsum([found.st_size for found, _ in kept]), kept):
        if size > KEPT and one != place:
            with suppress(OSError):
                one.unlink()


def _restored(made: Made) -> SurfaceDistance:
    """The distance from the arrays that it is kept as."""
    given = json.loads(str(made["facts"]))
    given["holes"] = tuple(SurfaceHole(hole["edges"], hole["width"], tuple(hole["center"])) for hole in given["holes"])
    facts = DistanceFacts(**given)
    return SurfaceDistance(_grid(made), facts, made["X"], made["cells"])


def _grid(made: Made) -> _kernels.GridDistance:
    """The grid of its arrays."""
    slope, thin, sharpest, slack = (float(value) for value in made["numbers"])
    return _kernels.GridDistance(
        origin=made["origin"].tolist(),
        spacing=float(made["spacing"]),
        bricks=made["bricks"].tolist(),
        low=made["low"].tolist(),
        high=made["high"].tolist(),
        band=float(made["band"]),
        table=made["table"],
        fine=made["fine"],
        coarse=made["coarse"],
        bent=made["bent"],
        slope=slope,
        thin=thin,
        sharpest=sharpest,
        slack=slack,
    )


def make_distance(
    surface: ClosedSurface, spacing: float | None = None, band: float | None = None, where: str = ""
) -> Made:
    """The arrays of a grid, as the cache keeps them.

    Args:
        surface: the body's.
        spacing, band: as of `distance_of_file`.
        where: the file, for messages.

    Raises:
        UserError: the grid is too large.

    Source: docs/theory/cloth.md.
    """
    if not hasattr(_kernels, "SurfaceSearch"):
        do = "install libcgal-dev, and build restshape again"
        raise UserError("bodies of triangles need CGAL, without which restshape was built", where, do)
    surface = replace(surface, cells=surface.cells[surface.areas > 0.0])
    step = spacing or _first_spacing(surface, band)
    search = body_search(surface, FACE * step)
    for attempt in range(TRIES):
        made = _sampled(search, surface, step, band or max(BAND * step, LEAST_BAND), where)
        error, usual = _errors(search, surface, made)
        if spacing or error <= GOAL or attempt == TRIES - 1 or not _fits(surface, step / REFINED, band):
            break
        step /= REFINED
    _bound(search, surface, made)
    facts = DistanceFacts(
        surface.unit, surface.guessed, surface.turned, len(surface.cells), surface.holes, step,
        float(made["band"]), error, usual, made["fine"].nbytes,
        _edge(surface, made), float(made["numbers"][1]),
    )  # fmt: skip
    return made | {"facts": np.array(json.dumps(asdict(facts))), "X": surface.X, "cells": surface.cells}


def _layout(surface: ClosedSurface, spacing: float, band: float) -> tuple[np.ndarray, np.ndarray]:
    """The origin (3,) [m] of the first brick, and the number (3,) of bricks along each axis, which no integer may hold.

    Coefficients ring at the border of the box, which stays away from the band for that.
    """
    low, high = surface.box
    wide = CELLS * spacing
    with np.errstate(over="ignore"):
        bricks = np.ceil((high - low + 2.0 * (band + AROUND * spacing)) / wide)
    return 0.5 * (low + high) - 0.5 * wide * bricks, bricks


def _first_spacing(surface: ClosedSurface, band: float | None) -> float:
    """The spacing [m] that is tried first."""
    step = max(FINEST, float(np.sqrt(CELL * surface.areas.sum())))
    while not _fits(surface, step, band):
        step *= REFINED
    return step


def _fits(surface: ClosedSurface, spacing: float, band: float | None) -> bool:
    """Whether a finer grid is not too large to be made."""
    if spacing < FINEST:
        return False
    _, bricks = _layout(surface, spacing, band or max(BAND * spacing, LEAST_BAND))
    return bool(np.prod(CELLS * bricks + 3) <= BODY_LATTICE)


def _lattice(origin: np.ndarray, step: float, counts: np.ndarray) -> np.ndarray:
    """The places (n, 3) [m] of an even grid, z running fastest."""
    axes = [origin[a] + step * np.arange(counts[a]) for a in range(3)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)


def _sampled(search: Search, surface: ClosedSurface, spacing: float, band: float, where: str) -> Made:
    """The arrays of a grid of a spacing [m] in a band [m]."""
    from scipy.ndimage import spline_filter

    origin, bricks = _layout(surface, spacing, band)
    if (places := np.prod(CELLS * bricks + 3.0)) > BODY_LATTICE:
        what = f"a grid of {1e3 * spacing:.3g} mm around the body has {places:.3g} places"
        raise UserError(f"{what}, more than {BODY_LATTICE:.3g}", where, "write a larger spacing beside the file")
    bricks = bricks.astype(np.int64)
    counts, wide = CELLS * bricks + 3, CELLS * spacing
    middles = search.nearest(_lattice(origin + 0.5 * wide, wide, bricks))[0]
    inner = np.abs(middles) <= band + 0.5 * np.sqrt(3.0) * wide
    if inner.sum() > BODY_BRICKS:
        what = f"the band of {1e3 * band:.3g} mm takes {inner.sum()} bricks of {1e3 * wide:.3g} mm"
        raise UserError(f"{what}, more than {BODY_BRICKS}", where, "write a narrower band, or a larger spacing")
    table = np.where(middles > 0.0, OUTSIDE, INSIDE).astype(np.int32)
    table[inner] = np.arange(inner.sum())
    corners = search.nearest(_lattice(origin - wide, wide, bricks + 3))[0].reshape(bricks + 3)
    low, high = surface.box
    made: Made = {
        "origin": origin, "spacing": np.array(spacing), "bricks": bricks, "low": low, "high": high,
        "band": np.array(band),
        "table": table, "coarse": spline_filter(corners, order=3, mode="mirror"), "bent": np.zeros(inner.sum()),
        # The second is the depth of the body, until its bounds are known.
        "numbers": np.array([1.0, -min(float(middles.min()), float(corners.min())), 1.0, 0.0]),
    }  # fmt: skip
    values = _values(search, made, _places(made), counts)
    spline_filter(values, order=3, output=values, mode="mirror")
    # In bricks x runs fastest.
    made["fine"] = np.stack([values[_brick(at)].transpose(2, 1, 0) for at in _places(made)]).astype(np.float32)
    return made


def _bound(search: Search, surface: ClosedSurface, made: Made) -> None:
    """Put what bounds distances, their slopes and their curvature into the arrays of a grid."""
    depth = float(made["numbers"][1])
    steepest, above = _beyond_band(search, _grid(_without_bricks(made)), made)
    made["bent"], measured = _measured(_grid(made), made, _thin(search, surface, depth), steepest)
    made["numbers"] = np.append(measured, SPARE * above)
    # Farther beyond this box than a distance no place has a smaller one: contact ends there without a jump.
    lower = SPARE * _below_box(_grid(made), made)
    made["low"], made["high"] = made["low"] - lower, made["high"] + lower


def _without_bricks(made: Made) -> Made:
    """The arrays of the coarse grid alone."""
    bare = {"table": np.full_like(made["table"], INSIDE), "fine": made["fine"][:0], "bent": made["bent"][:0]}
    return made | bare


def _places(made: Made) -> np.ndarray:
    """The first cell (k, 3) of each brick that is stored."""
    return np.argwhere(made["table"].reshape(made["bricks"]) >= 0) * CELLS


def _brick(at: np.ndarray) -> tuple[slice, ...]:
    return tuple(slice(k, k + NODES) for k in at)


def _values(search: Search, made: Made, places: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """The distance on the whole even grid: exact in the bricks, of the coarse grid elsewhere."""
    near = np.zeros(counts, dtype=bool)
    for at in places:
        near[tuple(slice(max(k - AROUND, 0), k + NODES + AROUND) for k in at)] = True
    values = _of_coarse_grid(made, counts)
    search.fill_lattice(made["origin"] - made["spacing"], float(made["spacing"]), near.view(np.uint8), values)
    return values


def _of_coarse_grid(made: Made, counts: np.ndarray) -> np.ndarray:
    """The distance of the coarse grid on the whole even grid, whose outermost places take those of the box's faces."""
    from scipy.interpolate import BSpline

    values = made["coarse"]
    # The last axis is the first to grow, and then the last: each product has the axes in turn.
    for count, bricks in zip(counts[::-1], made["bricks"][::-1]):
        at = np.clip((np.arange(count) - 1.0) / CELLS, 0.0, bricks)
        weights = BSpline.design_matrix(at, np.arange(-3.0, bricks + 4.0), 3)
        first, second, last = values.shape
        values = (weights @ values.reshape(-1, last).T).reshape(count, first, second)
    return values


def _beyond_band(search: Search, coarse: _kernels.GridDistance, made: Made) -> tuple[float, float]:
    """The longest gradient of the coarse grid beyond the band, and how much too far it is outside there [m].

    Both at corners of bricks and middles of their edges, faces and insides.
    """
    wide = CELLS * float(made["spacing"])
    end = made["origin"] + (1.0 - 1e-9) * wide * made["bricks"]
    x = np.minimum(_lattice(made["origin"], 0.5 * wide, 2 * made["bricks"] + 1), end)
    distance, _ = search.nearest(x)
    found = coarse.shapes(x)
    beyond, outside = np.abs(distance) > made["band"], distance > made["band"]
    above = (found[:, 0] - distance)[outside].max(initial=0.0)
    return float(found[beyond, 1].max(initial=1.0)), float(above)


def _below_box(grid: _kernels.GridDistance, made: Made) -> float:
    """How much smaller the distance is than the way beyond a face of the surface's box, at most [m].

    Between the places that the spline takes values of, where it is exact: it is rounder than edges.
    """
    half, found = 0.5 * float(made["spacing"]), 0.0
    for at in _places(made):
        corner = made["origin"] + 2.0 * half * at
        if np.all((corner > made["low"]) & (corner + 2.0 * CELLS * half < made["high"])):
            continue
        x = _lattice(corner + 1e-6 * half, (1.0 - 1e-6) * half, np.full(3, 2 * CELLS + 1))
        beyond = np.maximum(made["low"] - x, x - made["high"]).max(axis=1)
        x, beyond = x[beyond > 0.0], beyond[beyond > 0.0]
        found = max(found, float((beyond - grid.values(x)).max(initial=0.0)) if len(x) else 0.0)
    return found


def _measured(grid: _kernels.GridDistance, made: Made, thin: float, steepest: float) -> tuple[np.ndarray, np.ndarray]:
    """How much the distance curves downwards in each brick [1/m], and the longest gradient, `thin`, and `sharpest`.

    Measured at corners of cells; `steepest` is the longest gradient elsewhere.
    """
    spacing, places = float(made["spacing"]), _places(made)
    bent = np.zeros(len(places))
    longest, round_ = max(1.0, steepest), 0.0
    for k, at in enumerate(places):
        found = grid.shapes(_lattice(made["origin"] + spacing * (at + 1e-6), (1.0 - 1e-6) * spacing, np.full(3, 9)))
        bent[k] = max(0.0, -SPARE * found[:, 2].min())
        longest = max(longest, found[:, 1].max())
        near = np.abs(found[:, 0]) < 2.0 * spacing
        round_ = max(round_, found[near, 3].max(initial=0.0))
    return bent, np.array([1.0 + SPARE * (longest - 1.0), thin, 1.0 / max(SPARE * round_, 1e-9)])


def _on_surface(surface: ClosedSurface, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Places (count, 3) [m] on the surface, as many on each area, and the normals there."""
    rng = np.random.default_rng(0)
    a, b, c = (surface.X[surface.cells[:, k]] for k in range(3))
    normals = np.cross(b - a, c - a)
    area = np.linalg.norm(normals, axis=1)
    faces = np.sort(rng.choice(len(area), size=count, p=area / area.sum()))
    u, v = rng.random((2, count, 1))
    over = u + v > 1.0
    u, v = np.where(over, 1.0 - u, u), np.where(over, 1.0 - v, v)
    places = a[faces] + u * (b - a)[faces] + v * (c - a)[faces]
    return places, (normals / np.maximum(area, 1e-300)[:, None])[faces]


def _thin(search: Search, surface: ClosedSurface, depth: float) -> float:
    """Half of how thick the body is [m], but for the thinnest 5 % of its surface; at most its depth [m]."""
    places, normals = _on_surface(surface, RAYS)
    start = 1e-6 * float(np.ptp(surface.X, axis=0).max())
    found = search.first_hits(places - start * normals, -normals)
    found = found[np.isfinite(found)]
    return min(depth, 0.5 * float(np.quantile(found, THIN)) if len(found) else depth)


def _edge(surface: ClosedSurface, made: Made) -> float:
    """The radius of curvature [m] than which all but the sharpest 1 % of the surface is rounder."""
    bent = _grid(made).shapes(_on_surface(surface, RAYS)[0])[:, 3]
    return 1.0 / max(float(np.quantile(bent, 1.0 - SHARP)), 1e-9)


def places_in_band(surface: ClosedSurface, count: int, band: float) -> np.ndarray:
    """Places (count, 3) [m] at random within a distance [m] of a surface, as many on each area."""
    places, normals = _on_surface(surface, count)
    return places + np.random.default_rng(1).uniform(-band, band, (len(places), 1)) * normals


def away_from_axis(search: Search, x: np.ndarray, spacing: float) -> np.ndarray:
    """Whether places (n, 3) [m] are away from the surface itself and from its medial axis.

    That is near where the directions to the surface two cells of a spacing [m] apart differ.
    """
    distance, nearest = search.nearest(x)
    direction = (x - nearest) / np.where(np.abs(distance) > 1e-12, distance, 1.0)[:, None]
    smooth = np.abs(distance) > 0.02 * spacing
    for way in 2.0 * spacing * np.vstack([np.eye(3), -np.eye(3)]):
        beside, at = search.nearest(x + way)
        other = (x + way - at) / np.where(np.abs(beside) > 1e-12, beside, 1.0)[:, None]
        smooth &= (np.einsum("ij,ij->i", direction, other) > TURNED) | (np.abs(beside) < 1e-12)
    return np.asarray(smooth)


def _errors(search: Search, surface: ClosedSurface, made: Made) -> tuple[float, float]:
    """The largest error of the grid in its band, away from the medial axis [m], and that of 99 % of the places."""
    x = places_in_band(surface, SAMPLES, float(made["band"]))
    x = x[away_from_axis(search, x, float(made["spacing"]))]
    error = np.abs(_grid(made).values(x) - search.nearest(x)[0])
    if not len(error):
        return float("nan"), float("nan")
    return float(error.max()), float(np.quantile(error, 0.99))
