"""Small meshes for the kernel tests."""

from itertools import combinations

import numpy as np
from element_case import SIDES
from scipy.spatial import Delaunay


def oriented(X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Cells with positive volume."""
    edges = X[cells[:, 1:]] - X[cells[:, :1]]
    cells = cells.astype(np.int32)
    wrong = np.linalg.det(edges) < 0
    cells[wrong, :2] = cells[wrong, 1::-1]
    return np.ascontiguousarray(cells)


def unit_box(dim: int, per_side: int, seed: int = 3) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes, cells and inner nodes of a jittered simplex mesh of the unit square or cube."""
    axes = np.linspace(0, 1, per_side + 1)
    X = np.stack(np.meshgrid(*[axes] * dim, indexing="ij"), axis=-1).reshape(-1, dim)
    inner = np.flatnonzero(np.all((X > 1e-9) & (X < 1 - 1e-9), axis=1))
    X[inner] += np.random.default_rng(seed).uniform(-0.25, 0.25, (len(inner), dim)) / per_side
    if dim == 2:
        n = per_side + 1
        corner = np.array([i * n + j for i in range(per_side) for j in range(per_side)])
        cells = np.vstack(
            [np.stack([corner, corner + n, corner + n + 1], 1), np.stack([corner, corner + n + 1, corner + 1], 1)]
        )
    else:
        cells = Delaunay(X).simplices
        volume = np.abs(np.linalg.det(X[cells[:, 1:]] - X[cells[:, :1]]))
        cells = cells[volume > 1e-12]
    return X, oriented(X, cells), inner


def second_order(X: np.ndarray, cells: np.ndarray, inner: np.ndarray, bend: float = 0.0):
    """The same with mid-side nodes; those of inner edges are moved by up to `bend`."""
    sides = SIDES[cells.shape[1]]
    ends = np.sort(np.concatenate([cells[:, s] for s in sides]), axis=1)
    edges, index = np.unique(ends, axis=0, return_inverse=True)
    middles = X[edges].mean(axis=1)
    inside = np.all((middles > 1e-9) & (middles < 1 - 1e-9), axis=1)
    middles[inside] += np.random.default_rng(5).uniform(-bend, bend, (inside.sum(), X.shape[1]))
    mid_cells = (index.reshape(len(sides), -1).T + len(X)).astype(np.int32)
    return (
        np.vstack([X, middles]),
        np.ascontiguousarray(np.hstack([cells, mid_cells])),
        np.concatenate([inner, np.flatnonzero(inside) + len(X)]),
    )


def flip_edges(X: np.ndarray, cells: np.ndarray, count: int, rng: np.random.Generator) -> np.ndarray:
    """Flips up to `count` inner edges of a triangulation in place; returns the changed cells."""
    sharing: dict[tuple[int, int], list[int]] = {}
    for c, cell in enumerate(cells):
        for a, b in combinations(sorted(cell.tolist()), 2):
            sharing.setdefault((a, b), []).append(c)
    inner = [(edge, pair) for edge, pair in sharing.items() if len(pair) == 2]
    changed: list[int] = []

    def doubled_area(a, b, c):
        u, v = X[b] - X[a], X[c] - X[a]
        return u[0] * v[1] - u[1] * v[0]

    for k in rng.permutation(len(inner)):
        (a, b), (left, right) = inner[k]
        if len(changed) >= 2 * count or left in changed or right in changed:
            continue
        c = next(v for v in cells[left] if v not in (a, b))
        d = next(v for v in cells[right] if v not in (a, b))
        if doubled_area(c, a, d) * doubled_area(d, b, c) <= 1e-12:
            continue
        for target, end in ((left, a), (right, b)):
            cells[target] = (c, end, d) if doubled_area(c, end, d) > 0 else (d, end, c)
        changed += [left, right]
    return np.array(changed, dtype=np.int32)
