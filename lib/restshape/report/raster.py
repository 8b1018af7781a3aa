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


def nearest_faces(
    camera: Camera,
    places: np.ndarray,
    faces: np.ndarray,
    window: tuple[float, float, float, float],
    columns: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Which of some flat convex faces is nearest in each pixel, and how near: for few and large ones, one by one.

    Args:
        camera: looks at them.
        places: (n, 3) [m].
        faces: (m, k) corners, in order around each.
        window: left, right, bottom, top of the picture, as `Camera.project` has them [m].
        columns: pixels across; pixels are square.

    Returns:
        (rows, columns) int32 face seen there, -1: none; and (rows, columns) nearness [m], -inf where there is none. The
        first row is the lowest.
    """
    left, right, bottom, top = window
    scale = columns / (right - left)
    rows = max(1, round((top - bottom) * scale))
    flat, near = camera.project(places)
    flat = (flat - (left, bottom)) * scale
    face = np.full((rows, columns), -1, dtype=np.int32)
    nearest = np.full((rows, columns), -np.inf)
    for k in np.flatnonzero(camera.faces(places)[faces].all(axis=1)):
        corners = flat[faces[k]]
        low = np.clip(np.floor(corners.min(axis=0)), 0, (columns, rows)).astype(int)
        high = np.clip(np.ceil(corners.max(axis=0)), 0, (columns, rows)).astype(int)
        x, y = (np.arange(low[i], high[i]) + 0.5 for i in (0, 1))
        first, last = _spans(corners, y)
        # Nearness is linear across the picture of a flat face.
        plane = np.linalg.lstsq(np.column_stack([corners, np.ones(len(corners))]), near[faces[k]], rcond=None)[0]
        depth = plane[0] * x + (plane[1] * y + plane[2])[:, None]
        part = (slice(low[1], high[1]), slice(low[0], high[0]))
        seen = (x >= first[:, None]) & (x <= last[:, None]) & (depth > nearest[part])
        face[part][seen] = k
        nearest[part][seen] = depth[seen]
    return face, nearest


def _spans(corners: np.ndarray, y: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where a convex face with corners (k, 2) begins and ends across each of the rows y (n,); nowhere: empty spans."""
    sides = np.roll(corners, -1, axis=0) - corners
    turn = _cross(corners, np.roll(corners, -1, axis=0)).sum()
    first, last = np.full(len(y), -np.inf), np.full(len(y), np.inf)
    if abs(turn) < 1e-9:
        return last, first
    for corner, side in zip(corners, np.sign(turn) * sides):
        above = y - corner[1]
        if side[1] == 0.0:
            first[side[0] * above < 0.0] = np.inf
        elif side[1] > 0.0:
            last = np.minimum(last, corner[0] + above * side[0] / side[1])
        else:
            first = np.maximum(first, corner[0] + above * side[0] / side[1])
    return first, last


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
