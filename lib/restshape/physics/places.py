"""Nodes, facets and cells of a mesh that a list of names addresses."""

from collections.abc import Sequence

import numpy as np

from restshape.mesh.mesh import Mesh


def _union(parts: list[np.ndarray]) -> np.ndarray:
    return parts[0] if len(parts) == 1 else np.unique(np.concatenate(parts))


def nodes_on(mesh: Mesh, names: Sequence[str]) -> np.ndarray:
    """Indices (k,) of the nodes on the named entities."""
    return _union([mesh.nodes_of(name) for name in names])


def facets_on(mesh: Mesh, names: Sequence[str]) -> np.ndarray:
    """Indices (k,) of the facets on the named edges."""
    return _union([mesh.facets_of(name) for name in names])


def cells_on(mesh: Mesh, names: Sequence[str]) -> np.ndarray:
    """Indices (k,) of the cells in the named regions."""
    return _union([mesh.cells_of(name) for name in names])
