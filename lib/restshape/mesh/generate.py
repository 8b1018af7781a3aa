"""Triangle meshes of outlines, generated from the outline (level 3)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np

from restshape import _kernels
from restshape.errors import ReplayProblem
from restshape.mesh.boundary import Boundary, discretise
from restshape.mesh.crossing import first_crossing
from restshape.mesh.delaunay import refine, uses_cgal
from restshape.mesh.mesh import Mesh
from restshape.mesh.numbering import cell_order, node_order
from restshape.mesh.partition import node_owners
from restshape.mesh.piece_meshes import joined, own_spec, parts
from restshape.mesh.regions import cell_regions, contains, signed_area
from restshape.mesh.sizing import GRADING, sizing_of
from restshape.scene.model import MeshSpec
from restshape.shape.outline import Loop, Outline

EVEN = 1e-3
"""Mesh edges of one chain whose lengths differ by less than this share count as equally long."""

SWEEPS = 3
"""Smoothing sweeps after Delaunay refinement: each costs 1 % of the mesher and they raise the mean quality by 0.08."""


T = TypeVar("T")


class Shared(Protocol):
    """Calls functions at once, each on one rank; all have the results of all, or the first error is raised on all."""

    def __call__(self, *makes: Callable[[], T]) -> list[T]: ...


def alone(*makes: Callable[[], T]) -> list[T]:
    """The results of functions that one rank calls."""
    return [make() for make in makes]


def generate(outline: Outline, spec: MeshSpec, ranks: int = 1, shared: Shared = alone) -> Mesh:
    """A mesh of an outline that resolves all its entities; the same input gives the same mesh, bit for bit.

    Args:
        outline: a valid shape.
        spec: the scene's ``MeshSpec``: `size` [m], `near`, smaller sizes [m] at entities, and `mesher`.
        ranks: number of ranks; nodes are grouped by the rank that owns them.
        shared: how ranks share the work: one of them refines, and all number and connect, which takes less than to
            send a mesh with its edges.

    Raises:
        ReplayProblem: this shape cannot be meshed.
        UserError: `near` names an entity that is not there.
    """
    ((boundary, X, cells, known),) = shared(lambda: _all_refined(outline, spec))
    return assemble(outline, boundary, X, cells, ranks, known, shared)


Refined = tuple[Boundary, np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray] | None]
"""A boundary with its nodes, all nodes (n, 2) [m], triangles (ne, 3), and facets with their edges where known."""


def _all_refined(outline: Outline, spec: MeshSpec) -> Refined:
    """Nodes and triangles of all pieces, in any order; errors as of `generate`."""
    if outline.piece_names == ("outline",):
        return _refined(outline, spec)
    sizing_of(outline, spec)
    return (*joined(outline, [_refined(part, own_spec(part, spec)) for part in parts(outline)]), None)


def _refined(outline: Outline, spec: MeshSpec) -> Refined:
    """Nodes and triangles of one piece, in any order.

    Raises:
        ReplayProblem: this shape cannot be meshed.
    """
    sizing = sizing_of(outline, spec)
    boundary = discretise(outline, sizing)
    facets, facet_edge = _facets(outline, boundary)
    if uses_cgal(spec.mesher):
        border = np.array(_on_border(outline), dtype=np.uint8)[facet_edge]
        refined = refine(outline, boundary, facets, facet_edge, border, sizing)
        if refined is not None:
            _kernels.smooth_fresh(*refined[1:], len(refined[0].points), SWEEPS)
            return (*refined, (facets, facet_edge) if refined[0] is boundary else None)
    # Also where CGAL fails: gmsh shows why, or finds a way.
    from restshape.mesh.mesher import triangulate

    _refuse_crossing(outline, boundary, facets, facet_edge)
    runs, runs_of = _runs(boundary)
    inside = [i for i, around in enumerate(_on_border(outline)) if not around]
    X, cells = triangulate(
        boundary.points,
        runs,
        [_signed_runs(loop.edges, runs_of) for loop in _border_loops(outline)],
        [run for edge in inside for run in runs_of[edge]],
        np.array(outline.embedded, dtype=np.int64),
        sizing.size,
        [(attractor.points, attractor.size, GRADING) for attractor in sizing.attractors],
    )
    _refuse_broken(outline, boundary, X, cells)
    _kernels.smooth_fresh(X, cells, len(boundary.points), SWEEPS)
    return boundary, X, cells, None


def assemble(
    outline: Outline,
    boundary: Boundary,
    X: np.ndarray,
    cells: np.ndarray,
    ranks: int,
    known: tuple[np.ndarray, np.ndarray] | None = None,
    shared: Shared = alone,
) -> Mesh:
    """A mesh with its nodes and cells in their final order.

    Args:
        outline: the shape; boundary: its nodes, the first rows of X.
        X: (n, 2) [m]; cells: (ne, 3) counter-clockwise; ranks: number of ranks.
        known: facets of the boundary and their edges, where there are any.
        shared: as of `generate`, of ranks that all have these arrays.

    Raises:
        ReplayProblem: an edge of the outline is not made of sides of triangles.
    """
    curve, owner = shared(lambda: node_order(X), lambda: node_owners(X, ranks).astype(np.int16))
    owner = owner[curve]
    by_owner = np.argsort(owner, kind="stable")
    order = curve[by_owner]
    number = np.empty(len(X), dtype=np.int32)
    number[order] = np.arange(len(X), dtype=np.int32)
    X, cells = X[order], number[cells]
    cells = cells[cell_order(cells, len(X))]
    facets, facet_edge = known or _facets(outline, boundary)
    facets = number[facets]
    node_edge, node_param = np.full(len(X), -1, dtype=np.int32), np.zeros(len(X))
    on_boundary = number[: len(boundary.points)]
    node_edge[on_boundary], node_param[on_boundary] = boundary.edge, boundary.param
    mesh = Mesh.build(
        X,
        cells,
        outline,
        facets=facets,
        facet_edge=facet_edge,
        node_edge=node_edge,
        node_param=node_param,
        vertex_node=number[: len(outline.vertex_names)],
        node_offsets=np.searchsorted(owner[by_owner], np.arange(ranks + 1)),
        places=by_owner.astype(np.int32) if ranks > 1 else None,
    )
    if mesh.facet_cell.min() < 0:
        name = outline.edges[facet_edge[np.argmin(mesh.facet_cell)]].name
        raise ReplayProblem(f"the shape cannot be meshed: edge {name!r} is lost in the mesh")
    polygons = [X[number[_loop_nodes(loop.edges, boundary)]] for loop in outline.loops if loop.kind == "region"]
    if polygons:
        barrier = np.zeros(len(mesh.edge_nodes), dtype=bool)
        ends = np.sort(facets, axis=1).astype(np.int64) @ (len(X), 1)
        barrier[np.searchsorted(mesh.edge_nodes.astype(np.int64) @ (len(X), 1), ends)] = True
        mesh.cell_region = cell_regions(X, cells, mesh.cell_edges, barrier, polygons)
    return mesh


def _border_loops(outline: Outline) -> list[Loop]:
    """The outline's loop first, then the holes."""
    return sorted((loop for loop in outline.loops if loop.kind != "region"), key=lambda loop: loop.kind != "outline")


