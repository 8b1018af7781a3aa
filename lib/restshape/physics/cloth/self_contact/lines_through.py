"""Where lines meet triangles, found by a tree of balls around these."""

from __future__ import annotations

import numpy as np

ROUNDING = 1e-9
"""Part of a triangle's side beyond it that is still on it."""
BRANCHES = 8
"""Balls within each ball of the tree."""
CELLS = 1024
"""Places along each axis of the box around all triangles by which they are put near each other."""


def lines_through(
    start: np.ndarray, ways: np.ndarray, corners: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Which lines meet which triangles, and how far from their starts.

    Args:
        start, ways: (n, 3) places [m] and unit vectors of lines; corners: (ne, 3, 3) of triangles [m].

    Returns: lines (k,), triangles (k,), and ways (k,) [m], negative against the vectors.

    Source: Möller and Trumbore, Journal of Graphics Tools 2(1), 1997, 21.
    """
    line, cell = _near(start, ways, corners)
    a, b, c = corners[cell].swapaxes(0, 1)
    u, v, way, off = b - a, c - a, ways[line], start[line] - a
    normal = np.cross(way, v)
    volume = np.einsum("ka,ka->k", u, normal)
    longest = np.maximum(np.einsum("ka,ka->k", u, u), np.einsum("ka,ka->k", v, v))
    flat = np.abs(volume) <= ROUNDING * longest
    scale = np.where(flat, np.inf, volume)
    turned = np.cross(off, u)
    s = np.einsum("ka,ka->k", off, normal) / scale
    t = np.einsum("ka,ka->k", way, turned) / scale
    hit = ~flat & (np.minimum.reduce([s, t, 1.0 - s - t]) >= -ROUNDING)
    return line[hit], cell[hit], (np.einsum("ka,ka->k", v, turned) / scale)[hit]


def _near(start: np.ndarray, ways: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lines (k,) and triangles (k,) of which the lines pass the balls around the triangles; see `lines_through`."""
    if not len(start) or not len(corners):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    middle = corners.mean(axis=1)
    along = _along_a_curve(middle)
    middle = middle[along]
    reach = np.linalg.norm(corners[along] - middle[:, None], axis=2).max(axis=1)
    levels = [(middle, reach)]
    while len(levels[-1][1]) > 1:
        levels.append(_around(*levels[-1]))
    line, ball = np.arange(len(start)), np.zeros(len(start), np.int64)
    for depth, (middle, reach) in enumerate(reversed(levels)):
        if depth:
            line, ball = np.repeat(line, BRANCHES), (ball[:, None] * BRANCHES + np.arange(BRANCHES)).ravel()
            line, ball = line[ball < len(reach)], ball[ball < len(reach)]
        off = middle[ball] - start[line]
        far = np.einsum("ka,ka->k", off, off) - np.einsum("ka,ka->k", off, ways[line]) ** 2
        near = far <= reach[ball] ** 2 * (1.0 + ROUNDING)
        line, ball = line[near], ball[near]
    return line, along[ball]


def _around(middle: np.ndarray, reach: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Middles (m, 3) and radii (m,) [m] of balls around each `BRANCHES` of balls (k, 3), (k,) in a row."""
    first = np.arange(0, len(reach), BRANCHES)
    number = np.minimum(len(reach), first + BRANCHES) - first
    found = np.add.reduceat(middle, first) / number[:, None]
    own = np.linalg.norm(middle - np.repeat(found, number, axis=0), axis=1) + reach
    return found, np.maximum.reduceat(own, first)


def _along_a_curve(middle: np.ndarray) -> np.ndarray:
    """Numbers (k,) of places (k, 3) in an order in which near ones are near in space.

    Source: Morton, A computer oriented geodetic data base, IBM, 1966.
    """
    low, size = middle.min(axis=0), float(np.ptp(middle, axis=0).max())
    at = np.minimum((middle - low) * (CELLS / (size or 1.0)), CELLS - 1).astype(np.int64)
    code = np.zeros(len(middle), np.int64)
    for bit in range(CELLS.bit_length() - 1):
        for axis in range(3):
            code |= (at[:, axis] >> bit & 1) << (3 * bit + axis)
    return np.argsort(code, kind="stable")
