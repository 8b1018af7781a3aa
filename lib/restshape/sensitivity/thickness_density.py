"""The derivative of a frequency by the thickness at each place, as a density: where to rasp underneath."""

from dataclasses import dataclass

import numpy as np

from restshape.sensitivity.frequency_derivative import SolvedModes, nodal_gradient


@dataclass(frozen=True)
class ThicknessDensity:
    """What the thickness does to a frequency, place by place.

    Args:
        gradient: (n,) [Hz/m] by the thickness at each node of the mesh of corners, linear between them.
        area: (n,) [m^2] a third of the triangles around each node.
        density: (n,) [Hz/m^3]: f changes by the integral of it over the plane times the change of the thickness.
    """

    gradient: np.ndarray
    area: np.ndarray
    density: np.ndarray


def thickness_gradient(analysis: SolvedModes, mode: int, by_nodes: np.ndarray | None = None) -> np.ndarray:
    """The gradient (n,) [Hz/m] of a frequency by the thickness at the corners of the plane mesh.

    A plate's third coordinate is its thickness; of a solid the lower face moves, and the nodes above share the way.

    Args:
        analysis: solved on the mesh as it lies.
        mode: index among the modes; its eigenvalue stands alone.
        by_nodes: (n, d) its `nodal_gradient`, where that is known.

    Raises:
        UserError: the body is a plane one.
    """
    body, plane = analysis.state.body, analysis.state.space
    scale = 1.0 / (4.0 * np.pi * np.sqrt(analysis.state.modes.values[mode]))
    thicker = body.thickness_motion(np.ones(len(plane.X)))
    gradient = nodal_gradient(analysis, mode) if by_nodes is None else by_nodes
    pulled = scale * (thicker * gradient).sum(axis=1)
    return plane.on_corners(body.by_plane_nodes(pulled).reshape(len(plane.X), -1).sum(axis=1)[:, None])[:, 0]


def thickness_density(analysis: SolvedModes, mode: int, by_nodes: np.ndarray | None = None) -> ThicknessDensity:
    """The density of a frequency's derivative by the thickness; arguments as in `thickness_gradient`.

    Raises:
        UserError: the body is a plane one.

    Source: docs/theory/free-vibrations.md.
    """
    mesh = analysis.state.space.mesh
    gradient, area = thickness_gradient(analysis, mode, by_nodes), nodal_areas(mesh.X, mesh.cells)
    return ThicknessDensity(gradient, area, gradient / area)


def nodal_areas(X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """A third (n,) of the areas of the triangles (ne, 3) around each of the nodes X (n, 2)."""
    a, b = X[cells[:, 1]] - X[cells[:, 0]], X[cells[:, 2]] - X[cells[:, 0]]
    thirds = np.repeat((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 6.0, 3)
    return np.bincount(cells.ravel(), thirds, len(X))
