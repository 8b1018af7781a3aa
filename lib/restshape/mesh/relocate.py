"""Level 1: how mesh nodes follow the boundary, as a linear map that stays fixed during a gesture."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Protocol

import numpy as np

from restshape import _kernels
from restshape.mesh.mesh import Mesh
from restshape.mesh.reconnect import edges_between
from restshape.mesh.regions import cell_patches
from restshape.shape.outline import Outline


class BoundaryNodes:
    """Nodes of a mesh that follow its outline: those on outline edges, and embedded vertices.

    Args:
        mesh: the mesh.

    Attributes:
        nodes: (nb,) their numbers, ascending.
        dim: coordinates d of a node.
    """

    def __init__(self, mesh: Mesh) -> None:
        self.dim = mesh.dim
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
        self._rows, self._parameters = row[on_edge], mesh.node_param[on_edge]
        self._counts = np.bincount(mesh.node_edge[on_edge])

    def values(self, outline: Outline, points: np.ndarray) -> np.ndarray:
        """Positions (nb, d) of the nodes, or displacements, for control points or displacements of them.

        Args:
            outline: gives curves and bulges.
            points: (k, d) control points [m], or any displacement of them.
        """
        result = np.empty((len(self.nodes), self.dim))
        first = np.zeros(len(outline.edges) + 1, dtype=np.int64)
        np.cumsum(self._counts, out=first[1 : len(self._counts) + 1])
        first[len(self._counts) + 1 :] = len(self._rows)
        result[self._rows] = outline.points_on_all(first, self._parameters, points)
        result[self._vertex_rows] = points[self._vertices]
        return result

    def basis(self, outline: Outline, basis: Sequence[np.ndarray]) -> np.ndarray:
        """Displacements (2, nb, d) of the nodes for the two displacements (k, d) of the control points of a gesture."""
        return np.stack([self.values(outline, points) for points in basis])


class Extension(Protocol):
    """Extends displacements of the boundary into the mesh, linearly."""

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Values (n, k) at all nodes from values (nb, k) at the boundary nodes."""

    def adapted(self, values: np.ndarray) -> np.ndarray:
        """The same for values that the extension may adapt itself to, which has served with this call."""


class HarmonicExtension:
    """Solves Laplace's equation on the mesh as it lies; linear functions are reproduced.

    Args:
        mesh: the mesh; positions and triangles are read once.
        nodes: (nb,) boundary nodes, int32.
    """

    def __init__(self, mesh: Mesh, nodes: np.ndarray) -> None:
        self._kernel = _kernels.HarmonicExtension(mesh.X, mesh.cells, nodes)

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Values (n, k) at all nodes from values (nb, k) at the boundary nodes."""
        return self._kernel.solve(values)

    def adapted(self, values: np.ndarray) -> np.ndarray:
        """Solve twice: from the second time on, each triangle is weighted by the size of the first field's gradient.

        Strain then spreads away from where the field gathers it. A linear field has one gradient everywhere, and is
        reproduced as before. With a hole of radius 0.12 in a plate of 2 x 1 the map of a drag lasts 1.2 to 2.4 times as
        far until a triangle is of low quality; weights by area gain less and reproduce no linear function.

        Args:
            values: (nb, k) at the boundary nodes.
        """
        self._kernel.stiffen(self._kernel.weigh(self(values)))
        return self(values)


class CoordinateExtension(ABC):
    """Weights over the facets, the mesh edges on the outline, on holes and on borders of regions.

    Embedded vertices have no extent that could be seen: what they lack is spread harmonically.

    Args:
        mesh: the mesh.
        nodes: (nb,) boundary nodes.
    """

    def __init__(self, mesh: Mesh, nodes: np.ndarray) -> None:
        self.nodes = nodes
        on_facets = np.zeros(len(mesh.X), dtype=bool)
        on_facets[mesh.facets] = True
        self._seen = np.flatnonzero(on_facets[nodes])
        self._row = np.full(len(mesh.X), -1, dtype=np.int32)
        self._row[nodes[self._seen]] = np.arange(len(self._seen))
        self._vertices = mesh.X[nodes[self._seen]]
        self._inside = np.flatnonzero(~on_facets)
        self._harmonic = HarmonicExtension(mesh, nodes) if len(self._seen) < len(nodes) else None

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Values (n, k) at all nodes from values (nb, k) at the boundary nodes."""
        visible = values[self._seen]
        result = np.empty((len(self._inside) + len(self._seen), values.shape[1]))
        result[self.nodes[self._seen]] = visible
        self._fill(result, visible)
        if self._harmonic:
            result += self._harmonic(values - result[self.nodes])
        return result

    def adapted(self, values: np.ndarray) -> np.ndarray:
        """As it is: the weights know the boundary alone."""
        return self(values)

    @abstractmethod
    def _fill(self, result: np.ndarray, visible: np.ndarray) -> None:
        """Set the rows inside of `result` (n, k) from values (ns, k) at the nodes on facets."""