def _on_border(outline: Outline) -> list[bool]:
    """For each edge whether it bounds the material."""
    border = {edge for loop in _border_loops(outline) for edge, _ in loop.edges}
    return [edge in border for edge in range(len(outline.edges))]


def _runs(boundary: Boundary) -> tuple[list[np.ndarray], list[list[int]]]:
    """Chains of equally spaced nodes, and for each outline edge the numbers, from 1, of its runs."""
    runs: list[np.ndarray] = []
    runs_of: list[list[int]] = []
    for chain in boundary.chains:
        lengths = np.hypot(*np.diff(boundary.points[chain], axis=0).T).tolist()
        own, first = [], 0
        for i in range(1, len(lengths) + 1):
            closes = chain[first] == chain[i]
            if i == len(lengths) or closes or abs(lengths[i] - lengths[first]) > EVEN * lengths[first]:
                runs.append(chain[first : i + 1])
                own.append(len(runs))
                first = i
        # gmsh takes a run that ends where it starts for a periodic curve.
        if len(own) == 1 and chain[0] == chain[-1]:
            half = len(chain) // 2
            runs[-1:] = [chain[: half + 1], chain[half:]]
            own.append(len(runs))
        runs_of.append(own)
    return runs, runs_of


def _signed_runs(edges: tuple[tuple[int, bool], ...], runs_of: list[list[int]]) -> list[int]:
    """Runs of a loop in its direction, negative where they are passed backwards."""
    found: list[int] = []
    for edge, forward in edges:
        found += runs_of[edge] if forward else [-run for run in reversed(runs_of[edge])]
    return found


