"""How the outline and the thickness of a bar go with each of its freedoms, and how much of a change that is."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from restshape_apps.metallophone.tuning.bar import Bar
from restshape_apps.metallophone.tuning.freedoms import Freedom, point_of, with_values

from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.mesh.relocate import BoundaryNodes, motion
from restshape.mesh.thickness import Thickness
from restshape.physics.elasticity.vibrating_materials import common_thickness
from restshape.scene.model import Scene
from restshape.shape.build import unchecked_outline
from restshape.shape.outline import Outline

STEP = 1e-4
"""Of the differences of outline and thickness, a share of the number or, at 0, of the size of the shape."""


@dataclass(frozen=True, eq=False)
class Motions:
    """What a unit of each freedom moves.

    Args:
        plane: (k, n, 2) velocities of the nodes of the plane mesh; thickness: (k, n) [m] changes of it there.
        metric: (k, k) [m^4] areas of the surface times squares of its displacement: sides and one face.
        sides: area of the sides [m^2].
        reach: (k,) largest displacement of the outline; thinning: (k,) largest change of the thickness over itself.
        outline_metric: the part of the metric that the sides have.
    """

    plane: np.ndarray
    thickness: np.ndarray
    metric: np.ndarray
    sides: float
    face: float
    reach: np.ndarray
    thinning: np.ndarray
    outline_metric: np.ndarray

    def moved(self, change: np.ndarray) -> float:
        """Root mean square [m] of the displacement of the outline by a change (k,)."""
        return float(np.sqrt(max(change @ self.outline_metric @ change, 0.0) / self.sides))

    def thickened(self, change: np.ndarray) -> float:
        """Root mean square [m] of the change of the thickness."""
        metric = self.metric - self.outline_metric
        return float(np.sqrt(max(change @ metric @ change, 0.0) / self.face))


def motions_of(bar: Bar, values: np.ndarray) -> Motions:
    """What the freedoms of a bar move at values (k,) that it has been solved with.

    Raises:
        UserError: a freedom bends an edge otherwise than by its points, or changes what is no shape.
    """
    mesh, space = bar.moving.mesh, bar.moving.field_mesh
    plane, thickness = np.zeros((len(values), *space.X.shape)), np.zeros((len(values), len(space.X)))
    corners = np.zeros((len(values), *mesh.X.shape))
    boundary = BoundaryNodes(mesh)
    for k in range(len(values)):
        points, thicker = _rates(bar, values, k)
        thickness[k] = thicker
        if np.any(points):
            basis = np.stack([points, np.zeros_like(points)])
            both = motion(mesh, boundary.basis(mesh.outline, basis), "harmonic", boundary.nodes)
            corners[k], plane[k] = both[0], space.motion(both, basis)[0]
    return _measured(mesh, space, plane, thickness, corners, _thickness(bar.now))


def _rates(bar: Bar, values: np.ndarray, k: int) -> tuple[np.ndarray, np.ndarray]:
    """Rates of the control points (c, 2), and of the thickness (n,) at the nodes of the plane mesh, by a freedom."""
    freedom = bar.freedoms[k]
    if point := point_of(bar.outline, freedom.key):
        moved = np.zeros_like(bar.outline.points)
        moved[point] = 1.0
        return moved, np.zeros(len(bar.moving.field_mesh.X))
    step = STEP * (abs(values[k]) or bar.outline.size)
    ends = []
    for sign in (1.0, -1.0):
        aside = values.copy()
        aside[k] += sign * step
        ends.append(with_values(bar.scene, bar.freedoms, aside))
    outlines = [unchecked_outline(one.shape, one.folder) for one in ends]
    _refuse(freedom, bar, ends, outlines)
    thicker = [_thickness(one).at(bar.moving.field_mesh.X) for one in ends]
    return (
        (outlines[0].points - outlines[1].points) / (2.0 * step),
        (thicker[0] - thicker[1]) / (2.0 * step),
    )


def _refuse(freedom: Freedom, bar: Bar, ends: list[Scene], outlines) -> None:
    if any(len(one.points) != len(bar.outline.points) or _bends(bar.outline, one) for one in outlines):
        what = f"{freedom.name} changes how edges bend, or how many there are"
        raise UserError(what, "--by", "name points of the shape, which bend splines and move arcs")
    for one in ends:
        for name, material in one.material.items():
            if material.model_copy(update={"thickness": None}) != bar.scene.material[name].model_copy(
                update={"thickness": None}
            ):
                raise UserError(f"{freedom.name} changes the material, which no tool does", "--by", "leave it out")


def _bends(outline: Outline, other: Outline) -> bool:
    """Whether arcs or splines bend otherwise; knots of polylines say where their points lie, and bend nothing."""
    pairs = zip(outline.edges, other.edges)
    knots = any(one.kind == "spline" and one.knots != there.knots for one, there in pairs)
    return knots or not np.array_equal(outline.bulges, other.bulges)


def _thickness(scene: Scene) -> Thickness:
    return Thickness(common_thickness(scene), scene.parameters)


def _measured(mesh: Mesh, space, plane, thickness, corners, now: Thickness) -> Motions:
    cells, X = mesh.cells, mesh.X
    a, b = X[cells[:, 1]] - X[cells[:, 0]], X[cells[:, 2]] - X[cells[:, 0]]
    areas = 0.5 * np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    facets = mesh.facets[_outer(mesh)]
    lengths = np.linalg.norm(X[facets[:, 1]] - X[facets[:, 0]], axis=1)
    heights = now.at(0.5 * (X[facets[:, 0]] + X[facets[:, 1]]))
    weights = lengths * heights
    count = len(plane)
    # Simpson's rule is exact on facets along which velocities are linear.
    ends = [corners[:, facets[:, i]] for i in (0, 1)]
    middle = 0.5 * (ends[0] + ends[1])
    outline = (
        sum(
            share * np.einsum("f,ifd,jfd->ij", weights, one, one)
            for share, one in zip((1 / 6, 1 / 6, 4 / 6), (*ends, middle))
        )
        if count
        else np.zeros((0, 0))
    )
    on_cells = thickness[:, space.cells].mean(axis=2)
    face = np.einsum("c,ic,jc->ij", areas, on_cells, on_cells)
    known = now.at(space.X)
    reach = np.linalg.norm(corners[:, np.unique(facets)], axis=2).max(axis=1)
    thinning = np.abs(thickness / known).max(axis=1)
    return Motions(plane, thickness, outline + face, float(weights.sum()), float(areas.sum()), reach, thinning, outline)


def _outer(mesh: Mesh) -> np.ndarray:
    """Which facets (nf,) have material on one side alone."""
    outer = np.zeros(len(mesh.outline.edges), dtype=bool)
    for loop in mesh.outline.loops:
        if loop.kind != "region":
            outer[[edge for edge, _ in loop.edges]] = True
    return outer[mesh.facet_edge]
