"""Cameras that look at places in space, and where in their pictures these are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

Window = tuple[float, float, float, float]
"""Left, right, bottom and top of a picture, as `Camera.project` has them [m]."""


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

    @classmethod
    def above(cls) -> Camera:
        """A camera that sees x and y as they are."""
        return cls(np.zeros(3), np.eye(3))

    def project(self, places: np.ndarray) -> np.ndarray:
        """Where places (n, 3) before the camera are in the picture (n, 2) [m, as long as at the centre]."""
        seen = (places - self.center) @ self.axes.T
        return seen[:, :2] / (1.0 - seen[:, 2] / self.distance)[:, None]

    def window(self, low: np.ndarray, high: np.ndarray) -> Window:
        """The least window that holds a box with these corners (3,) [m]."""
        corners = np.stack(np.meshgrid(*zip(low, high)), axis=-1).reshape(-1, 3)
        (left, bottom), (right, top) = (pick(self.project(corners), axis=0) for pick in (np.min, np.max))
        return float(left), float(right), float(bottom), float(top)
