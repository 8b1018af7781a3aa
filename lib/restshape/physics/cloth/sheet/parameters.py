"""Parameters of cloth: what the elements of membranes, bending and contact take."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

UPPER = ((0, 0, 1, 0, 1, 2), (0, 1, 1, 2, 2, 2))
"""Rows and columns of 11 12 22 16 26 66 in a matrix of xx, yy, xy."""

HINGE_STIFFNESS = {"plate": 1.0 / 3.0, "strip": 3.0 / 8.0}
"""Stiffness of `hinge_flap4` that acts on equilateral triangles as 1 of a plate, or of a strip with free sides."""


def triangle_areas(X: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Areas (ne,) [m^2] of triangles with corners (ne, 3) at X (n, 2) [m]."""
    a, b, c = corners.T
    (ax, ay), (bx, by), (cx, cy) = ((X[:, 0][nodes], X[:, 1][nodes]) for nodes in (a, b, c))
    return 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))


def triangle_rates(X: np.ndarray, corners: np.ndarray, dX: np.ndarray) -> np.ndarray:
    """Rates (ne,) of the areas of triangles when nodes at X (n, 2) [m] move with dX (n, 2)."""
    (ax, ay), (bx, by), (cx, cy) = ((X[:, 0][nodes], X[:, 1][nodes]) for nodes in corners.T)
    (dax, day), (dbx, dby), (dcx, dcy) = ((dX[:, 0][nodes], dX[:, 1][nodes]) for nodes in corners.T)
    ux, uy, vx, vy = bx - ax, by - ay, cx - ax, cy - ay
    dux, duy, dvx, dvy = dbx - dax, dby - day, dcx - dax, dcy - day
    return 0.5 * (dux * vy + ux * dvy - duy * vx - uy * dvx)


def lumped(X: np.ndarray, corners: np.ndarray, density: float | np.ndarray = 1.0) -> np.ndarray:
    """Masses (n,) [kg] of nodes, a third of their triangles', or by default the areas [m^2] that they stand for.

    Args:
        X: (n, 2) rest positions [m].
        corners: (ne, 3) nodes of triangles.
        density: mass by area [kg/m^2], one or (ne,).
    """
    return shared(triangle_areas(X, corners), corners, len(X), density)


def shared(areas: np.ndarray, corners: np.ndarray, n: int, density: float | np.ndarray = 1.0) -> np.ndarray:
    """The same (n,) from the areas (ne,) [m^2] of the triangles."""
    share = density * (2.0 * areas) / 6.0
    return np.bincount(corners.ravel(), np.repeat(share, 3), minlength=n)


def lumped_rates(corners: np.ndarray, triangles: np.ndarray, n: int) -> np.ndarray:
    """Rates (n,) of the areas that nodes stand for, from those (ne,) of triangles with corners (ne, 3)."""
    return np.bincount(corners.ravel(), np.repeat(2.0 * triangles / 6.0, 3), minlength=n)


@dataclass(frozen=True, eq=False)
class Lumped:
    """What the nodes of cloth stand for.

    Args:
        area: (n,) [m^2]; density: (ne,) mass by area [kg/m^2] of the triangles; mass: (n,) [kg], 0 for slopes.
        load: norm of the weight at free unknowns [N].
    """

    area: np.ndarray
    density: np.ndarray
    mass: np.ndarray
    load: float

    @classmethod
    def of(cls, X: np.ndarray, corners: np.ndarray, density: np.ndarray, g: np.ndarray) -> Lumped:
        """What nodes at X (n, 2) [m] stand for; g (n, 3) [m/s^2] is the acceleration of each, 0 where prescribed."""
        areas = triangle_areas(X, corners)
        mass = shared(areas, corners, len(X), density)
        return cls(shared(areas, corners, len(X)), density, mass, float(np.linalg.norm(mass[:, None] * g)))
