"""Where the nodes of cloth are in its material, and where the cloth is when they go elsewhere in it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import MorleySpace


@dataclass(frozen=True, eq=False)
class MaterialPlace:
    """Nodes in the material at one time, while the mesh goes on.

    Args:
        X: (n, 2) material coordinates [m] of corners and, of Morley's triangles, edges.
        normals: (edges, 2) [m] along which edges have slopes; None where they have none.
    """

    X: np.ndarray
    normals: np.ndarray | None

    @classmethod
    def of(cls, mesh: Mesh, morley: MorleySpace | None) -> MaterialPlace:
        """Where the nodes are now."""
        return cls(morley.X.copy(), morley.normals()) if morley else cls(mesh.X.copy(), None)


class AdvectedCloth:
    """Cloth at unknowns x (n, 3) with its nodes at one place, to be taken to others along the cloth.

    Positions are right to first order in the way of the material, slopes but for curvatures times it; all is where the
    cloth is flat.

    Args:
        place: of the nodes at x.
        cells: (ne, 3) corners of triangles.
        nodes: (ne, k) all nodes of triangles.
        x: (n, 3) unknowns.
    """

    def __init__(self, place: MaterialPlace, cells: np.ndarray, nodes: np.ndarray, x: np.ndarray) -> None:
        self.place, self.x = place, x
        self.gradients = _gradients(place.X, cells, nodes, x)

    def unknowns_at(self, place: MaterialPlace, sides: np.ndarray | None) -> np.ndarray:
        """Unknowns (n, 3) with the nodes at another place; `sides` are the nodes of edges, None: there are none."""
        way = place.X - self.place.X
        if sides is not None:
            # An edge's unknown is a derivative along its normal, which has changed.
            way[sides] = place.normals - self.place.normals
        return self.x + np.einsum("iak,ik->ia", self.gradients, way) if way.any() else self.x.copy()

    def corners_at(self, X: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """Positions (corners, 3) of corners at X (corners, 2) with these node numbers (corners,); flips or not."""
        way = X - self.place.X[numbers]
        return self.x[numbers] + np.einsum("iak,ik->ia", self.gradients[numbers], way)


def _gradients(X: np.ndarray, cells: np.ndarray, nodes: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Derivatives (n, 3, 2) of the positions at the nodes: means over their triangles, by area."""
    legs = np.stack([X[cells[:, 1]] - X[cells[:, 0]], X[cells[:, 2]] - X[cells[:, 0]]], axis=1)
    rises = np.stack([x[cells[:, 1]] - x[cells[:, 0]], x[cells[:, 2]] - x[cells[:, 0]]], axis=1)
    F = np.linalg.solve(legs, rises).swapaxes(1, 2)
    owner, n, size = nodes.T.ravel(), len(X), np.linalg.det(legs)
    weights = np.bincount(owner, np.tile(size, nodes.shape[1]), n)
    weighted = np.tile((F * size[:, None, None]).reshape(-1, 6).T, nodes.shape[1])
    sums = np.column_stack([np.bincount(owner, values, n) for values in weighted]).reshape(n, 3, 2)
    return sums / weights[:, None, None]
