"""Plates and bodies for eigenvalue tests: meshes, sparse matrices assembled by the operator, lowest modes."""

import numpy as np
import scipy.sparse as sp
from petsc4py import PETSc
from scipy.sparse.linalg import eigsh

from restshape import _kernels
from restshape.mesh.generate import generate
from restshape.mesh.mesh import Mesh
from restshape.scene.model import MeshSpec, ShapeSpec
from restshape.shape.build import outline_from_spec


def rectangle(width: float, height: float, size: float) -> Mesh:
    """Triangles of a rectangle with one corner in the origin."""
    corners = {"a": [0, 0], "b": [width, 0], "c": [width, height], "d": [0, height]}
    edges = {"bottom": "ab", "right": "bc", "top": "cd", "left": "da"}
    return _mesh(corners, {name: {"line": list(ends)} for name, ends in edges.items()}, size)


def disc(radius: float, size: float) -> Mesh:
    """Triangles of a disc around the origin."""
    corners = {"a": [radius, 0], "b": [0, radius], "c": [-radius, 0], "d": [0, -radius]}
    edges = {ends: {"arc": list(ends), "bulge": float(np.tan(np.pi / 8))} for ends in ("ab", "bc", "cd", "da")}
    return _mesh(corners, edges, size)


def _mesh(corners: dict, edges: dict, size: float) -> Mesh:
    shape = {"vertices": corners, "edges": edges, "outline": list(edges)}
    return generate(outline_from_spec(ShapeSpec.model_validate(shape)), MeshSpec(size=size))


def matrix(name: str, X: np.ndarray, cells: np.ndarray, params: np.ndarray) -> sp.csr_matrix:
    """The assembled tangent of an element at rest, all unknowns free."""
    assert PETSc.Sys.isInitialized()
    element = _kernels.Element(name)
    op = _kernels.Operator(False, element.fields, np.array([0, len(X)], dtype=np.int32))
    op.set_topology([cells])
    op.set_constraints(np.zeros(len(X) * element.fields, dtype=np.uint8))
    op.begin()
    op.add(0, X, [(element, np.zeros((len(X), element.fields)), params, 1.0)])
    op.end()
    start, column, value = op.mat.getValuesCSR()
    return sp.csr_matrix((value, column, start))


def lowest(K: sp.csr_matrix, M: sp.csr_matrix, count: int, rigid: int, constrained: np.ndarray | None = None):
    """Angular frequencies (count,) [rad/s] above the rigid modes, and the modes (n, count).

    Args:
        K, M: stiffness and mass.
        rigid: how many modes have no stiffness.
        constrained: (n,) bool, unknowns that stay 0.
    """
    free = np.ones(K.shape[0], dtype=bool) if constrained is None else ~constrained.ravel()
    K, M = K[free][:, free].tocsc(), M[free][:, free].tocsc()
    # A shift below the first mode and far above rounding, which a smaller one leaves in the last digits of the modes:
    # the scale is that of the diagonals.
    shift = 0.0 if rigid == 0 else -1e-7 * np.median(K.diagonal() / M.diagonal())
    values, vectors = eigsh(K, count + rigid, M, sigma=shift, v0=np.ones(free.sum()))
    order = np.argsort(values)[rigid:]
    assert rigid == 0 or np.abs(np.sort(values)[:rigid]).max() < 1e-4 * values[order[0]]
    modes = np.zeros((len(free), count))
    modes[free] = vectors[:, order]
    return np.sqrt(values[order]), modes
