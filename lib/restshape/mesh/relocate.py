"""Level 1: how mesh nodes follow the boundary, as a linear map that stays fixed during a gesture."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.linalg import splu

from restshape import _kernels
from restshape.mesh.mesh import Mesh
from restshape.shape.outline import Outline

KINDS = ("harmonic", "mvc", "laplacian")
STIFFENING = 0.0


class Boundary:
    """Nodes of a mesh that follow its outline: those on outline edges, and embedded vertices.

    Args:
        mesh: the mesh.

    Attributes:
        nodes: (nb,) their numbers, ascending.
    """

    def __init__(self, mesh: Mesh) -> None:
        placed = mesh.node_edge >= 0
        vertices = np.flatnonzero(mesh.vertex_node >= 0)
        lonely = vertices[~placed[mesh.vertex_node[vertices]]]
        follows = placed.copy()
        follows[mesh.vertex_node[lonely]] = True
        self.nodes = np.flatnonzero(follows).astype(np.int32)
        row = np.cumsum(follows) - 1
        self._vertices, self._vertex_rows = lonely, row[mesh.vertex_node[lonely]]
        on_edge = np.flatnonzero(placed)
        on_edge = on_edge[np.argsort(mesh.node_edge[on_edge], kind="stable")]
        edges, starts = np.unique(mesh.node_edge[on_edge], return_index=True)
        chunks = np.split(on_edge, starts[1:])
        self._groups = [(int(edge), row[chunk], mesh.node_param[chunk]) for edge, chunk in zip(edges, chunks)]

    def values(self, outline: Outline, points: np.ndarray) -> np.ndarray:
        """Positions (nb, 2) of the nodes, or displacements, for control points or displacements of them.

        Args:
            outline: gives curves and bulges.
            points: (k, 2) control points [m], or any displacement of them.
        """
        result = np.empty((len(self.nodes), 2))
        for edge, rows, parameters in self._groups:
            result[rows] = outline.point(edge, parameters, points=points)
        result[self._vertex_rows] = points[self._vertices]
        return result

    def basis(self, outline: Outline, basis: Sequence[np.ndarray]) -> np.ndarray:
        """Displacements (2, nb, 2) of the nodes for the two displacements (k, 2) of the control points of a gesture."""
        return np.stack([self.values(outline, points) for points in basis])


class Extension(Protocol):
    """Carries displacements of the boundary into the mesh, linearly."""

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Values (n, k) at all nodes from values (nb, k) at the boundary nodes."""


