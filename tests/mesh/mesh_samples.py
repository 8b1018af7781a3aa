"""Meshes for the tests of the mesh package, made without the mesh generator."""

import itertools

import numpy as np
from scipy.spatial import Delaunay

from restshape.mesh.mesh import Mesh
from restshape.scene.model import ShapeSpec
from restshape.shape.build import outline_from_spec
from restshape.shape.outline import Outline

L_SHAPE = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]]
SQUARE = [[0, 0], [1, 0], [1, 1], [0, 1]]


def polygon_outline(corners, holes=None, regions=None, points=None) -> Outline:
    """Straight edges e0, e1, ... between corners v0, v1, ..., with polygonal holes and regions and embedded points."""
    n = len(corners)
    spec = {
        "vertices": {f"v{i}": list(map(float, corner)) for i, corner in enumerate(corners)},
        "edges": {f"e{i}": {"line": [f"v{i}", f"v{(i + 1) % n}"]} for i in range(n)},
        "outline": [f"e{i}" for i in range(n)],
        "holes": {name: {"polygon": polygon} for name, polygon in (holes or {}).items()},
        "regions": {name: {"polygon": polygon} for name, polygon in (regions or {}).items()},
        "points": points or {},
    }
    return outline_from_spec(ShapeSpec.model_validate(spec))


def mesh_of(outline: Outline, X: np.ndarray, cells: np.ndarray) -> Mesh:
    """A mesh of an outline of straight edges from points and triangles, its ties found by distance."""
    X = np.asarray(X, dtype=float)
    facets, facet_edge = [], []
    node_edge, node_param = np.full(len(X), -1), np.zeros(len(X))
    sides = {(int(c[i]), int(c[(i + 1) % 3])) for c in cells for i in range(3)}
    for e, edge in enumerate(outline.edges):
        a, b = outline.points[edge.start], outline.points[edge.end]
        along = (X - a) @ (b - a) / ((b - a) @ (b - a))
        away = np.linalg.norm(X - (a + along[:, None] * (b - a)), axis=1)
        on = np.flatnonzero((away < 1e-9) & (along > -1e-9) & (along < 1 + 1e-9))
        on = on[np.argsort(along[on])]
        node_edge[on], node_param[on] = e, np.clip(along[on], 0, 1)
        forward = next(way for loop in outline.loops for number, way in loop.edges if number == e)
        for i, j in itertools.pairwise(on):
            pair = (int(i), int(j)) if forward else (int(j), int(i))
            assert pair in sides, "the triangles do not follow the outline"
            facets.append(pair)
            facet_edge.append(e)
    nearest = [np.linalg.norm(X - p, axis=1).argmin() for p in outline.points[: len(outline.vertex_names)]]
    return Mesh.build(
        X, cells, outline, facets=np.array(facets), facet_edge=np.array(facet_edge),
        node_edge=node_edge, node_param=node_param, vertex_node=np.array(nearest),
    )  # fmt: skip


def grid(columns: int, rows: int, width: float, height: float, keep=lambda x, y: True) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles of a rectangle cut into squares with diagonals; `keep` picks squares by their centre."""
    x, y = np.linspace(0, width, columns + 1), np.linspace(0, height, rows + 1)
    X = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    cells = []
    for j in range(rows):
        for i in range(columns):
            if keep((x[i] + x[i + 1]) / 2, (y[j] + y[j + 1]) / 2):
                a = j * (columns + 1) + i
                b, c, d = a + 1, a + columns + 2, a + columns + 1
                cells += [(a, b, c), (a, c, d)] if (i + j) % 2 else [(a, b, d), (b, c, d)]
    cells = np.array(cells)
    used, cells = np.unique(cells, return_inverse=True)
    return X[used], cells.reshape(-1, 3)


def l_mesh(n: int = 8) -> Mesh:
    """An L of two by two, its inner points shaken."""
    X, cells = grid(2 * n, 2 * n, 2.0, 2.0, lambda x, y: x < 1 or y < 1)
    mesh = mesh_of(polygon_outline(L_SHAPE), X, cells)
    return shaken(mesh, 0.2 / n)


def holed_mesh(n: int = 4) -> Mesh:
    """A plate of 2 x 1 with a square hole from (0.5, 0.25) to (1, 0.75) and a region at its right end."""
    X, cells = grid(8 * n, 4 * n, 2.0, 1.0, lambda x, y: not (0.5 < x < 1.0 and 0.25 < y < 0.75))
    outline = polygon_outline(
        [[0, 0], [2, 0], [2, 1], [0, 1]],
        holes={"window": [[0.5, 0.25], [1, 0.25], [1, 0.75], [0.5, 0.75]]},
        regions={"patch": [[1.25, 0.25], [1.75, 0.25], [1.75, 0.75], [1.25, 0.75]]},
        points={"probe": [0.25, 0.5]},
    )
    return shaken(mesh_of(outline, X, cells), 0.05 / n)


def shaken(mesh: Mesh, size: float, seed: int = 1) -> Mesh:
    """The mesh with its free nodes displaced at random by at most `size` in each direction."""
    free = mesh.node_edge < 0
    free[mesh.vertex_node] = False
    mesh.X[free] += np.random.default_rng(seed).uniform(-size, size, (int(free.sum()), 2))
    return mesh


def random_square(points: np.ndarray) -> Mesh:
    """Delaunay triangles of the unit square with points inside and eight on its sides."""
    side = np.linspace(0, 1, 3)
    border = [[s, t] for s in side for t in side if s in (0, 1) or t in (0, 1)]
    X = np.array([*border, *points])
    cells = Delaunay(X).simplices
    a, b, c = X[cells[:, 0]], X[cells[:, 1]], X[cells[:, 2]]
    turned = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0] < 0
    cells[turned] = cells[turned][:, ::-1]
    return mesh_of(polygon_outline(SQUARE), X, cells)


def qualities(X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Inscribed radius over longest edge (ne,), 1 for an equilateral triangle; negative where inverted."""
    return 2 * np.sqrt(3) / author_ratios(X, cells)


def author_ratios(X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Longest edge x half perimeter / area (ne,), 2 sqrt(3) for an equilateral triangle; negative where inverted."""
    corners = X[cells]
    sides = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    u, v = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    with np.errstate(divide="ignore"):
        return sides.max(axis=1) * sides.sum(axis=1) / (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
