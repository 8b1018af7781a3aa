"""The part of a mesh that a drag with a reach moves: nodes near what the hand moves of the outline, and their cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape import _kernels
from restshape.mesh.mesh import Mesh
from restshape.mesh.relocate import BoundaryNodes

MOST_CONDENSED = 0.25
"""Share of the nodes up to which a moving part is solved for by itself: beyond it the whole costs little more."""


@dataclass(frozen=True, eq=False)
class MovingPart:
    """What a gesture moves; as long as it is the same object all else stays, connections included.

    Args:
        nodes: (m,) of the mesh, ascending, that move.
        cells: (k,) int32 around them, ascending: they alone change, and may have flips.
        share: of all nodes.
        rest: least quality of the other cells, how many of them are invalid, and how many of low quality.
    """

    nodes: np.ndarray
    cells: np.ndarray
    share: float
    rest: tuple[float, int, int]

    @property
    def condensed(self) -> bool:
        """Whether what stays is worth condensing."""
        return len(self.nodes) > 0 and self.share <= MOST_CONDENSED

    def check(self, mesh: Mesh, area_floor: float, quality_floor: float) -> tuple[float, int, int]:
        """Least quality, invalid and low-quality cells of the mesh as it lies."""
        quality, invalid, low = _kernels.check_cells(mesh.X, mesh.cells[self.cells], area_floor, quality_floor)
        least, more, lower = self.rest
        return min(quality, least), invalid + more, low + lower

    def staying_edges(self, mesh: Mesh) -> np.ndarray:
        """1 (n_edges,) uint8 for edges that have a cell that stays: they never flip."""
        inside = np.bincount(mesh.cell_edges[self.cells].ravel(), minlength=len(mesh.edge_nodes))
        return (inside < 2).astype(np.uint8)


def moving_part(
    mesh: Mesh, moved: np.ndarray, boundary: np.ndarray, reach: float, floors: tuple[float, float]
) -> MovingPart:
    """What moves where the nodes of the outline `moved` do.

    Args:
        mesh: as it lies now.
        moved: (m,) nodes on the outline.
        boundary: (nb,) all nodes that follow the outline.
        reach: distance [m] from these nodes up to which others move.
        floors: area and quality below which cells are invalid, or of low quality.
    """
    moves = np.zeros(len(mesh.X), dtype=bool)
    if len(moved):
        from scipy.spatial import cKDTree

        near, _ = cKDTree(mesh.X[moved]).query(mesh.X, distance_upper_bound=reach)
        moves = near < reach
        moves[boundary] = False
        moves[moved] = True
    nodes = np.flatnonzero(moves)
    changes = moves[mesh.cells].any(axis=1)
    others = np.ascontiguousarray(mesh.cells[~changes])
    rest = _kernels.check_cells(mesh.X, others, *floors) if len(others) else (np.inf, 0, 0)
    return MovingPart(nodes, np.flatnonzero(changes).astype(np.int32), len(nodes) / len(mesh.X), rest)


def reaching_motion(mesh: Mesh, boundary_basis: np.ndarray, part: MovingPart, boundary: BoundaryNodes) -> np.ndarray:
    """Psi (2, n, d): node displacements a unit of each of a gesture's two coefficients, 0 beyond the part.

    The stiffened harmonic map of the cells of the part, with 0 at the border: it goes to 0 there, and spreads the
    strain over all cells between.

    Args:
        mesh: as it lies now.
        boundary_basis: (2, nb, d) displacements of the nodes on the outline.
        part: what moves.
        boundary: the nodes on the outline.

    Source: docs/theory/substructures.md.
    """
    Psi = np.zeros((len(boundary_basis), *mesh.X.shape))
    if not len(part.nodes):
        return Psi
    Psi[:, boundary.nodes] = boundary_basis
    nodes, cells = np.unique(mesh.cells[part.cells], return_inverse=True)
    moves = np.zeros(len(mesh.X), dtype=bool)
    moves[part.nodes] = True
    moves[boundary.nodes] = False
    given = np.flatnonzero(~moves[nodes]).astype(np.int32)
    own = np.ascontiguousarray(cells.reshape(-1, 3), dtype=np.int32)
    values = np.concatenate(list(Psi[:, nodes[given]]), axis=1)
    extension = _kernels.HarmonicExtension(np.ascontiguousarray(mesh.X[nodes]), own, given)
    extension.stiffen(extension.weigh(extension.solve(values)))
    found = extension.solve(values).reshape(len(nodes), len(Psi), mesh.dim)
    Psi[:, nodes] = found.transpose(1, 0, 2)
    return Psi
