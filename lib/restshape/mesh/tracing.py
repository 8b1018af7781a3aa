"""The outline that a triangle mesh from elsewhere fills: edges cut at corners and where a group begins."""

from __future__ import annotations

import logging
from collections import defaultdict, deque
from dataclasses import dataclass, field

import numpy as np

from restshape.errors import UserError
from restshape.mesh.boundary import Boundary
from restshape.mesh.hinges import inner_sides
from restshape.mesh.imported_curves import Middles, curved_middles, cut_at_arcs, imported_edge, on_one_circle
from restshape.mesh.mesh import edges_of_cells
from restshape.mesh.regions import contains, signed_area
from restshape.shape.draft import Draft
from restshape.shape.outline import RESERVED, Outline

log = logging.getLogger(__name__)

CORNER = np.radians(30.0)
"""An outline that turns by more than this at a node has a vertex there."""
BENDS, ROUND = np.radians(25.0), np.radians(45.0) + 1e-6
"""Between these a circle of few sides turns at its nodes, of curved sides up to twice as much: none is a vertex."""

Ways = dict[int, list[tuple[int, int]]]
"""Segments that meet at a node, each with the node at its other end."""
MOST_POINTS = 20
"""Inner nodes of one node set that become embedded points; a set with more of them is no list of points."""


@dataclass
class Triangles:
    """Triangles of a file and its groups.

    Args:
        X: (n, 2) [m]; cells: (ne, 3); lines: (nl, 2) line elements.
        sides: (nm, 2) ends, the smaller first, of sides with a node in their middle; middles: (nm, 2) its place [m].
        groups: by name, what belongs to it: "nodes", "lines" and "cells" as rows of X, lines, cells.
    """

    X: np.ndarray
    cells: np.ndarray
    lines: np.ndarray
    groups: dict[str, dict[str, np.ndarray]] = field(default_factory=dict)
    sides: np.ndarray = field(default_factory=lambda: np.empty((0, 2), dtype=np.int64))
    middles: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))

    def add(self, name: str, kind: str, rows: np.ndarray) -> None:
        """Add rows of a kind to a group; a name that every outline has itself gets an underscore."""
        if len(rows):
            own = self.groups.setdefault(name + "_" if name in RESERVED else name, {})
            own[kind] = np.union1d(own.get(kind, rows), rows)

    def keep_nodes(self, used: np.ndarray) -> None:
        """Drop all nodes but `used` (sorted rows of X)."""
        number = np.full(len(self.X), -1, dtype=np.int64)
        number[used] = np.arange(len(used))
        self.X, self.cells, self.lines = self.X[used], number[self.cells], number[self.lines]
        self.sides = np.sort(number[self.sides], axis=1)
        for own in self.groups.values():
            if "nodes" in own:
                own["nodes"] = number[own["nodes"]]
                own["nodes"] = own["nodes"][own["nodes"] >= 0]


@dataclass
class Patches:
    """Triangles that belong to the same groups and hang together.

    Args:
        of_cell: (ne,) patch; groups: group names of each patch; rings: its closed border chains, the outer one first.
    """

    of_cell: np.ndarray
    groups: list[tuple[str, ...]]
    rings: list[list[np.ndarray]]


def trace(found: Triangles) -> tuple[Outline, Boundary, np.ndarray, np.ndarray]:
    """Outline, its nodes, and the mesh with these first: positions (n, 2) and triangles (ne, 3).

    Raises:
        UserError: the mesh is not in one piece, or touches itself at a node.
    """
    edges, cell_edges = edges_of_cells(found.cells, len(found.X))
    border = np.bincount(cell_edges.ravel(), minlength=len(edges)) == 1
    rings = _border_rings(found, cell_edges, border)
    patches = _patches(found, edges, cell_edges, border)
    traced = border | _between(cell_edges, patches.of_cell, len(edges))
    marks, loose = _marks(found, edges, border, traced)
    curved = curved_middles(found.X, found.sides, found.middles, edges[traced])
    chains = _chains(found.X, edges[traced], {name: mark[traced] for name, mark in marks.items()}, loose, curved)
    chains = [part for chain in chains for part in cut_at_arcs(found.X, chain, curved)]
    return _outline(found, rings, patches, edges, marks, loose, chains, curved)


def _border_rings(found: Triangles, cell_edges: np.ndarray, border: np.ndarray) -> list[np.ndarray]:
    """Closed chains of border nodes, material on the left, the outer one first."""
    pairs = _sides(found.cells)[border[cell_edges.ravel()]]
    twice = np.flatnonzero(np.bincount(pairs[:, 0], minlength=len(found.X)) > 1)
    if len(twice):
        x, y = found.X[twice[0]]
        raise UserError(f"the border touches itself at ({x:.6g}, {y:.6g}) m", do="join or part the elements there")
    rings = _rings(found.X, pairs)
    if signed_area(found.X[rings[0]]) <= 0.0 or (len(rings) > 1 and signed_area(found.X[rings[1]]) > 0.0):
        parts = sum(signed_area(found.X[ring]) > 0.0 for ring in rings)
        raise UserError(f"the mesh is in {parts} separate parts", do="import one part, or join them")
    return rings


