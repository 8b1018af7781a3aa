"""Closed surfaces of known bodies as OBJ files, and scenes that lie on them in place of closed forms."""

from pathlib import Path

import numpy as np
from scipy.spatial import ConvexHull


def obj_of(X: np.ndarray) -> str:
    """The convex body of corners (n, 3) [m] as an OBJ file; its triangles look outwards."""
    hull = ConvexHull(X)
    cells = hull.simplices.copy()
    a, b, c = (X[cells[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    cells[inwards] = cells[inwards, ::-1]
    return _written(X, cells)


def slab(x: float, y: float, z: float) -> str:
    """A box of half sizes x and y [m] below the plane z = 0, z thick [m]."""
    return obj_of(np.array([[i * x, j * y, k * z] for i in (-1, 1) for j in (-1, 1) for k in (-1, 0)]))


def bar(radius: float, half: float, pieces: int) -> str:
    """A cylinder about y of a radius [m] and half a length [m], whose corners are on the round one."""
    angle = 2.0 * np.pi * np.arange(pieces) / pieces
    round_ = radius * np.column_stack([np.cos(angle), np.zeros(pieces), np.sin(angle)])
    return obj_of(np.vstack([round_ + np.array([0.0, side * half, 0.0]) for side in (-1, 1)]))


def ball(radius: float, pieces: int) -> str:
    """A ball of a radius [m] of about 20 pieces^2 triangles, whose corners are on the sphere, evenly spread."""
    count = 10 * pieces**2 + 2
    k = np.arange(count) + 0.5
    z, turn = 1.0 - 2.0 * k / count, np.pi * (1.0 + np.sqrt(5.0)) * k
    out = np.sqrt(1.0 - z * z)
    return obj_of(radius * np.column_stack([out * np.cos(turn), out * np.sin(turn), z]))


def with_body(scene: Path, form: str, mesh: str, obj: str, folder: Path) -> Path:
    """A scene whose body of a form, written so, is a mesh instead, in a folder that gets both files.

    Args:
        scene: of the application; form: its line.
        mesh: what is in place of it, of the file body.obj.
        obj: of that file.
        folder: where both are written.
    """
    text = scene.read_text()
    if form not in text:
        raise ValueError(f"{scene} has no {form}")
    (folder / "body.obj").write_text(obj)
    (folder / scene.name).write_text(text.replace(form, f'mesh = {{ file = "body.obj", unit = "m", {mesh} }}'))
    return folder / scene.name


def joined(first: str, second: str, way: tuple[float, float, float]) -> str:
    """Two OBJ files of triangles as one; the second is moved by (3,) [m]."""
    (X, cells), (Y, others) = _read(first), _read(second)
    return _written(np.vstack([X, Y + np.array(way)]), np.vstack([cells, others + len(X)]))


def without_top(obj: str, width: float) -> str:
    """An OBJ file without triangles whose middle is nearer to the axis z than a width [m], on its upper half."""
    X, cells = _read(obj)
    middle = X[cells].mean(axis=1)
    return _written(X, cells[(np.hypot(middle[:, 0], middle[:, 1]) > width) | (middle[:, 2] < 0.0)])


def _read(obj: str) -> tuple[np.ndarray, np.ndarray]:
    rows = [line.split() for line in obj.splitlines()]
    X = np.array([row[1:] for row in rows if row and row[0] == "v"], dtype=float)
    return X, np.array([row[1:] for row in rows if row and row[0] == "f"], dtype=int) - 1


def _written(X: np.ndarray, cells: np.ndarray) -> str:
    rows = [f"v {x:.9f} {y:.9f} {z:.9f}" for x, y, z in X]
    return "\n".join([*rows, *(f"f {a} {b} {c}" for a, b, c in cells + 1), ""])
