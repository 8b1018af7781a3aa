"""Faces of an extruded body that nothing touches: the stress there has no traction."""

import numpy as np

from restshape import _kernels
from restshape.errors import ReplayProblem
from restshape.fem.dirichlet import Dirichlet
from restshape.mesh.extrude import Extrusion
from restshape.mesh.reconnect import edges_between

SMOOTH = np.cos(np.radians(40.0))
"""Cosine of the angle between two sides of the outline up to which they are one curved wall."""


def remove_tractions(nodal: np.ndarray, space: Extrusion, boundary: Dirichlet) -> None:
    """Takes the tractions out of stresses at the nodes of free faces: of bottom, top and walls.

    Of a stress s the part P s P stays, where P projects onto what is normal to no free face at the node. Nodes that
    supports constrain, and walls at reentrant corners, where stresses are singular, are left as they are.

    Args:
        nodal: (k, n, 6) stresses xx, yy, xy, zz, yz, xz, which are changed.
        space: the body.
        boundary: the constrained unknowns of its nodes.
    """
    normals = np.zeros((3, len(space.plane.X), space.levels, 3))
    walls, caps = _wall_normals(space), _cap_normals(space)
    normals[:2, :, :, :2] = walls[:, :, None, :]
    normals[2, :, [0, -1]] = caps
    constrained = np.ascontiguousarray(boundary.mask, dtype=np.uint8)
    _kernels.remove_tractions(normals.reshape(3, -1, 3), constrained, nodal)


def _wall_normals(space: Extrusion) -> np.ndarray:
    """Normals (2, n2, 2) of the walls at plane nodes: one on smooth walls, two at convex corners, else 0."""
    plane, mesh = space.plane, space.mesh
    shared = np.bincount(mesh.cell_edges.ravel(), minlength=len(mesh.edge_nodes))
    facets = plane.facets[shared[edges_between(mesh.edge_nodes, mesh.facets)] == 1]
    along = plane.X[facets[:, 1]] - plane.X[facets[:, 0]]
    # The material is on the left of a facet.
    outward = np.column_stack([along[:, 1], -along[:, 0]]) / np.linalg.norm(along, axis=1)[:, None]
    normals = np.zeros((2, len(plane.X), 2))
    normals[0, facets[:, 1]], normals[1, facets[:, 0]] = outward, outward
    first, second = normals
    cosine = np.einsum("na,na->n", first, second)
    convex = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] > 0.0
    smooth, met = cosine > SMOOTH, np.bincount(facets[:, :2].ravel(), minlength=len(plane.X)) == 2
    mean = first + second
    mean /= np.maximum(np.linalg.norm(mean, axis=1), 1e-300)[:, None]
    found = np.where((met & convex & ~smooth)[:, None], normals, 0.0)
    found[0, met & smooth] = mean[met & smooth]
    if facets.shape[1] == 3:
        found[0, facets[:, 2]] = outward
    return found


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