def _sides(cells: np.ndarray) -> np.ndarray:
    """Directed sides (3 ne, 2) of triangles, each opposite to its corner."""
    return np.stack([cells[:, (1, 2, 0)].ravel(), cells[:, (2, 0, 1)].ravel()], axis=1)


def _rings(X: np.ndarray, pairs: np.ndarray) -> list[np.ndarray]:
    """Closed chains of directed node pairs, the one around the largest positive area first, then the rest by area."""
    after: dict[int, list[int]] = defaultdict(list)
    for a, b in pairs.tolist():
        after[a].append(b)
    rings = []
    while after:
        first = previous = min(after)
        ring, node = [first], _take(after, first, 0)
        while node != first:
            ring.append(node)
            choices = after[node]
            # Where chains touch, the sharpest right turn keeps each of them free of knots.
            turn = [_turn(X[node] - X[previous], X[choice] - X[node]) for choice in choices]
            previous, node = node, _take(after, node, int(np.argmin(turn)))
        rings.append(np.array(ring))
    return sorted(rings, key=lambda ring: -signed_area(X[ring]))


def _take(after: dict[int, list[int]], node: int, which: int) -> int:
    """Remove and return one of the nodes after a node."""
    found = after[node].pop(which)
    if not after[node]:
        del after[node]
    return found


def _turn(u: np.ndarray, v: np.ndarray) -> float:
    """Angle from u to v, positive to the left."""
    return float(np.arctan2(u[0] * v[1] - u[1] * v[0], u @ v))


def _patches(found: Triangles, edges: np.ndarray, cell_edges: np.ndarray, border: np.ndarray) -> Patches:
    """Patches of the element groups that do not cover the whole mesh."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    names = [name for name, own in found.groups.items() if 0 < len(own.get("cells", ())) < len(found.cells)]
    member = np.zeros((len(found.cells), len(names)), dtype=bool)
    for i, name in enumerate(names):
        member[found.groups[name]["cells"], i] = True
    kinds, kind = np.unique(member, axis=0, return_inverse=True) if names else (member[:1], np.zeros(len(member), int))
    kind = kind.ravel()
    left, right = inner_sides(cell_edges).T // 3
    same = kind[left] == kind[right]
    links = coo_array((np.ones(same.sum(), dtype=bool), (left[same], right[same])), shape=(len(kind), len(kind)))
    count, of_cell = connected_components(links, directed=False)
    outside = border | _between(cell_edges, of_cell, len(edges))
    pairs, owner = _sides(found.cells), np.repeat(of_cell, 3)
    rings, groups = [], []
    for patch in range(count):
        rings.append(_rings(found.X, pairs[(owner == patch) & outside[cell_edges.ravel()]]))
        own = kinds[kind[np.argmax(of_cell == patch)]]
        groups.append(tuple(name for name, inside in zip(names, own) if inside))
    return Patches(of_cell, groups, rings)


def _between(cell_edges: np.ndarray, patch: np.ndarray, count: int) -> np.ndarray:
    """Whether each of `count` mesh edges parts two patches."""
    least, most = np.full(count, len(patch)), np.full(count, -1)
    np.minimum.at(least, cell_edges.ravel(), np.repeat(patch, 3))
    np.maximum.at(most, cell_edges.ravel(), np.repeat(patch, 3))
    return least != most


def _marks(
    found: Triangles, edges: np.ndarray, border: np.ndarray, traced: np.ndarray
) -> tuple[dict[str, np.ndarray], dict[str, list[int]]]:
    """Mesh edges (n_edges,) of each group, and the single nodes of each group."""
    key = edges.astype(np.int64) @ (len(found.X), 1)
    marks, loose = {}, {}
    for name, own in found.groups.items():
        mark = np.zeros(len(edges), dtype=bool)
        if "lines" in own:
            ends = np.sort(found.lines[own["lines"]], axis=1) @ (len(found.X), 1)
            place = np.minimum(np.searchsorted(key, ends), len(key) - 1)
            mark[place[key[place] == ends]] = True
            if (mark & ~traced).any() or (key[place] != ends).any():
                log.warning("group %r: lines inside a region are left out", name)
        nodes = own.get("nodes", np.empty(0, dtype=np.int64))
        if len(nodes) < len(found.X):
            inside = np.zeros(len(found.X), dtype=bool)
            inside[nodes] = True
            mark |= border & inside[edges].all(axis=1)
            mark &= traced
            inside[edges[mark]] = False
            single = np.flatnonzero(inside)
            if len(single) > MOST_POINTS:
                log.warning("node set %r: %d nodes that are on no edge of it are left out", name, len(single))
                single = single[:0]
            if len(single):
                loose[name] = single.tolist()
        if mark.any():
            marks[name] = mark & traced
    return marks, loose


def _chains(
    X: np.ndarray,
    segments: np.ndarray,
    marks: dict[str, np.ndarray],
    loose: dict[str, list[int]],
    curved: Middles,
) -> list[np.ndarray]:
    """Chains of nodes between the outline's vertices, which cover all segments (m, 2)."""
    ways: Ways = defaultdict(list)
    for i, (a, b) in enumerate(segments.tolist()):
        ways[a].append((i, b))
        ways[b].append((i, a))
    table = np.array(list(marks.values()), dtype=bool).reshape(len(marks), len(segments)).T
    stops = {node for nodes in loose.values() for node in nodes if node in ways}
    corners, bends = set(), set()
    for node, around in ways.items():
        (i, a), (j, b) = around[0], around[-1]
        if len(around) != 2 or (table[i] != table[j]).any():
            stops.add(node)
            continue
        turn = abs(_turn(X[node] - X[a], X[b] - X[node]))
        if turn > CORNER:
            corners.add(node)
        arcs = all((min(node, other), max(node, other)) in curved for other in (a, b))
        if BENDS < turn <= (2.0 if arcs else 1.0) * ROUND:
            bends.add(node)
    stops.update(corners - _on_circles(X, ways, bends - stops, curved))
    left = set(range(len(segments)))
    chains = []
    for start in [*sorted(stops), *sorted(ways)]:
        for i, node in ways[start]:
            if i in left:
                chain = _walk(ways, stops | {start}, left, start, i, node)
                if chain[0] == chain[-1]:
                    half = len(chain) // 2
                    stops.update((start, chain[half]))
                    chains += [chain[: half + 1], chain[half:]]
                else:
                    chains.append(chain)
    return [np.array(chain) for chain in chains]