def _loop_nodes(edges: tuple[tuple[int, bool], ...], boundary: Boundary) -> np.ndarray:
    """Nodes of a loop in its direction, each once."""
    chains = [boundary.chains[edge] if forward else boundary.chains[edge][::-1] for edge, forward in edges]
    return np.concatenate([chain[:-1] for chain in chains])


def _facets(outline: Outline, boundary: Boundary) -> tuple[np.ndarray, np.ndarray]:
    """Directed node pairs (nf, 2) on all outline edges, material on the left, and their edges (nf,)."""
    loops = [*_border_loops(outline), *(loop for loop in outline.loops if loop.kind == "region")]
    direction: dict[int, bool] = {}
    for loop in loops:
        for edge, forward in loop.edges:
            direction.setdefault(edge, forward)
    chains = [chain if direction.get(i, True) else chain[::-1] for i, chain in enumerate(boundary.chains)]
    sides = [len(chain) - 1 for chain in chains]
    pairs = np.empty((sum(sides), 2), dtype=np.int32)
    np.concatenate([chain[:-1] for chain in chains], out=pairs[:, 0])
    np.concatenate([chain[1:] for chain in chains], out=pairs[:, 1])
    return pairs, np.repeat(np.arange(len(chains), dtype=np.int32), sides)


def _areas(X: np.ndarray, cells: np.ndarray) -> np.ndarray:
    """Twice the signed areas (ne,) of triangles [m^2]."""
    x, y = X[:, 0][cells].T, X[:, 1][cells].T
    return (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0])


def _refuse_crossing(outline: Outline, boundary: Boundary, facets: np.ndarray, facet_edge: np.ndarray) -> None:
    """Refuse a boundary that crosses or touches itself, and holes and points outside the material.

    Raises:
        ReplayProblem: with the edges that meet, or with what lies outside.
    """
    single = np.repeat(np.array(outline.embedded, dtype=np.int64), 2).reshape(-1, 2)
    met = first_crossing(boundary.points, np.concatenate([facets, single]))
    if met is not None:
        names = [outline.edges[facet_edge[i]].name if i < len(facets) else "an embedded point" for i in met]
        raise ReplayProblem(f"the shape cannot be meshed: {' and '.join(names)} meet at this mesh size")
    outer, *holes = [boundary.points[_loop_nodes(loop.edges, boundary)] for loop in _border_loops(outline)]
    probes = np.concatenate([boundary.points[single[:, 0]], *(hole[:1] for hole in holes)])
    outside = ~contains(outer, probes)
    for i, hole in enumerate(holes):
        own = len(single) + i
        outside |= contains(hole, probes) & (np.arange(len(probes)) != own)
    if outside.any():
        x, y = probes[np.argmax(outside)]
        raise ReplayProblem(f"the shape cannot be meshed: the point ({x:.6g}, {y:.6g}) m lies outside the material")


def _refuse_broken(outline: Outline, boundary: Boundary, X: np.ndarray, cells: np.ndarray) -> None:
    """Refuse a mesh that does not fill its boundary, or that has lost a node or a facet of it.

    Raises:
        ReplayProblem: with what is wrong.
    """
    if not len(cells) or cells.min() < 0:
        raise ReplayProblem("the shape cannot be meshed: the mesher left its boundary")
    double = _areas(X, cells)
    if np.sum(double) < 0.0:
        cells[:, 1:] = cells[:, :0:-1].copy()
        double = -double
    wanted = sum(signed_area(boundary.points[_loop_nodes(loop.edges, boundary)]) for loop in _border_loops(outline))
    if double.min() <= 0.0 or abs(0.5 * double.sum() - wanted) > 1e-9 * abs(wanted):
        raise ReplayProblem("the shape cannot be meshed: its boundary touches or crosses itself at this mesh size")
    used = np.zeros(len(X), dtype=bool)
    used[cells] = True
    if not used.all():
        x, y = X[np.argmin(used)]
        raise ReplayProblem(f"the shape cannot be meshed: the point ({x:.6g}, {y:.6g}) m lies outside the material")
