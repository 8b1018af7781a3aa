"""A mesh of the channel with a cylinder that is symmetric about the cylinder's middle, from the mesh of a half.

The cylinder's lift is two thousandths of its drag: on a mesh without this symmetry the part of the drag's error that
points across is as large as a percent of the lift.
"""

from pathlib import Path

import meshio
import numpy as np
from petsc4py import PETSc
from restshape_studies.stability.scenery import head, write_scene

from restshape.interface.first_frame import first_frame

MIDDLE, TOP, STRETCHED = 0.2, 0.41, 0.1
"""Heights [m] of the cylinder's middle and of the channel; above the middle by more than the last it is stretched."""
HALF = (
    head("flow")
    + """
[shape]
outline = ["wall", "outlet", "behind", "cylinder", "before", "inlet"]
vertices = { a = [0, 0], b = [2.2, 0], c = [2.2, 0.2], d = [0.25, 0.2], e = [0.15, 0.2], f = [0, 0.2] }
[shape.edges]
wall = { line = ["a", "b"] }
outlet = { line = ["b", "c"] }
behind = { line = ["c", "d"] }
cylinder = { arc = ["d", "e"], through = [0.2, 0.15] }
before = { line = ["e", "f"] }
inlet = { line = ["f", "a"] }
[shape.regions.zone]
polygon = [[0.06, 0.06], [0.6, 0.06], [0.6, 0.19], [0.27, 0.19], [0.24, 0.14], [0.16, 0.14], [0.13, 0.19], [0.06, 0.19]]
[fluid]
rho = 1
mu = 1
[boundary.outlet]
on = "outlet"
outflow = true
[effects]
flow = { steady = true }
"""
)
NAMES = {"wall": ("bottom", "top"), "cylinder": ("cylinder",) * 2, "inlet": ("inlet",) * 2, "outlet": ("outlet",) * 2}
"""Names of the channel's edges by those of the half, below and above."""


def write_mesh(path: Path, mesh: str, comm: PETSc.Comm) -> None:
    """Writes the mesh of the channel as a file of gmsh, with the edges bottom, outlet, top, inlet and cylinder.

    Args:
        path: of the file; the scene of the half stands beside it.
        mesh: the [mesh] of the half, whose edges are those and `behind`, `before`, and whose region is `zone`.
        comm: of all ranks; the first one writes.
    """
    half = first_frame(write_scene(path.parent, HALF + mesh, "half.toml"), [], comm).analysis.space
    n, X = len(half.X), half.X
    above = np.arange(n, 2 * n)
    on_middle = np.isclose(X[:, 1], MIDDLE, rtol=0.0, atol=1e-9)
    above[on_middle] = np.flatnonzero(on_middle)
    keep = np.unique(np.concatenate([np.arange(n), above]))
    row = np.full(2 * n, -1)
    row[keep] = np.arange(len(keep))
    points = np.concatenate([X, np.column_stack([X[:, 0], _mirrored(X[:, 1])])])[keep]
    cells = row[np.concatenate([half.cells, above[half.cells][:, ::-1]])]
    blocks, groups = [("triangle", cells)], {"fluid": 2}
    for name, (below, over) in NAMES.items():
        facets = half.facets[half.facets_of(name)]
        parts = {below: [row[facets]]}
        parts.setdefault(over, []).append(row[above[facets][:, ::-1]])
        for own, found in parts.items():
            blocks.append(("line", np.concatenate(found)))
            groups[own] = 1
    tags = [np.full(len(rows), tag) for tag, (_, rows) in enumerate(blocks, start=1)]
    made = meshio.Mesh(
        np.column_stack([points, np.zeros(len(points))]),
        blocks,
        cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
        field_data={name: np.array([tag, dim]) for tag, (name, dim) in enumerate(groups.items(), start=1)},
    )
    if comm.rank == 0:
        meshio.write(path, made, file_format="gmsh22", binary=False)
    comm.barrier()


def _mirrored(y: np.ndarray) -> np.ndarray:
    """Heights (n,) above the middle of heights (n,) below it: as far from it near the cylinder, stretched above."""
    away = MIDDLE - y
    part = np.clip((away - STRETCHED) / (MIDDLE - STRETCHED), 0.0, 1.0)
    return MIDDLE + away + (TOP - 2.0 * MIDDLE) * part**2 * (3.0 - 2.0 * part)
