"""The derivative of a frequency along the outline, as a density on its edges: where taking material away raises it."""

from dataclasses import dataclass

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.mesh.relocate import BoundaryNodes, extension
from restshape.sensitivity.frequency_derivative import SolvedModes, nodal_gradient


@dataclass(frozen=True)
class OutlineDensity:
    """What moving the boundary does to a frequency.

    Args:
        nodes: (nb,) nodes of the mesh of corners.
        gradient: (nb, 2) [Hz/m] by the place of each node, the nodes inside following harmonically.
        normal: (nb, 2) out of the material; a corner has the mean of its sides'.
        length: (nb,) [m] half of the facets beside each node.
        density: (nb,) [Hz/m^2]: f changes by the integral of it times the way of the boundary along its normal.
        edge: (nb,) outline edge, -1 for an embedded vertex, which has neither normal nor density.
    """

    nodes: np.ndarray
    gradient: np.ndarray
    normal: np.ndarray
    length: np.ndarray
    density: np.ndarray
    edge: np.ndarray


def plane_gradient(analysis: SolvedModes, mode: int, by_nodes: np.ndarray | None = None) -> np.ndarray:
    """The gradient (n2, 2) [Hz/m] of a frequency by the places of the corners of the plane mesh.

    Nodes in the middle of sides follow their ends, columns of nodes their foot, and the thickness is that of the place.

    Args:
        analysis: solved on the mesh as it lies.
        mode: index among the modes; its eigenvalue stands alone.
        by_nodes: (n, d) its `nodal_gradient`, where that is known.
    """
    body, plane = analysis.state.body, analysis.state.space
    scale = 1.0 / (4.0 * np.pi * np.sqrt(analysis.state.modes.values[mode]))
    gradient = scale * (nodal_gradient(analysis, mode) if by_nodes is None else by_nodes)
    on_plane = np.empty((len(plane.X), 2))
    for axis in range(2):
        unit = np.zeros((1, *plane.X.shape))
        unit[0, :, axis] = 1.0
        # Each plane node moves its own nodes only, so that all may be moved at once.
        pulled = (body.motion(unit)[0] * gradient).sum(axis=1)
        on_plane[:, axis] = body.by_plane_nodes(pulled).reshape(len(plane.X), -1).sum(axis=1)
    return plane.on_corners(on_plane)


def outline_density(analysis: SolvedModes, mode: int, by_nodes: np.ndarray | None = None) -> OutlineDensity:
    """The density of a frequency's derivative along the outline; arguments as in `plane_gradient`.

    Source: docs/theory/free-vibrations.md.
    """
    mesh = analysis.state.space.mesh
    nodes = BoundaryNodes(mesh).nodes
    inside = extension(mesh, nodes, "harmonic")(np.eye(len(nodes)))
    gradient = inside.T @ plane_gradient(analysis, mode, by_nodes)
    row = np.full(len(mesh.X), -1)
    row[nodes] = np.arange(len(nodes))
    # Facets between regions have material on both sides: they are no boundary.
    outer = np.array([loop_kind != "region" for loop_kind in _loop_kinds(mesh)])[mesh.facet_edge]
    normal, length = _across(mesh, mesh.facets[outer], row, len(nodes))
    lies = length > 0.0
    density = np.full(len(nodes), np.nan)
    density[lies] = (gradient[lies] * normal[lies]).sum(axis=1) / length[lies]
    return OutlineDensity(nodes, gradient, normal, length, density, mesh.node_edge[nodes])


@dataclass(frozen=True)
class EdgeDensity:
    """The same on one edge of the outline, its ends included: there its own normal counts, not that of both edges.

    Args:
        at: (m, 2) [m] places of the nodes.
        normal: (m, 2) out of the material, across this edge.
        length: (m,) [m] half of this edge's facets beside each node.
        density: (m,) [Hz/m^2].
    """

    at: np.ndarray
    normal: np.ndarray
    length: np.ndarray
    density: np.ndarray


def edge_densities(analysis: SolvedModes, found: OutlineDensity) -> dict[str, EdgeDensity]:
    """The density on each edge that is boundary, by the edge's name.

    Args:
        analysis: solved on the mesh as it lies.
        found: `outline_density` of a mode.
    """
    mesh = analysis.state.space.mesh
    row = np.full(len(mesh.X), -1)
    row[found.nodes] = np.arange(len(found.nodes))
    densities = {}
    for number, (edge, kind) in enumerate(zip(mesh.outline.edges, _loop_kinds(mesh))):
        ends = mesh.facets[mesh.facet_edge == number]
        if kind == "region" or not len(ends):
            continue
        normal, length = _across(mesh, ends, row, len(found.nodes))
        own = np.flatnonzero(length)
        density = (found.gradient[own] * normal[own]).sum(axis=1) / length[own]
        densities[edge.name] = EdgeDensity(mesh.X[found.nodes[own]], normal[own], length[own], density)
    return densities


def _across(mesh: Mesh, ends: np.ndarray, row: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Unit normals (count, 2), out of the material, and half lengths (count,) [m] beside nodes of facets (nf, 2).

    Args:
        mesh: that the facets belong to; row: (n,) place of each node among the `count`.
    """
    along = mesh.X[ends[:, 1]] - mesh.X[ends[:, 0]]
    across = np.column_stack([along[:, 1], -along[:, 0]])
    normal, length = np.zeros((count, 2)), np.zeros(count)
    for end in ends.T:
        np.add.at(normal, row[end], across)
        np.add.at(length, row[end], 0.5 * np.linalg.norm(along, axis=1))
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    return np.divide(normal, size, out=normal, where=size > 0.0), length


def _loop_kinds(mesh: Mesh) -> list[str]:
    """The kind of loop that each edge of the outline belongs to; that of the shape's boundary goes first."""
    kinds = ["region"] * len(mesh.outline.edges)
    for loop in mesh.outline.loops:
        for edge, _ in loop.edges:
            if loop.kind != "region":
                kinds[edge] = loop.kind
    return kinds
