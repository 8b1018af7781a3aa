"""Run by mpiexec: patched operators on several ranks against new ones and one rank's, over random drags with flips.

Prints a line of JSON: the largest relative gaps, and how often the pattern grew on a rank alone and its ghosts did.
"""

import json
import sys

import numpy as np
from petsc4py import PETSc
from sample_meshes import flip_edges, unit_box

from restshape import _kernels as k

HOOKE = np.array([1.3, 0.7, 0.8, 0.3, -0.9])
WORLD = PETSc.COMM_WORLD
RANKS = WORLD.tompi4py()
SOLID, MASS, PRESSURE = (k.Element(name) for name in ("linear_elastic_tri3", "mass_tri3", "pressure_edge2"))


def two_pieces(rng):
    """Two squares apart, whose nodes are numbered in no order: each rank has some of both, all border each other."""
    X, cells, _ = unit_box(2, 3)
    X, cells = np.vstack([X, X + np.array([2.0, 0.3])]), np.vstack([cells, cells + len(X)])
    number = rng.permutation(len(X)).astype(np.int32)
    return X[np.argsort(number)], np.ascontiguousarray(number[cells])


def evenly(n):
    return np.linspace(0, n, WORLD.size + 1).astype(np.int32)


def bodies(rng):
    """Name, nodes, cells, owners, and own unknowns of rank 1 that are constrained, of each body."""
    X, cells, _ = unit_box(2, 7)
    yield "square", X, cells, evenly(len(X)), False
    yield "pieces", *two_pieces(rng), evenly(32), False
    yield "rank without free nodes", X, cells.copy(), evenly(len(X)), True
    yield "rank without nodes", X, cells.copy(), np.array([0, *[30] * (WORLD.size - 1), len(X)], dtype=np.int32), False
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    yield "two triangles", square, np.array([[0, 1, 2], [0, 2, 3]], dtype=np.int32), evenly(4), False


def fill(op, X, x, facets, chosen, rhs):
    """Values that start from kept ones, with forces on a subset of facets, one of them twice."""
    op.begin()
    op.add(0, X, [(MASS, x, np.array([2.0]), 3.0)])
    op.keep()
    op.end()
    op.begin(True)
    op.add(0, X, [(SOLID, x, HOOKE, 1.0)], rhs)
    op.add(1, X, [(PRESSURE, x, np.outer(1.0 + np.arange(len(chosen)), [2.0, 1.0, 0.8]), 1.0)], rhs, chosen)
    op.end()


def dense(op) -> np.ndarray:
    """All rows, on each rank."""
    start, column, value = op.mat.getValuesCSR()
    rows = np.zeros((len(start) - 1, op.mat.getSize()[1]))
    rows[np.repeat(np.arange(len(start) - 1), np.diff(start)), column] = value
    return np.vstack(RANKS.allgather(rows) if op.mat.getComm().size > 1 else [rows])


def product(op, x) -> np.ndarray:
    source, target = op.mat.createVecs()
    source.setArray(x[slice(*source.getOwnershipRange())])
    op.mat.mult(source, target)
    own = target.getArray().copy()
    return np.concatenate(RANKS.allgather(own)) if op.mat.getComm().size > 1 else own


def driven(X, cells, offsets, held, drags, rng) -> dict[str, float]:
    n = len(X)
    edge = np.flatnonzero(np.isclose(X[:, 1], 0.0))
    edge = edge[np.argsort(X[edge, 0])]
    facets = np.column_stack([edge[:-1], edge[1:]]).astype(np.int32)
    fixed = (rng.random(2 * n) < 0.1).astype(np.uint8)
    if held:
        fixed[2 * offsets[1] : 2 * offsets[2]] = 1
    free = np.flatnonzero(~fixed.reshape(-1, 2).any(axis=1))
    sliding = rng.permutation(free)[: n // 8].astype(np.int32)
    kept = np.tile([0.36, 0.48, 0.64], (len(sliding), 1))
    alone_offsets = np.array([0, n], dtype=np.int32)

    def new(world):
        made = k.Operator(world, 2, offsets if world else alone_offsets, WORLD.rank if world else 0)
        made.set_topology([cells, facets])
        made.set_constraints(fixed)
        made.set_sliding(sliding, kept)
        return made

    warm, held_mats = new(True), []
    found = {"cold": 0.0, "alone": 0.0, "right": 0.0, "product": 0.0, "grown": 0, "ghosts": 0}
    for _ in range(drags):
        before, ghosts = warm.nnz, ghost_count(warm)
        # A solver may hold the matrix of some frames ago, or the rank's own part of it.
        held_mats = [*held_mats[-2:], warm.mat.getDiagonalBlock()]
        changed = flip_edges(X, cells, int(rng.integers(1, 3)), rng)
        warm.patch(0, changed)
        found["grown"] += int(warm.nnz > before)
        found["ghosts"] += int(ghost_count(warm) > ghosts)
        Y = X @ (np.eye(2) + 0.1 * rng.uniform(-1, 1, (2, 2)))
        x = 0.05 * rng.uniform(-1, 1, X.shape)
        chosen = rng.integers(0, len(facets), len(facets)).astype(np.int32)
        cold, alone, rights = new(True), new(False), np.zeros((3, 2 * n))
        for op, right in zip((warm, cold, alone), rights, strict=True):
            fill(op, Y, x, facets, chosen, right)
        patched, again, whole = dense(warm), dense(cold), dense(alone)
        own = slice(2 * offsets[WORLD.rank], 2 * offsets[WORLD.rank + 1])
        scale = np.abs(whole).max()
        gaps = {
            "cold": np.abs(patched - again).max() / scale,
            "alone": np.abs(patched - whole).max() / scale,
            "right": np.abs(rights[:, own] - rights[2, own]).max(initial=0.0) / np.abs(rights[2]).max(),
            "product": np.abs(product(warm, x.ravel()) - whole @ x.ravel()).max() / scale,
        }
        found.update({name: max(found[name], float(gap)) for name, gap in gaps.items()})
        assert np.all(patched[fixed.astype(bool)][:, ~fixed.astype(bool)] == 0.0)
    norms = [mat.norm() for mat in held_mats]
    assert np.all(np.isfinite(norms))
    return found


def ghost_count(op) -> int:
    """How many columns of other ranks' unknowns this rank's rows have."""
    _, column, _ = op.mat.getValuesCSR()
    first, last = op.mat.getOwnershipRange()
    return len(np.unique(column[(column < first) | (column >= last)]))


def main() -> None:
    rng = np.random.default_rng(5)
    drags = int(sys.argv[1])
    found = {}
    for name, *body in bodies(rng):
        own = driven(*body, drags if name in ("square", "pieces") else 4, rng)
        rows = RANKS.allgather(own)
        found[name] = {key: max(row[key] for row in rows) for key in own}
    if WORLD.rank == 0:
        print(json.dumps(found))


main()
