"""Outlines of several pieces, each meshed as if it were alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from restshape.mesh.boundary import Boundary
from restshape.scene.model import MeshSpec
from restshape.shape.outline import Layout, Outline

GRID = 2.0**-42
"""Step of the grid that points of pieces are rounded to, over the size of the outline: 2e-13 of it."""


def parts(outline: Outline) -> list[Outline]:
    """The pieces of an outline, each an outline of its own whose first vertex is the origin.

    Its points are rounded to a grid far finer than any clearance: rounding of where it lies beside the others would
    decide which diagonal of a square the mesher takes. So the mesh of a piece does not hang on its place.
    """
    return [_part(outline, k) for k in range(len(outline.piece_names))]


def own_spec(part: Outline, spec: MeshSpec) -> MeshSpec:
    """The sizes that concern a piece: those at its own entities."""
    there = {*part.layout.entities, *part.groups}
    near = {name: size for name, size in spec.near.items() if name in there}
    return spec if len(near) == len(spec.near) else spec.model_copy(update={"near": near})


def joined(
    outline: Outline, meshes: Sequence[tuple[Boundary, np.ndarray, np.ndarray, object]]
) -> tuple[Boundary, np.ndarray, np.ndarray]:
    """One boundary, all nodes (n, 2) [m] and triangles (ne, 3) of the pieces of an outline, from their own meshes."""
    count = len(outline.vertex_names)
    chains: list[np.ndarray] = [np.empty(0, dtype=np.int32)] * len(outline.edges)
    edge, param = np.full(count, -1, dtype=np.int32), np.zeros(count)
    on_edges, edges, params, inside, triangles = [], [edge], [param], [], []
    numbers = []
    first = count
    for k, (boundary, X, _, _) in enumerate(meshes):
        vertices, own = _vertices(outline, k), np.flatnonzero(outline.layout.edge_piece == k)
        n, added = len(vertices), len(boundary.points) - len(vertices)
        origin = outline.points[vertices[0]]
        number = np.concatenate([vertices, np.arange(first, first + added), np.full(len(X) - n - added, -1)])
        first += added
        of_edge = np.where(boundary.edge >= 0, own[boundary.edge], -1)
        edge[vertices], param[vertices] = of_edge[:n], boundary.param[:n]
        edges.append(of_edge[n:])
        params.append(boundary.param[n:])
        on_edges.append(X[n : n + added] + origin)
        inside.append(X[n + added :] + origin)
        numbers.append(number)
        for i, chain in zip(own, boundary.chains):
            chains[i] = number[chain].astype(np.int32)
    for number, (_, _, cells, _) in zip(numbers, meshes):
        free = number < 0
        number[free] = np.arange(first, first + np.count_nonzero(free))
        first += int(np.count_nonzero(free))
        triangles.append(number[cells])
    points = np.concatenate([outline.points[:count], *on_edges])
    whole = Boundary(points, np.concatenate(edges).astype(np.int32), np.concatenate(params), tuple(chains))
    return whole, np.concatenate([points, *inside]), np.concatenate(triangles).astype(np.int32)


def _vertices(outline: Outline, piece: int) -> np.ndarray:
    """Numbers of the vertices of a piece."""
    return np.flatnonzero(outline.layout.control_piece[: len(outline.vertex_names)] == piece)


def _part(outline: Outline, piece: int) -> Outline:
    layout = outline.layout
    own = np.flatnonzero(layout.control_piece == piece)
    row = np.full(len(layout.control_piece), -1)
    row[own] = np.arange(len(own))
    edges = np.flatnonzero(layout.edge_piece == piece)
    edge_row = {int(e): i for i, e in enumerate(edges)}
    loops = [replace(loop, piece=0) for loop in layout.loops if loop.piece == piece]
    names = tuple(layout.vertex_names[i] for i in _vertices(outline, piece))
    there = {*names, *(layout.edges[e].name for e in edges), *(loop.name for loop in loops)}
    made = Layout(
        names,
        tuple(
            replace(
                layout.edges[e],
                start=int(row[layout.edges[e].start]),
                end=int(row[layout.edges[e].end]),
                inner=tuple(int(row[i]) for i in layout.edges[e].inner),
            )
            for e in edges
        ),
        tuple(replace(loop, edges=tuple((edge_row[e], forward) for e, forward in loop.edges)) for loop in loops),
        tuple(int(row[i]) for i in layout.embedded if layout.control_piece[i] == piece),
        {
            name: inside
            for name, members in layout.groups.items()
            if (inside := tuple(m for m in members if m in there))
        },
        layout.size,
    )
    step = 2.0 ** np.floor(np.log2(layout.size)) * GRID
    points = np.round((outline.points[own] - outline.points[own[0]]) / step) * step
    return Outline(made, np.ascontiguousarray(points), outline.bulges[edges])
