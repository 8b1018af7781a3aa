"""Delaunay refinement by CGAL: the fast mesher of plane shapes."""

from __future__ import annotations

import itertools

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.mesh.boundary import Boundary
from restshape.mesh.sizing import CELLS_PER_SQUARE, GRADING, Sizing
from restshape.shape.outline import Outline

STRETCH = 1.4
"""Longest edge of a triangle over the size there. Refinement leaves edges between half the bound and the bound: with
this the mean edge has the size, and hardly any boundary edge, as long as the size, has to be split."""

SINE_BOUND = 0.125
"""Square of the sine of the smallest angle: 20.7 degrees, the largest for which refinement is known to end."""

SHORT = 0.9
"""Boundary edges below this share of the size wanted there make the mesh finer around them."""

PATIENCE = 60
"""Triangles judged for each one expected before refinement counts as endless; it takes about 8."""


def uses_cgal(mesher: str) -> bool:
    """Whether CGAL makes the meshes: where it is built, unless gmsh is asked for.

    Args:
        mesher: the scene's `mesh.mesher`: "auto", "cgal" or "gmsh".

    Raises:
        UserError: CGAL is asked for and not built.
    """
    if mesher == "cgal" and not _kernels.has_cgal:
        raise UserError(
            "this restshape is built without CGAL", "mesh.mesher", 'install libcgal-dev and build again, or use "auto"'
        )
    return mesher != "gmsh" and _kernels.has_cgal


def refine(
    outline: Outline,
    boundary: Boundary,
    segments: np.ndarray,
    segment_edge: np.ndarray,
    border: np.ndarray,
    sizing: Sizing,
) -> tuple[Boundary, np.ndarray, np.ndarray] | None:
    """The boundary with the nodes that were added to it, all nodes (n, 2) and triangles (ne, 3); None if CGAL fails.

    Args:
        outline: the shape; boundary: its nodes.
        segments: (m, 2) directed pairs of boundary nodes, material on the left of the border.
        segment_edge: (m,) outline edge of each; border: (m,) whether it bounds the material.
        sizing: the size wanted in the material.
    """
    sources = _sources(boundary.points, segments, sizing)
    expected = CELLS_PER_SQUARE * outline.area() / sizing.size**2 + 50.0 * (len(segments) + len(sources)) + 1000.0
    try:
        X, cells, split, fraction = _kernels.refine_delaunay(
            boundary.points, segments, border, sizing.size, GRADING, sources, STRETCH, SINE_BOUND,
            int(PATIENCE * expected),
        )  # fmt: skip
    except _kernels.MesherFailure:
        return None
    if len(split):
        boundary = _with_splits(outline, boundary, segments[split], segment_edge[split], fraction)
        X[: len(boundary.points)] = boundary.points
        if _kernels.check_cells(X, cells, 0.0, 0.0)[1]:
            return None
    return boundary, X, cells


def _sources(points: np.ndarray, segments: np.ndarray, sizing: Sizing) -> np.ndarray:
    """Rows (k, 4) of place, size and reach [m]: attractors, and boundary nodes between short edges."""
    a, b = segments.T
    lengths = np.sqrt(np.sum((points[a] - points[b]) ** 2, axis=1))
    count = np.bincount(a, minlength=len(points)) + np.bincount(b, minlength=len(points))
    total = np.bincount(a, lengths, len(points)) + np.bincount(b, lengths, len(points))
    # Embedded points have no edges, and stand for no size.
    spacing = np.where(count, total / np.maximum(count, 1), sizing.size)
    wanted = sizing.at(points) if sizing.attractors else sizing.size
    short = (spacing < SHORT * wanted).nonzero()[0]
    rows = [np.column_stack([points[short], spacing[short], np.zeros(len(short))])]
    for attractor in sizing.attractors:
        size = np.full(len(attractor.points), attractor.size)
        rows.append(np.column_stack([attractor.points, size, size]))
    return np.concatenate(rows)


def _with_splits(
    outline: Outline, boundary: Boundary, pairs: np.ndarray, edges: np.ndarray, fraction: np.ndarray
) -> Boundary:
    """The boundary with nodes added at fractions (k,) of the way along pairs (k, 2) of its nodes, on the curves."""
    chains = list(boundary.chains)
    added = np.empty((len(pairs), 2))
    s = np.empty(len(pairs))
    for edge in np.unique(edges).tolist():
        chain = boundary.chains[edge]
        own = np.concatenate([[0.0], boundary.param[chain[1:-1]], [1.0]])
        rows, known = (edges == edge).nonzero()[0], chain.tolist()
        for row in rows.tolist():
            at, t = _place(known, pairs[row].tolist(), fraction[row])
            s[row] = own[at] + t * (own[at + 1] - own[at])
        added[rows] = outline.point(edge, s[rows])
        nodes = np.concatenate([chain, rows + len(boundary.points)])
        chains[edge] = nodes[np.argsort(np.concatenate([own, s[rows]]), kind="stable")].astype(np.int32)
    return Boundary(
        np.concatenate([boundary.points, added]),
        np.concatenate([boundary.edge, edges.astype(np.int32)]),
        np.concatenate([boundary.param, s]),
        tuple(chains),
    )


def _place(chain: list[int], pair: list[int], fraction: float) -> tuple[int, float]:
    """Where in a chain a pair of neighbours stands, and the fraction in the chain's direction."""
    neighbours = list(itertools.pairwise(chain))
    first, second = pair
    if (first, second) in neighbours:
        return neighbours.index((first, second)), fraction
    return neighbours.index((second, first)), 1.0 - fraction
