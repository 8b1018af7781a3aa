"""Curves of a model that gmsh holds."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from restshape.errors import UserError
from restshape.shape.curves import bulge_through
from restshape.shape.unordered_curves import Curve
from restshape.surroundings import start_gmsh

SPLINE_POINTS = 33
"""Points that stand for a curve that is neither line nor arc."""


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
    bounding = set().union(*surfaces.values()) if surfaces else {c for _, c in model.getEntities(1)}
    regions = _regions(surfaces, names)
    loose_curves = []
    for tag in sorted(bounding):
        kind = model.getType(1, tag)
        low, high = (float(bound[0]) for bound in model.getParametrizationBounds(1, tag))
        count = {"Line": 2, "Circle": 3}.get(kind, SPLINE_POINTS)
        xyz = np.array(model.getValue(1, tag, np.linspace(low, high, count))).reshape(-1, 3)
        if np.abs(xyz[:, 2]).max() > 1e-9 * (np.ptp(xyz) or 1.0):
            raise UserError(f"curve {tag} does not lie in the plane z = 0", where, "draw in the plane")
        xy = np.ascontiguousarray(xyz[:, :2])
        label, region = names.get((1, tag), ""), regions.get(tag)
        for points, form, bulge in _pieces(kind, xy):
            loose_curves.append(Curve(points, form, label, bulge, f"curve {tag}", region))
    return loose_curves


def _pieces(kind: str, xy: np.ndarray) -> list[tuple[np.ndarray, str, float]]:
    if kind == "Line":
        return [(xy, "line", 0.0)]
    closed = np.hypot(*(xy[0] - xy[-1])) < 1e-9 * np.ptp(xy)
    if kind == "Circle" and not closed:
        return [(xy[[0, 2]], "arc", bulge_through(xy[0], xy[1], xy[2]))]
    if kind == "Circle":
        return [(xy[[0, 1]], "arc", 1.0), (xy[[1, 2]], "arc", 1.0)]
    if closed:
        half = len(xy) // 2
        return [(xy[: half + 1], "spline", 0.0), (xy[half:], "spline", 0.0)]
    return [(xy, "spline", 0.0)]


def _names(model: Any) -> dict[tuple[int, int], str]:
    """Names of Physical groups by (dimension, entity)."""
    names = {}
    for dimension, group in model.getPhysicalGroups():
        name = re.sub(r"[^A-Za-z0-9_-]+", "_", model.getPhysicalName(dimension, group))
        for tag in model.getEntitiesForPhysicalGroup(dimension, group):
            if name:
                names[dimension, int(tag)] = name
    return names


def _regions(surfaces: dict[int, set[int]], names: dict[tuple[int, int], str]) -> dict[int, str]:
    """Names of regions by curve: surfaces whose whole boundary is also a part of another surface's."""
    regions = {}
    for surface, boundary in surfaces.items():
        if any(boundary < other for tag, other in surfaces.items() if tag != surface):
            name = names.get((2, surface), f"region{surface}")
            regions.update(dict.fromkeys(boundary, name))
    return regions
