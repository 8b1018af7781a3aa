"""Which region of an outline a triangle lies in."""

from __future__ import annotations

import numpy as np

from restshape.mesh.hinges import inner_sides
from restshape.shape.outline import Loop, Outline


def contains(polygon: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Whether each point (m, 2) lies inside a polygon (k, 2), by the parity of crossings."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    x, y = points[:, 0][:, None], points[:, 1][:, None]
    crosses = (a[:, 1] > y) != (b[:, 1] > y)
    rise = np.where(b[:, 1] == a[:, 1], 1.0, b[:, 1] - a[:, 1])
    at = a[:, 0] + (y - a[:, 1]) / rise * (b[:, 0] - a[:, 0])
    return (np.count_nonzero(crosses & (x < at), axis=1) % 2).astype(bool)


def signed_area(polygon: np.ndarray) -> float:
    """Area of a polygon (k, 2), positive counter-clockwise [m^2]."""
    x, y = (polygon - polygon[0]).T
    return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))


def loop_polygon(outline: Outline, loop: Loop) -> np.ndarray:
    """Corners (k, 2) of a loop's straight pieces, in the direction of the loop."""
    parts = []
    for edge, forward in loop.edges:
        chain = outline.polyline(edge)
        parts.append((chain if forward else chain[::-1])[:-1])
    return np.concatenate(parts)


def cell_regions(
    X: np.ndarray, cells: np.ndarray, cell_edges: np.ndarray, barrier: np.ndarray, polygons: list[np.ndarray]
) -> np.ndarray:
    """Number (ne,) of the innermost region of each triangle, from 1; 0 outside all regions.

    Args:
        X: (n, 2) nodes [m]; cells: (ne, 3); cell_edges: (ne, 3) mesh edge opposite to each corner.
        barrier: (n_edges,) whether a mesh edge lies on an edge of the outline.
        polygons: corners (k, 2) of each region's chain of mesh edges.
    """
    if not polygons:
        return np.zeros(len(cells), dtype=np.int32)
    patch = cell_patches(cell_edges, barrier)
    _, one_of = np.unique(patch, return_index=True)
    inside = X[cells[one_of]].mean(axis=1)
    number = np.zeros(len(one_of), dtype=np.int32)
    # From the largest to the smallest: the innermost region has the last word.
    areas = [abs(signed_area(polygon)) for polygon in polygons]
    for i in sorted(range(len(polygons)), key=lambda i: -areas[i]):
        number[contains(polygons[i], inside)] = i + 1
    return number[patch]


def cell_patches(cell_edges: np.ndarray, barrier: np.ndarray) -> np.ndarray:
    """Numbers (ne,), from 0, of the connected patches of triangles that mesh edges part.

    Args:
        cell_edges: (ne, 3) mesh edge opposite to each corner.
        barrier: (n_edges,) whether a mesh edge parts them.
    """
    # Late, as scipy is all over: it takes longer to import than the first frame of a plain scene.
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    pairs = inner_sides(cell_edges)
    left, right = pairs[~barrier[cell_edges.ravel()[pairs[:, 0]]]].T // 3
    links = coo_array((np.ones(len(left), dtype=bool), (left, right)), shape=(len(cell_edges), len(cell_edges)))
    patch: np.ndarray = connected_components(links, directed=False)[1]
    return patch
