"""Run by mpiexec: the operator on several ranks, before and after flips, against one rank's; prints the largest gap."""

import numpy as np
from petsc4py import PETSc
from sample_meshes import flip_edges, unit_box

from restshape import _kernels as k

HOOKE = np.array([1.3, 0.7, 0.8, 0.3, -0.9])


def dense_rows(mat, first: int, last: int) -> np.ndarray:
    start, column, value = mat.getValuesCSR()
    dense = np.zeros((last - first, mat.getSize()[1]))
    for i in range(last - first):
        dense[i, column[start[i] : start[i + 1]]] = value[start[i] : start[i + 1]]
    return dense


def main() -> None:
    world = PETSc.COMM_WORLD
    X, cells, _ = unit_box(2, 8)
    n = len(X)
    node_offsets = np.linspace(0, n, world.size + 1).astype(np.int32)
    first, last = 2 * node_offsets[world.rank], 2 * node_offsets[world.rank + 1]
    fixed = np.zeros(2 * n, dtype=np.uint8)
    fixed[np.flatnonzero(np.repeat(X[:, 1] == 0, 2))] = 1
    x = 0.01 * np.random.default_rng(1).uniform(-1, 1, X.shape)
    bottom = np.flatnonzero(X[:, 1] == 0)
    facets = np.column_stack([bottom[:-1], bottom[1:]]).astype(np.int32)
    fixed[2 * bottom[3:5]] = 0
    pressure = np.array([2.0, 1.0, 0.8])
    shared = k.Operator(True, 2, node_offsets, world.rank)
    alone = k.Operator(False, 2, np.array([0, n], dtype=np.int32), 0, "csr")
    for op in (shared, alone):
        op.set_topology([cells, facets])
        op.set_constraints(fixed)
    gap = 0.0
    for repeat in range(3):
        rhs = np.zeros((2, 2 * n))
        for op, b in zip((shared, alone), rhs):
            op.begin()
            op.add(0, X, [(k.Element("linear_elastic_tri3"), x, HOOKE, 1.0)], b)
            op.add(1, X, [(k.Element("pressure_edge2"), x, pressure, 1.0)], b)
            op.end()
        mine, whole = dense_rows(shared.mat, first, last), dense_rows(alone.mat, 0, 2 * n)
        gap = max(gap, np.abs(mine - whole[first:last]).max() / np.abs(whole).max())
        gap = max(gap, np.abs(rhs[0] - rhs[1])[first:last].max())
        assert not rhs[0][: int(first)].any() and not rhs[0][int(last) :].any()
        changed = flip_edges(X, cells, 4, np.random.default_rng(repeat))
        shared.patch(0, changed)
        alone.patch(0, changed)
    PETSc.Sys.syncPrint(f"rank {world.rank} of {world.size} gap {gap:.3e}", flush=True)


main()