def _on_circles(X: np.ndarray, ways: Ways, bends: set[int], curved: Middles) -> set[int]:
    """Those of some nodes in whose runs all, with the nodes beside the run, are on one circle of many nodes."""
    found, left = set(), set(bends)
    while left:
        node = left.pop()
        run = deque([node])
        for end in (0, -1):
            beside = ways[node][end][1]
            previous = node
            while True:
                run.appendleft(beside) if end == 0 else run.append(beside)
                if beside not in left:
                    break
                left.discard(beside)
                previous, beside = beside, next(other for _, other in ways[beside] if other != previous)
            if end == 0 and run[0] == node:
                break
        if on_one_circle(X, run, curved):
            found.update(bends.intersection(run))
    return found


def _walk(ways: Ways, stops: set[int], left: set[int], start: int, segment: int, node: int) -> list[int]:
    """Nodes from a start through a segment up to the next stop; the segments passed are taken out of `left`."""
    chain = [start, node]
    left.discard(segment)
    while node not in stops:
        segment, node = next((i, other) for i, other in ways[node] if i in left)
        left.discard(segment)
        chain.append(node)
    return chain


@dataclass
class Names:
    """Names of entities: a group with a single member lends it its name; others number their members."""

    members: dict[str, list[tuple[str, int]]]
    taken: set[str] = field(default_factory=set)
    of: dict[tuple[str, int], str] = field(default_factory=dict)
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def name_all(self, counts: dict[str, int]) -> None:
        """Name all members: `counts` has the number of edges ("edge"), vertices ("v") and regions ("region")."""
        self.taken.update(self.members)
        for name, own in self.members.items():
            if len(own) == 1 and own[0] not in self.of:
                self.of[own[0]] = name
        for kind, count in counts.items():
            for i in range(count):
                if (kind, i) not in self.of:
                    self.of[kind, i] = self._free(f"{kind}.{i + 1}")
        for name, own in self.members.items():
            if self.of.get(own[0]) != name:
                self.groups[name] = tuple("all" if member == ("all", 0) else self.of[member] for member in own)

    def _free(self, name: str) -> str:
        while name in self.taken:
            name += "_"
        self.taken.add(name)
        return name


