"""Bodies as triangles to draw."""

from __future__ import annotations

import numpy as np

from restshape.physics.cloth.initial_placement import rotation
from restshape.scene.bodies import Body, Box, Capsule, Plane, Sphere

PIECES = 12
"""Pieces of a quarter turn, and of what is straight between two of them."""

Surface = tuple[np.ndarray, np.ndarray]
"""Places (n, 3) [m] and triangles (m, 3)."""


def body_surface(body: Body, low: np.ndarray, high: np.ndarray) -> Surface:
    """The surface of a body as triangles; of a plane what lies within a box.

    Args:
        body: of numbers.
        low, high: (3,) corners of the box [m].
    """
    form = body.form
    match form:
        case Sphere():
            return _rounded(np.zeros(3), form.radius, np.eye(3), np.array(form.center))
        case Capsule():
            start, end = np.array(form.start), np.array(form.end)
            length = float(np.linalg.norm(end - start))
            turn = _frame((end - start) / length) if length else np.eye(3)
            return _rounded(np.array([0.0, 0.0, 0.5 * length]), form.radius, turn, 0.5 * (start + end))
        case Box():
            return _rounded(
                np.array(form.half) - form.radius, form.radius, rotation(form.rotate), np.array(form.center)
            )
        case _:
            return _within(form, low, high)


def _rounded(core: np.ndarray, radius: float, turn: np.ndarray, center: np.ndarray) -> Surface:
    """All within a radius of a box of half sizes (3,), turned and moved; the box may be a line or a point."""
    rim = np.linspace(0.0, 1.0, PIECES + 1) * radius
    lines = [np.concatenate([-rim[::-1] - size, np.linspace(-size, size, PIECES)[1:-1], rim + size]) for size in core]
    places, triangles, start = [], [], 0
    for axis in range(3):
        for side in (-1.0, 1.0):
            u, v = (axis + 1) % 3, (axis + 2) % 3
            flat = np.empty((len(lines[u]) * len(lines[v]), 3))
            grid_u, grid_v = np.meshgrid(lines[u], lines[v])
            flat[:, u], flat[:, v], flat[:, axis] = grid_u.ravel(), grid_v.ravel(), side * (core[axis] + radius)
            near = np.clip(flat, -core, core)
            away = flat - near
            size = np.linalg.norm(away, axis=1, keepdims=True)
            places.append(near + radius * away / np.where(size > 0.0, size, 1.0))
            triangles.append(start + _grid(len(lines[v]), len(lines[u]), side > 0))
            start += len(flat)
    return np.vstack(places) @ turn.T + center, np.vstack(triangles)


def _grid(rows: int, columns: int, outwards: bool) -> np.ndarray:
    """Triangles of a grid of rows times columns of places."""
    a = (np.arange(rows - 1)[:, None] * columns + np.arange(columns - 1)).ravel()
    b, c, d = a + 1, a + columns + 1, a + columns
    found = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return found if outwards else found[:, ::-1]


def _frame(axis: np.ndarray) -> np.ndarray:
    """A rotation (3, 3) that takes z to a unit vector."""
    other = np.eye(3)[np.abs(axis).argmin()]
    first = np.cross(other, axis)
    first /= np.linalg.norm(first)
    return np.column_stack([first, np.cross(axis, first), axis])


def _within(plane: Plane, low: np.ndarray, high: np.ndarray) -> Surface:
    """The polygon that a box cuts out of a plane, as a fan; nothing where they do not meet."""
    normal = np.array(plane.normal) / np.linalg.norm(plane.normal)
    turn, size = _frame(normal), 2.0 * float(np.linalg.norm(high - low))
    middle = 0.5 * (low + high)
    middle = middle - normal * (normal @ (middle - plane.point))
    polygon = middle + size * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]]) @ turn[:, :2].T
    for axis in range(3):
        for side, bound in ((1.0, high[axis]), (-1.0, low[axis])):
            polygon = _cut(polygon, side * (bound - polygon[:, axis]))
    count = len(polygon)
    fan = np.column_stack([np.zeros(max(count - 2, 0)), np.arange(1, count - 1), np.arange(2, count)])
    return polygon, fan.astype(np.int64)


def _cut(polygon: np.ndarray, depth: np.ndarray) -> np.ndarray:
    """The part of a convex polygon (n, 3) where a linear depth (n,) is not negative."""
    kept = []
    for a, b, da, db in zip(polygon, np.roll(polygon, -1, axis=0), depth, np.roll(depth, -1)):
        if da >= 0.0:
            kept.append(a)
        if da * db < 0.0:
            kept.append(a + (b - a) * da / (da - db))
    return np.array(kept).reshape(-1, 3)
