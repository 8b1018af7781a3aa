"""Faces of an extruded body that nothing touches: the stress there has no traction."""

import numpy as np

from restshape import _kernels
from restshape.errors import ReplayProblem
from restshape.fem.dirichlet import Dirichlet
from restshape.mesh.extrude import Extrusion
from restshape.mesh.reconnect import edges_between

SMOOTH = np.cos(np.radians(40.0))
"""Cosine of the angle between two sides of the outline up to which they are one curved wall."""


class FreeFaces:
    """The normals of bottom, top and walls of a body, with what of them stays while its nodes move and its edges flip.

    Args:
        space: the body; kept by reference.
        boundary: the constrained unknowns of its nodes.
    """

    def __init__(self, space: Extrusion, boundary: Dirichlet) -> None:
        self.space, plane, mesh = space, space.plane, space.mesh
        shared = np.bincount(mesh.cell_edges.ravel(), minlength=len(mesh.edge_nodes))
        self._facets = plane.facets[shared[edges_between(mesh.edge_nodes, mesh.facets)] == 1]
        starts, ends = self._facets[:, 0], self._facets[:, 1]
        # Where more than two facets meet a corner has no one normal.
        met = np.bincount(self._facets[:, :2].ravel(), minlength=len(plane.X)) == 2
        into, out_of = np.full((2, len(plane.X)), -1)
        into[ends], out_of[starts] = np.arange(len(ends)), np.arange(len(starts))
        self._corners = np.flatnonzero(met & (into >= 0) & (out_of >= 0))
        self._into, self._out_of = into[self._corners], out_of[self._corners]
        self._constrained = np.ascontiguousarray(boundary.mask, dtype=np.uint8)
        self._normals = np.zeros((3, len(plane.X), space.levels, 3))
        self._normals[2, :, [0, -1]] = _cap_normals(space)

    def remove_tractions(self, nodal: np.ndarray) -> None:
        """Takes the tractions out of stresses at the nodes of free faces: of bottom, top and walls.

        Of a stress s the part P s P stays, where P projects onto what is normal to no free face at the node. Nodes that
        supports constrain, and walls at reentrant corners, where stresses are singular, are left as they are.

        Args:
            nodal: (k, n, 6) stresses xx, yy, xy, zz, yz, xz, which are changed.
        """
        self._turn_walls()
        if self.space.thickness.varies:
            self._normals[2, :, [0, -1]] = _cap_normals(self.space)
        _kernels.remove_tractions(self._normals.reshape(3, -1, 3), self._constrained, nodal)

    def _turn_walls(self) -> None:
        """Write the normals of the walls as they lie: one on smooth walls, two at convex corners, else 0."""
        X, facets, walls = self.space.plane.X, self._facets, self._normals[:2, :, :, :2]
        along = X[facets[:, 1]] - X[facets[:, 0]]
        # The material is on the left of a facet.
        outward = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
        first, second = outward[self._into], outward[self._out_of]
        smooth = ((first * second).sum(axis=1) > SMOOTH)[:, None]
        convex = (first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > 0.0)[:, None]
        mean = first + second
        mean /= np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]
        corners = convex & ~smooth
        walls[0, self._corners] = np.where(smooth, mean, np.where(corners, first, 0.0))[:, None]
        walls[1, self._corners] = np.where(corners, second, 0.0)[:, None]
        if facets.shape[1] == 3:
            walls[0, facets[:, 2]] = outward[:, None]


def _cap_normals(space: Extrusion) -> np.ndarray:
    """Normals (2, n2, 3) of bottom and top over plane nodes; 0 where a formula of the thickness has no slope."""
    X, steps = space.plane.X, np.eye(2)
    try:
        slope = np.stack([space.thickness.rate(X, np.tile(step, (len(X), 1))) for step in steps], axis=1)
    except ReplayProblem:
        return np.zeros((2, len(X), 3))
    normals = np.ones((2, len(X), 3))
    normals[0, :, :2], normals[1, :, :2] = space.datum * slope, (space.datum - 1.0) * slope
    return normals / np.linalg.norm(normals, axis=2)[:, :, None]
