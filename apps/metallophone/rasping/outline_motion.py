"""How the nodes of a mesh move when material comes off its outline."""

import numpy as np

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.mesh.mesh import Mesh
from restshape.mesh.relocate import BoundaryNodes, extension

NEARLY_PARALLEL = 0.2
"""Ratio of singular values of the normals at a corner below which both sides count as one."""


def outer_edges(mesh: Mesh, kinds: tuple[str, ...] = ("outline", "hole")) -> list[int]:
    """Numbers of the edges of loops of some kinds; those of loops alone that material is on one side of."""
    return [edge for loop in mesh.outline.loops if loop.kind in kinds for edge, _ in loop.edges]


def edge_nodes(mesh: Mesh, edge: int) -> np.ndarray:
    """Nodes (m,) along an edge, the material on the left; the last is the first again where the edge is closed."""
    facets = mesh.facets[mesh.facet_edge == edge]
    following = dict(facets.tolist())
    first = set(following) - set(facets[:, 1].tolist())
    node = first.pop() if first else int(facets[0, 0])
    chain = [node]
    while node in following:
        node = following.pop(node)
        chain.append(node)
    return np.array(chain)


def lengths_along(mesh: Mesh, nodes: np.ndarray) -> np.ndarray:
    """Lengths (m,) [m] from the first of the nodes (m,) of a chain to each."""
    return np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(mesh.X[nodes], axis=0), axis=1))])


def boundary_motion(mesh: Mesh, depths: dict[int, np.ndarray]) -> np.ndarray:
    """Displacements (n, 2) [m] of the nodes on edges off which depths come; 0 elsewhere.

    At a corner the node goes to where the sides meet then: the side that nothing comes off keeps its line.

    Args:
        mesh: of corners.
        depths: by edge, at its `edge_nodes` (m,) [m]. An edge that is not among them loses nothing.
    """
    wanted: dict[int, list[tuple[np.ndarray, float]]] = {}
    for edge in outer_edges(mesh):
        nodes = edge_nodes(mesh, edge)
        depth = depths.get(edge, np.zeros(len(nodes)))
        closed = nodes[0] == nodes[-1]
        for node, normal, own in list(zip(nodes, _normals(mesh.X[nodes], closed), depth))[: -1 if closed else None]:
            wanted.setdefault(int(node), []).append((normal, float(own)))
    moved = np.zeros_like(mesh.X)
    for node, sides in wanted.items():
        if any(depth for _, depth in sides):
            across, off = np.array([normal for normal, _ in sides]), np.array([depth for _, depth in sides])
            moved[node] = np.linalg.lstsq(across, -off, rcond=NEARLY_PARALLEL)[0]
    return moved


def followed_inside(mesh: Mesh, moved: np.ndarray) -> np.ndarray:
    """Displacements (n, 2) of all nodes where those of the boundary have `moved` (n, 2): harmonic inside."""
    nodes = BoundaryNodes(mesh).nodes
    return extension(mesh, nodes, "harmonic")(np.ascontiguousarray(moved[nodes]))


def on_plane(analysis: ModalAnalysis, moved: np.ndarray) -> np.ndarray:
    """Displacements (n2, 2) of all plane nodes from those (n, 2) of the corners: middles of sides follow their ends."""
    space = analysis.state.space
    still = np.zeros((2, *space.mesh.outline.points.shape))
    return space.motion(np.stack([moved, np.zeros_like(moved)]), still)[0]


def corner_cosines(mesh: Mesh, edge: int) -> np.ndarray:
    """Cosines (2,) of the angles between an edge's normals at its ends and those of the edges that it meets there."""
    own, found = edge_nodes(mesh, edge), np.ones(2)
    normals = _normals(mesh.X[own], False)[[0, -1]]
    for other in outer_edges(mesh):
        nodes = edge_nodes(mesh, other)
        if other == edge:
            continue
        ends = _normals(mesh.X[nodes], False)[[0, -1]]
        for k, node in enumerate(own[[0, -1]]):
            for normal in ends[nodes[[0, -1]] == node]:
                found[k] = normals[k] @ normal
    return found


def _normals(X: np.ndarray, closed: bool) -> np.ndarray:
    """Unit normals (m, 2) out of the material along a chain of places (m, 2) with the material on the left."""
    along = np.diff(X, axis=0)
    before, after = np.vstack([along[-1:] if closed else along[:1], along]), np.vstack([along, along[-1:]])
    if closed:
        after[-1] = along[0]
    both = before + after
    normal = np.column_stack([both[:, 1], -both[:, 0]])
    return normal / np.linalg.norm(normal, axis=1, keepdims=True)
