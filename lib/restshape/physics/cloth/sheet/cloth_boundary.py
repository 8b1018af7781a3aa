"""Where cloth is supported, as Dirichlet conditions: positions of corners, and slopes across edges."""

from dataclasses import dataclass, field

import numpy as np

from restshape.fem.dirichlet import Dirichlet
from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import SIDES, MorleySpace


@dataclass(frozen=True)
class ClothSupports:
    """What supports prescribe on one mesh.

    Args:
        mask: (corners, 3) true where a position is prescribed.
        places: (corners, 3) the prescribed positions [m].
        clamped: mesh edges (k,) across which the slope stays; slopes: (k, 3) the derivative of the positions along the
            outward normal of each.
        mirrored: mesh edges (m,) on planes of symmetry; axes: (m,) the coordinate 0, 1 or 2 along each plane's normal.
        hand: the node (1,) that a hand holds; (0,) where it holds none.
    """

    mask: np.ndarray
    places: np.ndarray
    clamped: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int32))
    slopes: np.ndarray = field(default_factory=lambda: np.empty((0, 3)))
    mirrored: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int32))
    axes: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int32))
    hand: np.ndarray = field(default_factory=lambda: np.empty(0, dtype=np.int64))


class ClothDirichlet(Dirichlet):
    """Prescribed positions and slopes, whose values supports give for the mesh as it lies.

    Args:
        supports: on the corners of the mesh.
        mesh: whose edges have a direction.
        numbers: (corners,) node of each corner; n: of all nodes.
        morley: of the edges; None where edges have no slope.

    Attributes:
        free: (n, 3) 0 where an unknown is prescribed, else 1.
    """

    def __init__(
        self, supports: ClothSupports, mesh: Mesh, numbers: np.ndarray, n: int, morley: MorleySpace | None
    ) -> None:
        super().__init__((n, 3), (), {})
        self.mask[numbers] = supports.mask
        self.values[numbers] = np.where(supports.mask, supports.places, 0.0)
        if morley:
            self._constrain_slopes(supports, mesh, morley)
        self.constrained = np.flatnonzero(self.mask.ravel())
        self.free = np.where(self.mask, 0.0, 1.0)

    def evaluate(self, X: np.ndarray) -> None:
        """Nothing: the supports' values are those of the mesh as it lies."""

    def _constrain_slopes(self, supports: ClothSupports, mesh: Mesh, morley: MorleySpace) -> None:
        """Prescribe the slopes of clamped edges, and those across the normal of planes of symmetry.

        On the border a side that runs as its edge does has the outside on the right, where the normal points.
        """
        edges = mesh.edge_nodes
        length = np.linalg.norm(np.diff(mesh.X[edges], axis=1)[:, 0], axis=1)
        outward = np.empty(len(edges))
        outward[mesh.cell_edges[:, SIDES]] = morley.signs
        for edge, slope in zip(supports.clamped, supports.slopes):
            node = morley.side_number[edge]
            self.mask[node] = 1
            self.values[node] = outward[edge] * length[edge] * slope
        for edge, axis in zip(supports.mirrored, supports.axes):
            node = morley.side_number[edge]
            self.mask[node] = np.arange(3) != axis
