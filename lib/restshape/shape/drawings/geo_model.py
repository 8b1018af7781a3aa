"""Curves of a model that gmsh holds."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.shape.curves import bulge_through
from restshape.shape.drawings.bsplines import cubic_between
from restshape.shape.drawings.fitted_spline import SMOOTH, fitted_spline
from restshape.shape.drawings.loose_curve import Curve
from restshape.surroundings import start_gmsh

NEARLY_FLAT = 1e-6
"""Distance from the plane z = 0, over the size of a curve; gmsh's boxes are larger than what they hold by 1e-7."""
Points = Callable[[Reals], Reals]
"""Gives points (n, 2) of a curve by its parameters (n,)."""


@contextmanager
def gmsh_model(path: Path) -> Iterator[ModuleType]:
    """The gmsh package, quiet, with an empty model that is removed at the end."""
    gmsh = start_gmsh()
    quiet = gmsh.option.getNumber("General.Terminal")
    gmsh.model.add(f"restshape: {path.name}")
    gmsh.option.setNumber("General.Terminal", 0)
    try:
        yield gmsh
    finally:
        gmsh.option.setNumber("General.Terminal", quiet)
        gmsh.model.remove()


def opened_by_gmsh(gmsh: ModuleType, path: Path) -> list[Curve]:
    """The curves of a script that gmsh runs, whatever it says.

    Raises:
        UserError: gmsh cannot read it, or it does not lie in the plane.
    """
    try:
        gmsh.merge(str(path))
    # gmsh reports every failure as a bare Exception, so nothing narrower can be caught.
    except Exception as error:
        raise UserError(f"gmsh cannot read it: {error}", path.name, "try it with gmsh itself") from error
    return curves_of(gmsh.model, path.name)


def curves_of(model: Any, where: str) -> list[Curve]:
    """The curves of a model of gmsh's that bound its surfaces, or all where there is none.

    Raises:
        UserError: it does not lie in the plane, or has none.
    """
    names = _names(model)
    surfaces = {s: {abs(c) for _, c in model.getBoundary([(2, s)], oriented=False)} for _, s in model.getEntities(2)}
    bounding = surfaces or {0: {c for _, c in model.getEntities(1)}}
    for tag in sorted(set().union(*bounding.values())):
        box = np.reshape(model.getBoundingBox(1, tag), (2, 3))
        if np.abs(box[:, 2]).max() > NEARLY_FLAT * (np.ptp(box) or 1.0):
            raise UserError(f"curve {tag} does not lie in the plane z = 0", where, "draw in the plane")
    return curves_between(model, bounding, lambda xyz: xyz[:, :2].copy(), names, surface_regions(surfaces, names))


def curves_between(
    model: Any,
    faces: dict[int, set[int]],
    place: Callable[[Reals], Reals],
    names: dict[tuple[int, int], str],
    regions: dict[int, str],
    knots: Mapping[int, Sequence[tuple[float, ...]]] | None = None,
) -> list[Curve]:
    """Curves of a model of gmsh's as loose curves in the plane.

    Args:
        model: of gmsh.
        faces: the curves that bound each.
        place: gives coordinates (n, 2) in the plane of points (n, 3).
        names: by (dimension, entity); regions: names of the regions that curves bound.
        knots: that curves may have which may be cubic B-splines.

    Raises:
        UserError: a curve bends too much.
    """
    loose_curves = []
    for tag in sorted(set().union(*faces.values())):

        def points(u: Reals, tag: int = tag) -> Reals:
            return place(np.array(model.getValue(1, tag, u)).reshape(-1, 3))

        low, high = (float(bound[0]) for bound in model.getParametrizationBounds(1, tag))
        label, region = names.get((1, tag), ""), regions.get(tag)
        for piece in _pieces(model.getType(1, tag), points, low, high, tag, (knots or {}).get(tag, ())):
            loose_curves.append(replace(piece, label=label, source=f"curve {tag}", region=region))
    return loose_curves


def _pieces(
    kind: str, points: Points, low: float, high: float, tag: int, knots: Sequence[tuple[float, ...]]
) -> list[Curve]:
    """The edges that a curve of a model becomes, without names: splines of what is neither line, arc nor cubic."""
    ends = points(np.array([low, 0.5 * (low + high), high]))
    if kind == "Line":
        return [Curve(ends[[0, 2]], "line")]
    closed = np.hypot(*(ends[0] - ends[2])) < 1e-9 * np.ptp(ends)
    if kind == "Circle" and not closed:
        return [Curve(ends[[0, 2]], "arc", bulge=bulge_through(ends[0], ends[1], ends[2]))]
    if kind == "Circle":
        return [Curve(ends[[0, 1]], "arc", bulge=1.0), Curve(ends[[1, 2]], "arc", bulge=1.0)]
    for known in knots:
        if exact := cubic_between(points, low, high, known):
            return [Curve(own, "spline", knots=inner, ends=conditions) for own, inner, conditions in exact]
    parts = [(low, 0.5 * (low + high)), (0.5 * (low + high), high)] if closed else [(low, high)]
    found = [fitted_spline(points, *part, f"curve {tag}") for part in parts]
    return [Curve(own, "spline", knots=knots, ends=SMOOTH) for own, knots in found]


def _names(model: Any) -> dict[tuple[int, int], str]:
    """Names of Physical groups by (dimension, entity)."""
    names = {}
    for dimension, group in model.getPhysicalGroups():
        name = re.sub(r"[^A-Za-z0-9_-]+", "_", model.getPhysicalName(dimension, group))
        for tag in model.getEntitiesForPhysicalGroup(dimension, group):
            if name:
                names[dimension, int(tag)] = name
    return names


def surface_regions(surfaces: dict[int, set[int]], names: dict[tuple[int, int], str]) -> dict[int, str]:
    """Names of regions by curve: surfaces whose whole boundary is also a part of another surface's."""
    regions = {}
    for surface, boundary in surfaces.items():
        if any(boundary < other for tag, other in surfaces.items() if tag != surface):
            name = names.get((2, surface), f"region{surface}")
            regions.update(dict.fromkeys(boundary, name))
    return regions
