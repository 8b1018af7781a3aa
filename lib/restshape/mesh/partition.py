"""Which rank owns which node: METIS, as gmsh calls it."""

from __future__ import annotations

import numpy as np


def node_owners(X: np.ndarray, cells: np.ndarray, ranks: int) -> np.ndarray:
    """Rank (n,) that owns each node; balanced, with short borders, the same at each call.

    Args:
        X: (n, 2) positions [m]; cells: (ne, 3) triangles; ranks: number of parts.
    """
    if ranks == 1:
        return np.zeros(len(X), dtype=np.int32)
    part = cell_parts(X, cells, ranks)
    least = np.full(len(X), ranks, dtype=np.int32)
    most = np.full(len(X), -1, dtype=np.int32)
    np.minimum.at(least, cells.ravel(), np.repeat(part, 3))
    np.maximum.at(most, cells.ravel(), np.repeat(part, 3))
    # A node on a border goes to either side in turn, so that no rank gets all of them.
    shared = np.flatnonzero(least != most)
    owner = least
    owner[shared[1::2]] = most[shared[1::2]]
    return owner


def cell_parts(X: np.ndarray, cells: np.ndarray, ranks: int) -> np.ndarray:
    """Rank (ne,) of each triangle.

    Args:
        X: (n, 2) positions [m]; cells: (ne, 3) triangles; ranks: number of parts.
    """
    import gmsh

    from restshape.mesh.mesher import model

    part = np.zeros(len(cells), dtype=np.int32)
    with model():
        gmsh.option.setNumber("Mesh.PartitionCreateTopology", 0)
        gmsh.option.setNumber("Mesh.PartitionCreateGhostCells", 0)
        surface = gmsh.model.addDiscreteEntity(2)
        xyz = np.column_stack([X, np.zeros(len(X))]).ravel()
        gmsh.model.mesh.addNodes(2, surface, np.arange(1, len(X) + 1), xyz)
        gmsh.model.mesh.addElementsByType(surface, 2, np.arange(1, len(cells) + 1), cells.ravel().astype(np.int64) + 1)
        gmsh.model.mesh.partition(ranks)
        for dim, tag in gmsh.model.getEntities(2):
            parts = gmsh.model.getPartitions(dim, tag)
            if len(parts):
                tags, _ = gmsh.model.mesh.getElementsByType(2, tag)
                part[tags.astype(np.int64) - 1] = parts[0] - 1
    return part
