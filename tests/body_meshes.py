"""Closed triangle meshes of known bodies, and files of them."""

from pathlib import Path

import meshio
import numpy as np

Surface = tuple[np.ndarray, np.ndarray]


def ball(pieces: int, radius: float = 1.0) -> Surface:
    """A ball of 20 pieces^2 triangles, whose corners (n, 3) are on the sphere."""
    from scipy.spatial import ConvexHull

    g = 0.5 * (1.0 + np.sqrt(5.0))
    X = np.array([[s * a for a, s in zip(p, (1, u, v))] for p in [(0, 1, g)] for u in (1, -1) for v in (1, -1)])
    X = np.vstack([np.roll(X, k, axis=1) for k in range(3)])
    places = []
    for a, b, c in ConvexHull(X).simplices:
        i, j = (part.ravel() for part in np.mgrid[: pieces + 1, : pieces + 1])
        i, j = i[i + j <= pieces], j[i + j <= pieces]
        places.append((np.outer(i, X[a]) + np.outer(j, X[b]) + np.outer(pieces - i - j, X[c])) / pieces)
    found = np.vstack(places)
    found = found / np.linalg.norm(found, axis=1)[:, None]
    _, first = np.unique(np.round(found, 9), axis=0, return_index=True)
    return outwards(radius * found[first])


def outwards(X: np.ndarray) -> Surface:
    """The triangles of a convex body with corners (n, 3), which look outwards."""
    from scipy.spatial import ConvexHull

    hull = ConvexHull(X)
    cells = hull.simplices.copy()
    a, b, c = (X[cells[:, k]] for k in range(3))
    wrong = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    cells[wrong] = cells[wrong, ::-1]
    return X, cells


def torus(around: int, across: int, large: float, small: float) -> Surface:
    """A ring about z: the corners of two triangles each of around x across pieces."""
    i, j = (part.ravel() for part in np.mgrid[:around, :across])
    u, v = 2.0 * np.pi * i / around, 2.0 * np.pi * j / across
    out = large + small * np.cos(v)
    X = np.column_stack([out * np.cos(u), out * np.sin(u), small * np.sin(v)])
    at = [((i + a) % around) * across + (j + b) % across for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    return X, np.vstack([np.column_stack([at[0], at[1], at[2]]), np.column_stack([at[0], at[2], at[3]])])


def box(half: tuple[float, float, float]) -> Surface:
    """A box of 12 triangles."""
    X = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) * half
    return outwards(X)


def write(path: Path, surface: Surface) -> Path:
    """A file of triangles."""
    X, cells = surface
    meshio.write(path, meshio.Mesh(X, [("triangle", cells)]))
    return path
