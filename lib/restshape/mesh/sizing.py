"""How long mesh edges should be: the size of a scene, smaller near entities, in bends and in narrow places."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np

from restshape import _kernels
from restshape.bounds import GROWN_TRIANGLES, GROWTH, TRIANGLES
from restshape.errors import ReplayProblem, UserError
from restshape.mesh.regions import contains, loop_polygon
from restshape.shape.outline import Outline

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

GRADING = 0.3
"""Growth of the size with the distance from where it is smaller."""

DEFAULT_CELLS = 2000
"""Triangles that a scene gets whose mesh has no size."""

CELLS_PER_SQUARE = 2.6
"""Triangles in a square of one size, as the mesher makes them."""


PER_CIRCLE = {1: 24, 2: 12}
"""Mesh edges of a circle by the order of the elements.

Chords of 24 enclose 1.1 % less than the circle; edges of second order are parabolas, and 12 of them enclose 0.016 %
less.
"""

FEWEST_PER_CIRCLE = 8
"""Mesh edges that a circle gets at least, however many curves a shape has."""

EQUILATERAL = np.sqrt(3.0) / 4.0
"""Area of a triangle whose sides are 1."""


class SizeSpec(Protocol):
    """What is asked of a scene's ``MeshSpec``."""

    @property
    def size(self) -> float | None: ...
    @property
    def near(self) -> dict[str, float]: ...
    @property
    def order(self) -> int | None: ...
    @property
    def edges_per_circle(self) -> int | None: ...


FEW = 10_000_000
"""Pairs of points up to which all distances between them take less time than a search tree and its import."""


@dataclass(frozen=True)
class Attractor:
    """Points (m, 2) around which the size is `size` [m]."""

    points: np.ndarray
    size: float

    def distances(self, points: np.ndarray) -> np.ndarray:
        """Distances (m,) of points (m, 2) from the nearest of its points [m]."""
        if len(points) * len(self.points) <= FEW:
            return _kernels.distances(points, self.points, self.points)
        found: np.ndarray = self._tree.query(points)[0]
        return found

    @functools.cached_property
    def _tree(self) -> cKDTree:
        """Search tree of the points."""
        from scipy.spatial import cKDTree

        return cKDTree(self.points)


@dataclass(frozen=True)
class Sizing:
    """Mesh size of a shape [m], and where it is smaller.

    Args:
        size: [m], away from all else.
        attractors: where it is smaller.
        per_circle: mesh edges that a whole circle gets at least; bends get their share of them.
        per_circle_fixed: it holds however many triangles that makes.
    """

    size: float
    attractors: tuple[Attractor, ...]
    per_circle: int = PER_CIRCLE[1]
    per_circle_fixed: bool = False

    def at(self, points: np.ndarray) -> np.ndarray:
        """Size (m,) wanted at points (m, 2)."""
        wanted = np.full(len(points), self.size)
        for attractor in self.attractors:
            distance = attractor.distances(points)
            # The attractor's points stand at most one size apart.
            np.minimum(wanted, attractor.size + GRADING * np.maximum(distance - attractor.size, 0.0), out=wanted)
        return wanted


def refuse_endless(outline: Outline, size: float, near: dict[str, float]) -> None:
    """Makes sure, before any meshing, that the mesh stays within `bounds.TRIANGLES`.

    Args:
        outline: the shape.
        size: length of mesh edges [m].
        near: smaller sizes [m] on entities, from which the size grows by GRADING.

    Raises:
        UserError: naming the key, with the estimate.
    """
    count, where, length, least = expected_triangles(outline, size, near)
    if count > TRIANGLES:
        raise UserError(
            f"a size of {length:.3g} m would make about {count:.2g} triangles; at most {TRIANGLES:.2g} are taken",
            where,
            f"a larger size, {float(f'{1.05 * least:.2g}'):g} m at least",
        )