class MeanValueExtension(CoordinateExtension):
    """Mean value coordinates: smooth, but with negative weights where the boundary turns its back.

    Each patch between facets has weights over its own border alone, so that the map is continuous across regions.

    Args:
        mesh: the mesh.
        nodes: (nb,) boundary nodes.

    Source: docs/theory/moving-the-mesh.md; Hormann and Floater 2006.
    """

    def __init__(self, mesh: Mesh, nodes: np.ndarray) -> None:
        super().__init__(mesh, nodes)
        barrier = np.zeros(len(mesh.edge_nodes), dtype=bool)
        barrier[edges_between(mesh.edge_nodes, mesh.facets)] = True
        patch = cell_patches(mesh.cell_edges, barrier)
        cell, corner = np.nonzero(barrier[mesh.cell_edges])
        # Counter-clockwise around its triangle, so that the patch is on the left.
        sides = np.stack([mesh.cells[cell, (corner + k) % 3] for k in (1, 2)], axis=1)
        own = np.empty(len(mesh.X), dtype=patch.dtype)
        own[mesh.cells] = patch[:, None]
        self._patches = []
        for k in range(patch.max() + 1):
            points = self._inside[own[self._inside] == k]
            self._patches.append((points, mesh.X[points], self._row[sides[patch[cell] == k]]))

    def _fill(self, result: np.ndarray, visible: np.ndarray) -> None:
        for nodes, points, segments in self._patches:
            result[nodes] = _kernels.mean_value(points, self._vertices, segments, visible)


class PositiveMeanValueExtension(CoordinateExtension):
    """Positive mean value coordinates: non-negative weights over what a node sees of the boundary.

    Args:
        mesh: the mesh.
        nodes: (nb,) boundary nodes.

    Source: docs/theory/moving-the-mesh.md; Lipman et al. 2007.
    """

    def __init__(self, mesh: Mesh, nodes: np.ndarray) -> None:
        super().__init__(mesh, nodes)
        self._segments, self._points = self._row[mesh.facets], mesh.X[self._inside]

    def _fill(self, result: np.ndarray, visible: np.ndarray) -> None:
        result[self._inside] = _kernels.positive_mean_value(self._points, self._vertices, self._segments, visible)


class NoExtension:
    """Boundary nodes alone move; springs relax the others in each frame."""

    def __init__(self, mesh: Mesh, nodes: np.ndarray) -> None:
        self.nodes, self._size = nodes, len(mesh.X)

    def __call__(self, values: np.ndarray) -> np.ndarray:
        """Values (n, k), zero but at the boundary nodes."""
        result = np.zeros((self._size, values.shape[1]))
        result[self.nodes] = values
        return result

    def adapted(self, values: np.ndarray) -> np.ndarray:
        """As it is: the springs adapt in each frame."""
        return self(values)


KINDS: dict[str, Callable[[Mesh, np.ndarray], Extension]] = {
    "harmonic": HarmonicExtension,
    "mvc": MeanValueExtension,
    "pmvc": PositiveMeanValueExtension,
    "laplacian": NoExtension,
}
"""Kinds of relocation, as `mesh.relocation` names them; of "laplacian" the boundary nodes alone move."""


Harmonic = Callable[[Mesh, np.ndarray], Extension]
"""Makes harmonic extensions of a mesh and its boundary nodes (nb,) int32."""


def extension(mesh: Mesh, nodes: np.ndarray, kind: str, harmonic: Harmonic = HarmonicExtension) -> Extension:
    """The way of a kind to extend boundary displacements into a mesh.

    Args:
        mesh: the mesh as it lies now.
        nodes: (nb,) boundary nodes.
        kind: one of `KINDS`.
        harmonic: makes those of the kind "harmonic", as where ranks share them.
    """
    return (harmonic if kind == "harmonic" else KINDS[kind])(mesh, nodes)


def motion(
    mesh: Mesh,
    boundary_basis: np.ndarray,
    kind: str,
    nodes: np.ndarray | None = None,
    harmonic: Harmonic = HarmonicExtension,
) -> np.ndarray:
    """Psi (2, n, d): node displacements a unit of each of a gesture's two coefficients.

    The harmonic map is solved twice: the strain of the first solution stiffens the second.

    Args:
        mesh: the mesh as it lies now.
        boundary_basis: (2, nb, d) displacements of the boundary nodes, in the order of ``Boundary(mesh).nodes``.
        kind: one of `KINDS`.
        nodes: (nb,) int32 boundary nodes, where they are known.
        harmonic: as of `extension`.

    Source: docs/theory/moving-the-mesh.md.
    """
    values = np.concatenate(list(boundary_basis), axis=1)
    nodes = BoundaryNodes(mesh).nodes if nodes is None else nodes
    together = extension(mesh, nodes, kind, harmonic).adapted(values)
    parted = together.reshape(len(mesh.X), len(boundary_basis), mesh.dim)
    return np.ascontiguousarray(parted.transpose(1, 0, 2))