def _outline(
    found: Triangles,
    rings: list[np.ndarray],
    patches: Patches,
    edges: np.ndarray,
    marks: dict[str, np.ndarray],
    loose: dict[str, list[int]],
    chains: list[np.ndarray],
    curved: Middles,
) -> tuple[Outline, Boundary, np.ndarray, np.ndarray]:
    """The outline of chains, its nodes, and the mesh with these first."""
    regions = _regions(found.X, found.cells, patches)
    embedded = sorted({n for nodes in loose.values() for n in nodes} - set(np.concatenate(chains).tolist()))
    vertices = list(dict.fromkeys([*(int(n) for chain in chains for n in (chain[0], chain[-1])), *embedded]))
    place = {node: i for i, node in enumerate(vertices)}
    key = edges.astype(np.int64) @ (len(found.X), 1)
    first = np.searchsorted(key, [int(min(c[:2])) * len(found.X) + int(max(c[:2])) for c in chains])
    members: dict[str, list[tuple[str, int]]] = {}
    for name, own in found.groups.items():
        whole = any(len(own.get(kind, ())) == len(of) for kind, of in (("cells", found.cells), ("nodes", found.X)))
        of_name = [("edge", i) for i in np.flatnonzero(marks[name][first])] if name in marks else []
        of_name += [("v", place[node]) for node in loose.get(name, [])]
        of_name += [("region", i) for i, patch in enumerate(regions) if name in patches.groups[patch]]
        members[name] = [("all", 0)] if whole else of_name
    # "all" has a name already, so a group of everything must not lend it another one.
    names = Names({name: own for name, own in members.items() if own}, of={("all", 0): "all"})
    names.name_all({"edge": len(chains), "v": len(vertices), "region": len(regions)})
    draft = Draft(vertices={names.of["v", i]: tuple(found.X[node]) for i, node in enumerate(vertices)})
    X, params = found.X.copy(), []
    for i, chain in enumerate(chains):
        ends = names.of["v", place[int(chain[0])]], names.of["v", place[int(chain[-1])]]
        edge, s = imported_edge(X, chain, curved, names.of["edge", i], ends)
        draft.edges[edge.name] = edge
        params.append(s)
    ways = _ways(chains)
    for i, ring in enumerate(rings):
        loop = "outline" if i == 0 else names._free(f"hole.{i}")
        draft.loops.append((loop, "hole" if i else "outline", _loop(ring, chains, ways, names)))
    for i, patch in enumerate(regions):
        draft.loops.append((names.of["region", i], "region", _loop(patches.rings[patch][0], chains, ways, names)))
    draft.groups = names.groups
    return draft.outline(), *_boundary_first(X, found.cells, vertices, chains, params)


def _regions(X: np.ndarray, cells: np.ndarray, patches: Patches) -> list[int]:
    """Patches that become regions: those of groups, and those of none that lie inside one of them."""
    polygons = {i: X[rings[0]] for i, (rings, own) in enumerate(zip(patches.rings, patches.groups)) if own}
    found = sorted(polygons)
    for i, own in enumerate(patches.groups):
        inside = X[cells[np.argmax(patches.of_cell == i)]].mean(axis=0)[None]
        if not own and any(contains(polygon, inside)[0] for polygon in polygons.values()):
            found.append(i)
    return found


def _ways(chains: list[np.ndarray]) -> dict[tuple[int, int], tuple[int, bool]]:
    """Chain and direction by the first step that a loop takes along it."""
    found = {}
    for i, chain in enumerate(chains):
        found[int(chain[0]), int(chain[1])] = i, True
        found[int(chain[-1]), int(chain[-2])] = i, False
    return found


def _loop(
    ring: np.ndarray, chains: list[np.ndarray], ways: dict[tuple[int, int], tuple[int, bool]], names: Names
) -> list[tuple[str, bool]]:
    """Edges of a ring of nodes, in its direction."""
    steps = list(zip(ring.tolist(), np.roll(ring, -1).tolist()))
    start = next(i for i, step in enumerate(steps) if step in ways)
    found, i = [], start
    while i < start + len(steps):
        chain, forward = ways[steps[i % len(steps)]]
        found.append((names.of["edge", chain], forward))
        i += len(chains[chain]) - 1
    return found


def _boundary_first(
    X: np.ndarray, cells: np.ndarray, vertices: list[int], chains: list[np.ndarray], params: list[np.ndarray]
) -> tuple[Boundary, np.ndarray, np.ndarray]:
    """The nodes on the outline, and the mesh with these first: vertices, then the inner nodes of each chain."""
    order = np.array([*vertices, *(node for chain in chains for node in chain[1:-1])], dtype=np.int64)
    rest = np.setdiff1d(np.arange(len(X)), order)
    number = np.empty(len(X), dtype=np.int32)
    number[np.concatenate([order, rest])] = np.arange(len(X), dtype=np.int32)
    edge, param = np.full(len(order), -1, dtype=np.int32), np.zeros(len(order))
    for i, (chain, s) in enumerate(zip(chains, params)):
        inner = number[chain[1:-1]]
        edge[inner], param[inner] = i, s
        for node, at in ((number[chain[0]], 0.0), (number[chain[-1]], 1.0)):
            if edge[node] < 0:
                edge[node], param[node] = i, at
    boundary = Boundary(X[order], edge, param, tuple(number[chain] for chain in chains))
    return boundary, X[np.concatenate([order, rest])], number[cells]
