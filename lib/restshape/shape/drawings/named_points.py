"""Points of drawings that name vertices of a shape, or lie inside of its material."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence

import numpy as np

from restshape.arrays import Reals
from restshape.shape import curves
from restshape.shape.drawings.gaps import JOIN
from restshape.shape.drawings.loose_curve import Curve
from restshape.shape.nearness import distances

APART = 1e-3
"""A point inside is at least this share of the size of the shape away from its curves."""
PIECES = np.linspace(0.0, 1.0, 65)
"""Parameters of the straight pieces that a curve counts as where a point is inside or near."""


def vertex_names(
    points: Mapping[str, Reals], corners: Sequence[Reals] | Reals, size: float, taken: Collection[str]
) -> dict[int, str]:
    """Names of corners at which a point lies, by their places.

    Args:
        points: (2,) by name [m]; corners: (2,) each [m]; size: of the drawing [m].
        taken: names that stand for something else.
    """
    found: dict[int, str] = {}
    for name, point in points.items():
        distances = np.hypot(*(np.asarray(corners) - point).T)
        near = int(distances.argmin())
        if distances[near] < JOIN * size and near not in found and name not in taken:
            found[near] = name
    return found


def points_inside(
    points: Mapping[str, Reals], border: Sequence[Curve], others: Sequence[Curve], size: float
) -> dict[str, list[float]]:
    """Coordinates of the points that lie inside of the material, by name.

    Args:
        points: (2,) by name [m]; border: curves of the outline and of holes, closed together.
        others: curves in the material; size: of the drawing [m].
    """
    if not points:
        return {}
    chains = [chain_of_curve(curve) for curve in (*border, *others)]
    a, b = (np.concatenate([chain[part] for chain in chains]) for part in (slice(-1), slice(1, None)))
    around = sum(len(chain) - 1 for chain in chains[: len(border)])
    found = {}
    for name, point in points.items():
        crosses = (a[:around, 1] > point[1]) != (b[:around, 1] > point[1])
        (ax, ay), (bx, by) = a[:around][crosses].T, b[:around][crosses].T
        inside = np.count_nonzero(point[0] < ax + (point[1] - ay) / (by - ay) * (bx - ax)) % 2
        if inside and distances(point[None], a, b)[0] > APART * size:
            found[name] = [float(point[0]), float(point[1])]
    return found


def chain_of_curve(curve: Curve) -> Reals:
    """Points (m, 2) of a curve whose straight connections stand for it."""
    if curve.kind == "spline":
        knots = curve.knots or curves.chord_parameters(curve.points)
        return curves.spline_weights(tuple(knots), curve.ends, np.union1d(PIECES, knots)) @ curve.points
    if curve.kind != "arc":
        return curve.points
    (ax, ay), (bx, by) = curve.points[0], curve.points[-1]
    share = curves.arc_fraction(curve.bulge, PIECES)
    places = complex(ax, ay) * (1.0 - share) + complex(bx, by) * share
    return np.stack([places.real, places.imag], axis=1)
