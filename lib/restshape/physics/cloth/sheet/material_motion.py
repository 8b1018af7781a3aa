"""Where the nodes of cloth are in its material, and where the cloth is when they go elsewhere in it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import MorleySpace
from restshape.scene.pattern_packing import PanelFrame
from restshape.shape.panels.panel_placement import plane_axes


@dataclass(frozen=True, eq=False)
class MaterialPlace:
    """Nodes in the material at one time, while the mesh goes on.

    Args:
        X: (n, 2) material coordinates [m] of corners and, of Morley's triangles, edges.
        normals: (edges, 2) [m] along which edges have slopes; None where they have none.
        frames: where the coordinates of each panel lie in the pattern plane; none of one sheet.
        pieces: (n,) numbers of the panels of nodes; side_pieces: (edges,) of edges.
    """

    X: np.ndarray
    normals: np.ndarray | None
    frames: tuple[PanelFrame, ...] = ()
    pieces: np.ndarray | None = None
    side_pieces: np.ndarray | None = None

    @classmethod
    def of(cls, mesh: Mesh, morley: MorleySpace | None, frames: tuple[PanelFrame, ...] = ()) -> MaterialPlace:
        """Where the nodes are now."""
        X, normals = (morley.X.copy(), morley.normals()) if morley else (mesh.X.copy(), None)
        if not frames:
            return cls(X, normals)
        pieces, sides = mesh.node_piece, mesh.node_piece[mesh.edge_nodes[:, 0]]
        if not morley:
            return cls(X, None, frames, pieces)
        every = np.empty(len(X), dtype=np.int32)
        every[morley.corner_number], every[morley.side_number] = pieces, sides
        return cls(X, normals, frames, every, sides)

    @property
    def size(self) -> float:
        """The longer side of the box around the nodes [m], or of the largest of those around panels."""
        if not self.frames:
            return float(np.ptp(self.X, axis=0).max())
        own = in_frames(self.X, self.pieces, self.frames, (PanelFrame(0.0, 0.0, 0.0),) * len(self.frames))
        return max(float(np.ptp(own[self.pieces == k], axis=0).max()) for k in range(len(self.frames)))

    def farthest(self, other: MaterialPlace) -> float:
        """The farthest way [m] of a node to where it is at another time, within its panel."""
        X = in_frames(other.X, self.pieces, other.frames, self.frames)
        return float(np.linalg.norm(X - self.X, axis=1).max())


def in_frames(
    X: np.ndarray,
    pieces: np.ndarray | None,
    frames: tuple[PanelFrame, ...],
    others: tuple[PanelFrame, ...],
    turn: bool = False,
) -> np.ndarray:
    """Where X (n, 2) [m] would be if the panels lay in other frames; it itself where these are the same.

    Args:
        X: places, or directions, in the pattern plane.
        pieces: (n,) numbers of their panels.
        frames: of the panels now; others: those wanted.
        turn: they are directions.
    """
    if frames == others or pieces is None:
        return X
    found = X.copy()
    for k, (now, wanted) in enumerate(zip(frames, others)):
        if now == wanted:
            continue
        own = pieces == k
        d = X[own] if turn else X[own] - (now.x, now.y)
        angle = wanted.angle - now.angle
        d = d @ plane_axes(PanelFrame(0.0, 0.0, angle)).T if angle else d
        found[own] = d if turn else d + np.array([wanted.x, wanted.y])
    return found


class AdvectedCloth:
    """Cloth at unknowns x (n, 3) with its nodes at one place, to be taken to others along the cloth.

    Positions are right to first order in the way of the material, slopes but for curvatures times it; all is where the
    cloth is flat. A panel that only lies elsewhere in the pattern plane stays where it is.

    Args:
        place: of the nodes at x.
        cells: (ne, 3) corners of triangles.
        nodes: (ne, k) all nodes of triangles.
        x: (n, 3) unknowns.
    """

    def __init__(self, place: MaterialPlace, cells: np.ndarray, nodes: np.ndarray, x: np.ndarray) -> None:
        self.place, self.x = place, x
        self._cells, self._nodes = cells, nodes

    @cached_property
    def gradients(self) -> np.ndarray:
        """Derivatives (n, 3, 2) of the positions at the nodes, made where the material goes somewhere."""
        return _gradients(self.place.X, self._cells, self._nodes, self.x)

    def unknowns_at(self, place: MaterialPlace, sides: np.ndarray | None) -> np.ndarray:
        """Unknowns (n, 3) with the nodes at another place; `sides` are the nodes of edges, None: there are none."""
        own = self.place
        way = in_frames(place.X, own.pieces, place.frames, own.frames) - own.X
        if sides is not None:
            # An edge's unknown is a derivative along its normal, which has changed.
            way[sides] = in_frames(place.normals, own.side_pieces, place.frames, own.frames, turn=True) - own.normals
        return self.x + np.einsum("iak,ik->ia", self.gradients, way) if way.any() else self.x.copy()

    def corners_at(self, X: np.ndarray, numbers: np.ndarray, frames: tuple[PanelFrame, ...] = ()) -> np.ndarray:
        """Positions (corners, 3) of corners at X (corners, 2) with these node numbers (corners,); flips or not.

        Args:
            X: in the pattern plane [m].
            numbers: of the nodes.
            frames: of the panels there.
        """
        pieces = None if self.place.pieces is None else self.place.pieces[numbers]
        way = in_frames(X, pieces, frames, self.place.frames) - self.place.X[numbers]
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
