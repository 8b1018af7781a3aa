"""Triangles in space as seen by a camera, pixel by pixel: what hides what is exact, and the same on every machine."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

FINER = 2
"""Pixels that are reckoned for each one shown, along both axes."""
CLOSEST = 0.9
"""Part of the way from the centre to the camera up to which there is anything to see."""


@dataclass(frozen=True)
class Camera:
    """How places become a picture.

    Args:
        center: (3,) what it looks at [m].
        axes: (3, 3) its unit vectors as rows: to the right, up, and towards the camera.
        distance: from the centre [m]; infinite for parallel rays.
    """

    center: np.ndarray
    axes: np.ndarray
    distance: float = np.inf

    @classmethod
    def towards(cls, center: np.ndarray, azimuth: float, elevation: float, distance: float = np.inf) -> Camera:
        """A camera that looks at the centre [m] from an azimuth about z and an elevation over the horizon [rad]."""
        c, s = np.cos(azimuth), np.sin(azimuth)
        back = np.array([c * np.cos(elevation), s * np.cos(elevation), np.sin(elevation)])
        right = np.array([-s, c, 0.0])
        return cls(np.asarray(center, dtype=float), np.stack([right, np.cross(back, right), back]), distance)

    def project(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where places (n, 3) are in the picture (n, 2) [m, as long as at the centre], and how near (n,) [m].

        Nearness grows towards the camera and is linear across the picture of a flat face.
        """
        seen = (places - self.center) @ self.axes.T
        shrink = 1.0 / np.maximum(1.0 - seen[:, 2] / self.distance, 1.0 - CLOSEST)
        near = seen[:, 2] * shrink if np.isfinite(self.distance) else seen[:, 2]
        return seen[:, :2] * shrink[:, None], near

    def faces(self, places: np.ndarray) -> np.ndarray:
        """Whether places (n, 3) lie before the camera, and not too close to it."""
        return (places - self.center) @ self.axes[2] < CLOSEST * self.distance


@dataclass(frozen=True)
class Hits:
    """What is nearest in each pixel.

    Args:
        triangle: (rows, columns) int32 triangle seen there, -1: none; the first row is the lowest.
        weights: (rows, columns, 3) shares of its corners.
        near: (rows, columns) how near it is [m]; -inf where there is none.
        heights: (m, 3) distances of the corners of each triangle from its opposite sides [pixels].
    """

    triangle: np.ndarray
    weights: np.ndarray
    near: np.ndarray
    heights: np.ndarray

    @property
    def there(self) -> np.ndarray:
        """Whether there is a triangle in each pixel."""
        return self.triangle >= 0


def hits(
    camera: Camera,
    places: np.ndarray,
    triangles: np.ndarray,
    window: tuple[float, float, float, float],
    columns: int,
    box: tuple[np.ndarray, np.ndarray] | None = None,
) -> Hits:
    """What of a surface is nearest in each pixel of a picture.

    Args:
        camera: looks at it.
        places: (n, 3) [m].
        triangles: (m, 3) corners.
        window: left, right, bottom, top of the picture, as `Camera.project` has them [m].
        columns: pixels across; pixels are square.
        box: two corners (3,) [m]; what lies outside of it is cut off.
    """
    left, right, bottom, top = window
    scale = columns / (right - left)
    rows = max(1, round((top - bottom) * scale))
    flat, near = camera.project(places)
    corners = ((flat - (left, bottom)) * scale)[triangles]
    before = camera.faces(places)[triangles].all(axis=1)
    doubled = _cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    pixel, owner = _candidates(corners, before & (np.abs(doubled) > 1e-9), rows, columns)
    middle = np.column_stack([pixel % columns, pixel // columns]) + 0.5
    weights = _weights(corners, doubled, owner, middle)
    inside = (weights >= 0.0).all(axis=1)
    if box:
        x = np.einsum("pk,pkc->pc", weights[inside], places[triangles][owner[inside]])
        inside[inside] = ((x >= box[0]) & (x <= box[1])).all(axis=1)
    pixel, owner, weights = pixel[inside], owner[inside], weights[inside]
    depth = (weights * near[triangles][owner]).sum(axis=1)
    # Of several values for one pixel the last one stays: the nearest.
    order = np.argsort(depth, kind="stable")
    found = Hits(
        np.full(rows * columns, -1, dtype=np.int32),
        np.zeros((rows * columns, 3)),
        np.full(rows * columns, -np.inf),
        _heights(corners, doubled),
    )
    found.triangle[pixel[order]] = owner[order]
    found.weights[pixel[order]] = weights[order]
    found.near[pixel[order]] = depth[order]
    shape = (rows, columns)
    return Hits(
        found.triangle.reshape(shape), found.weights.reshape(*shape, 3), found.near.reshape(shape), found.heights
    )


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _candidates(corners: np.ndarray, seen: np.ndarray, rows: int, columns: int) -> tuple[np.ndarray, np.ndarray]:
    """The pixels within the bounds of each triangle that is seen, and the triangles that they belong to."""
    low = np.clip(np.floor(corners.min(axis=1)), 0, (columns, rows)).astype(np.int64)
    high = np.clip(np.ceil(corners.max(axis=1)), 0, (columns, rows)).astype(np.int64)
    size = (high - low) * seen[:, None]
    counts = size.prod(axis=1)
    owner = np.repeat(np.arange(len(corners)), counts)
    place = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    width = size[owner, 0]
    x, y = low[owner, 0] + place % width, low[owner, 1] + place // width
    return y * columns + x, owner


def _weights(corners: np.ndarray, doubled: np.ndarray, owner: np.ndarray, middle: np.ndarray) -> np.ndarray:
    """Barycentric coordinates (k, 3) of pixels in their triangles."""
    a, b, c = (corners[owner, i] for i in range(3))
    parts = (_cross(c - b, middle - b), _cross(a - c, middle - c), _cross(b - a, middle - a))
    return np.stack(parts, axis=1) / doubled[owner, None]


def _heights(corners: np.ndarray, doubled: np.ndarray) -> np.ndarray:
    sides = np.stack([corners[:, (i + 2) % 3] - corners[:, (i + 1) % 3] for i in range(3)], axis=1)
    return np.abs(doubled)[:, None] / np.maximum(np.linalg.norm(sides, axis=2), 1e-12)
