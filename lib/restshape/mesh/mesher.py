"""gmsh, ready for meshing inside a chain of boundary nodes: silent, on one thread, deaf to Ctrl-C."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

import gmsh
import numpy as np

from restshape.errors import ReplayProblem
from restshape.surroundings import start_gmsh

OPTIONS = {
    "General.Terminal": 0,
    "General.Verbosity": 0,
    "General.NumThreads": 1,
    "Mesh.Algorithm": 5,
    "Mesh.Smoothing": 0,
    "Mesh.Optimize": 0,
    "Mesh.AlgorithmSwitchOnFailure": 0,
    "Mesh.MeshSizeExtendFromBoundary": 1,
    "Mesh.MeshSizeFromPoints": 0,
    "Mesh.MeshSizeFromCurvature": 0,
    "Mesh.MeshSizeMin": 0,
    "Mesh.RandomSeed": 1,
    "Mesh.ElementOrder": 1,
}
"""Delaunay refinement without smoothing, sizes from the boundary: the fastest of gmsh's that keeps angles bounded."""

TRIANGLE = 2
"""gmsh's number for first-order triangles."""


@contextmanager
def model() -> Iterator[None]:
    """An empty gmsh model, removed at the end; gmsh itself stays, for starting it costs more than a mesh."""
    start_gmsh()
    for key, value in OPTIONS.items():
        gmsh.option.setNumber(key, value)
    gmsh.model.add("restshape")
    try:
        yield
    finally:
        gmsh.model.remove()


def triangulate(
    points: np.ndarray,
    runs: Sequence[np.ndarray],
    loops: Sequence[Sequence[int]],
    embedded_runs: Sequence[int],
    embedded_points: np.ndarray,
    size: float,
    attractors: Sequence[tuple[np.ndarray, float, float]] = (),
) -> tuple[np.ndarray, np.ndarray]:
    """Nodes (n, 2) and counter-clockwise triangles (ne, 3) inside loops; the given points keep their numbers.

    Args:
        points: (nb, 2) boundary nodes and embedded points [m].
        runs: chains of boundary nodes, equally spaced; each becomes one curve of gmsh.
        loops: signed numbers, from 1, of the runs of each closed loop; the first is the outer one.
        embedded_runs: numbers, from 1, of the runs inside the surface.
        embedded_points: points inside the surface.
        size: largest size [m].
        attractors: points (m, 2), size at them, and growth of the size with the distance from them.

    Raises:
        ReplayProblem: gmsh cannot mesh this shape.
    """
    with model():
        around = [attractor[0] for attractor in attractors]
        _build_surface(np.concatenate([points, *around]), runs, loops, embedded_runs, embedded_points)
        _set_sizes(len(points), size, attractors)
        failed = ctypes.c_int()
        # The wrapper raises a bare Exception, which cannot be distinguished from an error of ours.
        gmsh.lib.gmshModelMeshGenerate(ctypes.c_int(2), ctypes.byref(failed))
        if failed.value:
            raise ReplayProblem(f"the shape cannot be meshed: {gmsh.logger.getLastError()}")
        return _read_surface(points, runs)


def _build_surface(
    points: np.ndarray,
    runs: Sequence[np.ndarray],
    loops: Sequence[Sequence[int]],
    embedded_runs: Sequence[int],
    embedded_points: np.ndarray,
) -> None:
    """Hand gmsh the curves and the surface; point i has the tag i + 1."""
    geo, mesh = gmsh.model.geo, gmsh.model.mesh
    for tag, (x, y) in enumerate(points.tolist(), start=1):
        geo.addPoint(x, y, 0.0, 0.0, tag)
    for tag, run in enumerate(runs, start=1):
        geo.addPolyline((run + 1).tolist(), tag)
    for tag, loop in enumerate(loops, start=1):
        geo.addCurveLoop(loop, tag)
    geo.addPlaneSurface(range(1, len(loops) + 1), 1)
    geo.synchronize()
    for tag, run in enumerate(runs, start=1):
        mesh.setTransfiniteCurve(tag, len(run))
    if len(embedded_runs):
        mesh.embed(1, embedded_runs, 2, 1)
    if len(embedded_points):
        mesh.embed(0, (embedded_points + 1).tolist(), 2, 1)


def _set_sizes(count: int, size: float, attractors: Sequence[tuple[np.ndarray, float, float]]) -> None:
    """Set the largest size, and one distance field for each attractor."""
    gmsh.option.setNumber("Mesh.MeshSizeMax", size)
    field = gmsh.model.mesh.field
    thresholds = []
    for points, smallest, growth in attractors:
        tags = range(count + 1, count + len(points) + 1)
        count += len(points)
        distance, threshold = field.add("Distance"), field.add("Threshold")
        field.setNumbers(distance, "PointsList", tags)
        for key, value in (
            ("InField", distance),
            ("SizeMin", smallest),
            ("SizeMax", size),
            ("DistMin", smallest),
            ("DistMax", smallest + (size - smallest) / growth),
        ):
            field.setNumber(threshold, key, value)
        thresholds.append(threshold)
    if thresholds:
        least = field.add("Min")
        field.setNumbers(least, "FieldsList", thresholds)
        field.setAsBackgroundMesh(least)


def _read_surface(points: np.ndarray, runs: Sequence[np.ndarray]) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and triangles of gmsh's mesh, its boundary nodes replaced by ours."""
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    tags, xy = tags.astype(np.int64), xyz.reshape(-1, 3)[:, :2]
    # gmsh lists the nodes by dimension and entity: points, inner nodes of each curve in order, then the surface's.
    n_points = len(gmsh.model.getEntities(0))
    inner = np.concatenate([run[1:-1] for run in runs])
    number = np.concatenate([np.arange(n_points), inner, np.arange(len(tags) - n_points - len(inner)) + len(points)])
    number[len(points) : n_points] = -1
    extent = np.ptp(points, axis=0).max()
    if len(number) != len(tags) or np.abs(xy[n_points : n_points + len(inner)] - points[inner]).max(initial=0.0) > (
        0.01 * extent
    ):
        raise ReplayProblem("the shape cannot be meshed: the mesher changed its boundary")
    X = np.empty((len(points) + len(tags) - n_points - len(inner), 2))
    X[: len(points)] = points
    X[len(points) :] = xy[n_points + len(inner) :]
    of_tag = np.full(int(tags.max()) + 1, -1, dtype=np.int32)
    of_tag[tags] = number
    _, corners = gmsh.model.mesh.getElementsByType(TRIANGLE)
    return X, of_tag[corners.astype(np.int64)].reshape(-1, 3)