class HarmonicExtension:
    """Solves Laplace's equation on the mesh as it lies; reproduces linear functions when nothing is stiffened.

    Args:
        mesh: the mesh; positions are read once.
        nodes: (nb,) boundary nodes.
        stiffening: weights each triangle by (mean area / area)^stiffening, so that small triangles deform less.
    """

    def __init__(self, mesh: Mesh, nodes: np.ndarray, stiffening: float = STIFFENING) -> None:
        self.nodes = nodes
        n = len(mesh.X)
        inside = np.ones(n, dtype=bool)
        inside[nodes] = False
        self.free = np.flatnonzero(inside)
        number = np.empty(n, dtype=np.int32)
        number[self.free] = np.arange(len(self.free))
        number[nodes] = np.arange(len(nodes))
        weights = edge_weights(mesh, stiffening)
        a, b = mesh.edge_nodes.T
        inner, outward, inward = inside[a] & inside[b], inside[a] & ~inside[b], inside[b] & ~inside[a]
        diagonal = (np.bincount(a, weights, n) + np.bincount(b, weights, n))[self.free]
        w, i, j, own = -weights[inner], number[a[inner]], number[b[inner]], np.arange(len(self.free), dtype=np.int32)
        size = len(self.free)
        entries = (np.concatenate([w, w, diagonal]), (np.concatenate([i, j, own]), np.concatenate([j, i, own])))
        stiffness = coo_matrix(entries, shape=(size, size)).tocsc()
        rows, columns = np.concatenate([a[outward], b[inward]]), np.concatenate([b[outward], a[inward]])
        pull = np.concatenate([weights[outward], weights[inward]])
        self._pull = coo_matrix((pull, (number[rows], number[columns])), shape=(size, len(nodes))).tocsr()
        # Symmetric positive definite: no pivoting, and an ordering of A^T + A, take half the time of the default.
        options = {"SymmetricMode": True}
        self._factor = (
            splu(stiffness, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options) if size else None
        )

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Values (n, k) at all nodes from values (nb, k) at the boundary nodes."""
        result = np.empty((len(self.free) + len(self.nodes), values.shape[1]))
        result[self.nodes] = values
        if self._factor is not None:
            result[self.free] = self._factor.solve(self._pull @ values)
        return result


def edge_weights(mesh: Mesh, stiffening: float) -> np.ndarray:
    """Half the sum of the cotangents opposite to each edge (n_edges,): minus the off-diagonal of the P1 Laplacian."""
    corners = mesh.X[mesh.cells]
    sides = corners[:, [2, 0, 1]] - corners[:, [1, 2, 0]]
    twice_area = sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0]
    dots = -np.einsum("eik,eik->ei", sides[:, [1, 2, 0]], sides[:, [2, 0, 1]])
    scale = 0.5 / twice_area
    if stiffening:
        scale *= (twice_area.mean() / twice_area) ** stiffening
    return np.bincount(mesh.cell_edges.ravel(), (dots * scale[:, None]).ravel(), len(mesh.edge_nodes))


class MeanValueExtension:
    """Positive mean value coordinates: non-negative weights over what a node sees of the boundary.

    Embedded vertices have no extent that could be seen: what they lack is spread harmonically.

    Args:
        mesh: the mesh.
        nodes: (nb,) boundary nodes.

    Source: THEORY.md section 8; Lipman et al. 2007.
    """

    def __init__(self, mesh: Mesh, nodes: np.ndarray) -> None:
        self.nodes = nodes
        on_facets = np.zeros(len(mesh.X), dtype=bool)
        on_facets[mesh.facets] = True
        self._seen = np.flatnonzero(on_facets[nodes])
        row = np.full(len(mesh.X), -1, dtype=np.int32)
        row[nodes[self._seen]] = np.arange(len(self._seen))
        self._segments, self._vertices = row[mesh.facets], mesh.X[nodes[self._seen]]
        self._seeing = np.flatnonzero(~on_facets)
        self._points = mesh.X[self._seeing]
        self._harmonic = HarmonicExtension(mesh, nodes) if len(self._seen) < len(nodes) else None

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Values (n, k) at all nodes from values (nb, k) at the boundary nodes."""
        visible = values[self._seen]
        result = np.empty((len(self._seeing) + len(self._seen), values.shape[1]))
        result[self.nodes[self._seen]] = visible
        result[self._seeing] = _kernels.positive_mean_value(self._points, self._vertices, self._segments, visible)
        if self._harmonic:
            result += self._harmonic(values - result[self.nodes])
        return result


class NoExtension:
    """Boundary nodes alone move; springs relax the others in each frame."""

    def __init__(self, mesh: Mesh, nodes: np.ndarray) -> None:
        self.nodes, self._size = nodes, len(mesh.X)

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Values (n, k), zero but at the boundary nodes."""
        result = np.zeros((self._size, values.shape[1]))
        result[self.nodes] = values
        return result


def extension(mesh: Mesh, nodes: np.ndarray, kind: str) -> Extension:
    """The way of a kind to carry boundary displacements into a mesh.

    Args:
        mesh: the mesh as it lies now.
        nodes: (nb,) boundary nodes.
        kind: "harmonic", "mvc" or "laplacian".
    """
    return {"harmonic": HarmonicExtension, "mvc": MeanValueExtension, "laplacian": NoExtension}[kind](mesh, nodes)


def motion(mesh: Mesh, boundary_basis: np.ndarray, kind: str, carry: Extension | None = None) -> np.ndarray:
    """Psi (2, n, 2): node displacements a unit of each of a gesture's two coefficients.

    Args:
        mesh: the mesh as it lies now.
        boundary_basis: (2, nb, 2) displacements of the boundary nodes, in the order of ``Boundary(mesh).nodes``.
        kind: "harmonic", "mvc" or "laplacian" (boundary nodes alone).
        carry: an extension made earlier on the same mesh, to be used again.

    Source: THEORY.md section 8.
    """
    carry = carry or extension(mesh, Boundary(mesh).nodes, kind)
    together = carry(np.concatenate(list(boundary_basis), axis=1))
    return np.ascontiguousarray(together.reshape(len(mesh.X), 2, 2).transpose(1, 0, 2))
