"""Ways along cloth that turn with its triangles."""

import numpy as np


def turned_with(before: np.ndarray, after: np.ndarray, ways: np.ndarray) -> np.ndarray:
    """Ways (m, 3) turned and stretched with triangles (m, 3, 3) [m], times the area of each before [m^2]."""
    return np.einsum("mab,mb->ma", _maps(before, after), ways)


def maps_of_nodes(before: np.ndarray, after: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """How the triangles (ne, 3) beside each node of n turn and stretch, as means (n, 3, 3) by their areas before [m^2].

    Args:
        before, after: (n, 3) places of the nodes [m].
        cells: triangles.
    """
    maps = np.repeat(_maps(before[cells], after[cells]).reshape(-1, 9), 3, axis=0)
    nodes, sides = cells.ravel(), before[cells[:, 1:]] - before[cells[:, :1]]
    areas = 0.5 * np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    sums = np.column_stack([np.bincount(nodes, column, len(before)) for column in maps.T])
    around = np.bincount(nodes, np.repeat(areas, 3), len(before))
    return (sums / np.where(around > 0.0, around, 1.0)[:, None]).reshape(-1, 3, 3)


def _maps(before: np.ndarray, after: np.ndarray) -> np.ndarray:
    """Maps (m, 3, 3) of triangles (m, 3, 3) to where they are, and of their normals, times their areas before."""
    (first, second), (to_first, to_second) = (np.moveaxis(p[:, 1:] - p[:, :1], 1, 0) for p in (before, after))
    cross, to_cross = np.cross(first, second), np.cross(to_first, to_second)
    size = np.linalg.norm(cross, axis=1)[:, None]
    normal = cross / size
    to_normal = to_cross / np.linalg.norm(to_cross, axis=1)[:, None]
    pairs = (to_first, np.cross(second, normal)), (to_second, np.cross(normal, first)), (to_normal, size * normal)
    return 0.5 * sum(np.einsum("ma,mb->mab", to, of) for to, of in pairs)
