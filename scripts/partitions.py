"""Partitions of a plate's nodes: recursive inertial bisection beside PT-Scotch, which PETSc calls.

mpiexec -n RANKS python scripts/partitions.py [TRIANGLES ...]

Without numbers: 20000 and 200000 triangles of `plate.toml`. Into as many parts as there are ranks: edges of the mesh
that join two parts, nodes of other parts next to one's own (largest sum of a rank, as a share of an even part), nodes
and cells of the largest part over an even share, and the processor time of the slowest rank, the least of several.
Ranks that take turns on a core are measured likewise. PT-Scotch's time holds the graph of the nodes, which it needs,
and bisection none; sending the mesh or the parts is left out of both.
"""

import sys
import time
from collections.abc import Callable
from math import sqrt

import numpy as np
from petsc4py import PETSc
from restshape_apps.solid import application
from restshape_studies.bench.order import sizes

from restshape.arrays import Indices
from restshape.cli.options import print_table
from restshape.mesh.generate import generate
from restshape.mesh.mesh import Mesh
from restshape.mesh.partition import node_owners
from restshape.scene.load import load_scene
from restshape.shape.build import outline_from_spec

SCENE = application.folder / "scenes" / "plate.toml"
ROUNDS = 5
HEADS = ("triangles", "ranks", "partition", "edges cut", "nodes next to a part", "nodes", "cells", "time [ms]")


def plate(triangles: float) -> Mesh:
    """A mesh of the plate with about so many triangles, its nodes numbered along one curve."""
    scene = load_scene(SCENE)
    outline = outline_from_spec(scene.shape, scene.folder)
    of_scene = len(generate(outline, scene.mesh).cells)
    return generate(outline, load_scene(SCENE, sizes(scene, sqrt(of_scene / triangles))).mesh)


def bisection(mesh: Mesh, world: PETSc.Comm) -> Indices:
    """Owners (n,) by restshape's own."""
    return node_owners(mesh.X, world.size)


def scotch(mesh: Mesh, world: PETSc.Comm) -> Indices:
    """Owners (n,) by PT-Scotch, of consecutive rows that each rank has."""
    first, end = (len(mesh.X) * rank // world.size for rank in (world.rank, world.rank + 1))
    begins, neighbours = rows_of(mesh, first, end)
    size = ((end - first, len(mesh.X)), (end - first, len(mesh.X)))
    graph = PETSc.Mat().createAIJ(size, csr=(begins, neighbours, np.ones(len(neighbours))), comm=world)
    partition, found = PETSc.MatPartitioning().create(world), PETSc.IS().create(world)
    partition.setAdjacency(graph)
    partition.setType("ptscotch")
    partition.apply(found)
    owners = np.concatenate(world.tompi4py().allgather(found.getIndices()))
    for one in (partition, found, graph):
        one.destroy()
    return owners


def rows_of(mesh: Mesh, first: int, end: int) -> tuple[Indices, Indices]:
    """Where each of the rows of nodes begins, and the nodes next to them, ascending."""
    ends = mesh.edge_nodes
    pairs = np.concatenate([ends, ends[:, ::-1]])
    own = pairs[(pairs[:, 0] >= first) & (pairs[:, 0] < end)]
    own = own[np.lexsort(own.T[::-1])]
    begins = np.searchsorted(own[:, 0], np.arange(first, end + 1)).astype(PETSc.IntType)
    return begins, own[:, 1].astype(PETSc.IntType)


def qualities(mesh: Mesh, owners: Indices, ranks: int) -> tuple[str, ...]:
    """Edges cut, nodes next to a part over an even part, largest parts in nodes and in cells over an even one."""
    ends, even = owners[mesh.edge_nodes], len(mesh.X) / ranks
    across = ends[:, 0] != ends[:, 1]
    borders, cut = mesh.edge_nodes[across], ends[across]
    beside = np.unique(np.concatenate([np.column_stack([cut[:, i], borders[:, 1 - i]]) for i in (0, 1)]), axis=0)
    corners = np.sort(owners[mesh.cells], axis=1)
    new = np.column_stack([np.ones(len(corners), dtype=bool), np.diff(corners, axis=1) != 0])
    cells = np.bincount(corners[new], minlength=ranks)
    return (
        f"{len(borders):,}",
        f"{100.0 * np.bincount(beside[:, 0], minlength=ranks).max() / even:.2f} %",
        f"{np.bincount(owners, minlength=ranks).max() / even:.4f}",
        f"{cells.max() * ranks / len(corners):.4f}",
    )


def timed(part: Callable[[Mesh, PETSc.Comm], Indices], mesh: Mesh, world: PETSc.Comm) -> tuple[Indices, float]:
    """Owners, and the least processor time [ms] that the slowest rank takes."""
    ranks, best, owners = world.tompi4py(), np.inf, np.empty(0, dtype=np.int32)
    for _ in range(ROUNDS):
        ranks.Barrier()
        start = time.process_time()
        owners = part(mesh, world)
        best = min(best, max(ranks.allgather(1e3 * (time.process_time() - start))))
    return owners, best


def main() -> None:
    """Print the table of each size."""
    world = PETSc.COMM_WORLD
    rows = []
    for triangles in map(float, sys.argv[1:] or ("2e4", "2e5")):
        mesh = plate(triangles)
        for name, part in (("bisection", bisection), ("PT-Scotch", scotch)):
            owners, ms = timed(part, mesh, world)
            row = (f"{len(mesh.cells):,}", str(world.size), name, *qualities(mesh, owners, world.size), f"{ms:.1f}")
            rows.append(row)
    if world.rank == 0:
        print_table("partitions of the plate's nodes", HEADS, rows, right=HEADS[3:])


if __name__ == "__main__":
    main()