def refuse_growth(outline: Outline, spec: SizeSpec, before: int) -> None:
    """Makes sure that an edit of a shape does not ask for a mesh many times as large: a coordinate slips easily.

    Args:
        outline: the shape.
        spec: the scene's ``MeshSpec``.
        before: triangles of the mesh before the edit.

    Raises:
        ReplayProblem: it does.
    """
    if spec.size is None:
        return
    count = expected_triangles(outline, spec.size, {})[0]
    if count > max(GROWN_TRIANGLES, GROWTH * before):
        what = f"this shape would have about {count:.2g} triangles of size {spec.size:.3g} m"
        raise ReplayProblem(f"{what}, more than {GROWTH:g} times the {before} before the edit: check its units")


def expected_triangles(outline: Outline, size: float, near: dict[str, float]) -> tuple[float, str, float, float]:
    """About how many triangles a mesh has, the key that asks for most of them, its size, and the least one [m].

    Args as of `refuse_endless`; at the least size there are `bounds.TRIANGLES`.
    """
    # Sizes may be so small that their squares vanish.
    area = float(outline.area() / EQUILATERAL)
    expected = {"mesh.size": (area / size / size, size, math.sqrt(abs(area) / TRIANGLES))}
    for name, length in near.items():
        along = sum(outline.length(edge) for edge in outline.entity(name).edges)
        # The sum over both sides of dr / (h + GRADING r)^2, h being the size on the entity.
        wide = float(2.0 * along / (EQUILATERAL * GRADING))
        expected[f"mesh.near.{name}"] = wide / length, length, wide / TRIANGLES
    where = max(expected, key=lambda key: expected[key][0])
    count, length, least = expected[where]
    return count, where, length, least


def sizing_of(outline: Outline, spec: SizeSpec) -> Sizing:
    """The sizing that a scene's ``[mesh]`` asks for.

    Without a size there are about 2,000 triangles; a size of `near` that is larger has no effect.

    Args:
        outline: the shape.
        spec: the scene's ``MeshSpec``.

    Raises:
        UserError: an entity of `near` is not there, or a size is not a positive length.
    """
    size, near = spec.size, spec.near
    if size is None:
        size = float(np.sqrt(outline.area() * CELLS_PER_SQUARE / DEFAULT_CELLS))
    if 0.0 < size < np.inf:
        refuse_endless(outline, size, {name: h for name, h in near.items() if 0.0 < h < size})
    attractors = []
    for name, length in near.items():
        if not 0.0 < length < np.inf:
            raise UserError(f"{length} is no mesh size", f"mesh.near.{name}", "give a positive length")
        if length < size:
            attractors.append(Attractor(_points_of(outline, name, length), length))
    if not 0.0 < size < np.inf:
        raise UserError(f"{size} is no mesh size", "mesh.size", "give a positive length")
    per_circle = spec.edges_per_circle
    return Sizing(size, tuple(attractors), per_circle or PER_CIRCLE[spec.order or 1], per_circle is not None)


def _points_of(outline: Outline, name: str, spacing: float) -> np.ndarray:
    """Points on an entity, and inside it if it is a region, no farther apart than `spacing`."""
    entity = outline.entity(name)
    parts = [outline.points[list(entity.vertices)]]
    for edge in entity.edges:
        count = int(np.ceil(1.5 * outline.length(edge) / spacing)) + 1
        parts.append(outline.point(edge, np.linspace(0.0, 1.0, count + 1)))
    for i in entity.loops:
        if outline.loops[i].kind == "region":
            polygon = loop_polygon(outline, outline.loops[i])
            low, high = polygon.min(axis=0), polygon.max(axis=0)
            grid = np.meshgrid(*(np.arange(a, b, spacing) for a, b in zip(low, high)))
            inner = np.stack([axis.ravel() for axis in grid], axis=1)
            parts.append(inner[contains(polygon, inner)])
    return np.concatenate(parts)
