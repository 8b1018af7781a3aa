"""Drafts: outlines by name, as they are while being built or cut, before they get indices."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.shape.curves import chord_parameters
from restshape.shape.outline import RESERVED, Edge, Frames, Layout, Loop, Outline
from restshape.shape.pieces import PieceFinder


@dataclass(frozen=True)
class DraftEdge:
    """An edge by names: see :class:`restshape.shape.outline.Edge`; `inner` holds points, `bulge` is tan(angle/4)."""

    name: str
    kind: str
    start: str
    end: str
    parent: str = ""
    inner: tuple[tuple[float, float], ...] = ()
    knots: tuple[float, ...] = ()
    ends: tuple[str, str] = ("natural", "natural")
    bulge: float = 0.0


@dataclass
class Draft:
    """An outline by names.

    Args:
        vertices: points [m] by name, embedded points too.
        edges: by name, in order.
        loops: (name, kind, [(edge name, forward)]), the outlines first; the order may be either way round.
        groups: entity names by group name.
        size: that tolerances are relative to; 0: from the box around the shape.
        frames: as of `Outline`.
    """

    vertices: dict[str, tuple[float, float]] = field(default_factory=dict)
    edges: dict[str, DraftEdge] = field(default_factory=dict)
    loops: list[tuple[str, str, list[tuple[str, bool]]]] = field(default_factory=list)
    groups: dict[str, tuple[str, ...]] = field(default_factory=dict)
    size: float = 0.0
    frames: Frames = field(default_factory=dict)

    def outline(self) -> Outline:
        """The outline of this draft: loops turned so that the material is on their left.

        Raises:
            UserError: a name is used twice.
        """
        self._check_names()
        names = tuple(self.vertices)
        index = {name: i for i, name in enumerate(names)}
        points = [self.vertices[name] for name in names]
        edges = []
        for edge in self.edges.values():
            inner = tuple(range(len(points), len(points) + len(edge.inner)))
            points.extend(edge.inner)
            chain = np.array([self.vertices[edge.start], *edge.inner, self.vertices[edge.end]])
            knots = edge.knots or (chord_parameters(chain) if edge.inner else (0.0, 1.0))
            ends = index[edge.start], index[edge.end]
            edges.append(Edge(edge.name, edge.parent or edge.name, edge.kind, *ends, inner, knots, edge.ends))
        control = np.ascontiguousarray(np.array(points, dtype=np.float64).reshape(-1, 2))
        bulges = np.array([edge.bulge for edge in self.edges.values()], dtype=np.float64)
        size = self.size or self._box_diagonal(control, bulges, tuple(edges))
        used = {v for edge in edges for v in (edge.start, edge.end)}
        embedded = tuple(i for i in range(len(names)) if i not in used)
        place = {name: i for i, name in enumerate(self.edges)}
        loops = tuple(self._loop(name, kind, chain, place) for name, kind, chain in self.loops)
        layout = Layout(names, tuple(edges), loops, embedded, dict(self.groups), size)
        shape = Outline(layout, control, bulges, self.frames)
        return self._oriented(shape)

    @staticmethod
    def _loop(name: str, kind: str, chain: list[tuple[str, bool]], place: dict[str, int]) -> Loop:
        return Loop(name, kind, tuple((place[edge], forward) for edge, forward in chain))

    @staticmethod
    def _box_diagonal(points: Reals, bulges: Reals, edges: tuple[Edge, ...]) -> float:
        lower, upper = points.min(axis=0), points.max(axis=0)
        rough = float(np.hypot(*(upper - lower))) or 1.0
        lower, upper = Outline(Layout((), edges, (), (), {}, rough), points, bulges).bounds()
        return float(np.hypot(*(upper - lower)))

    @staticmethod
    def _oriented(shape: Outline) -> Outline:
        loops, layout = [], shape.layout
        place = PieceFinder(shape)
        for i, loop in enumerate(layout.loops):
            ccw = shape.loop_area(i) > 0.0
            turn = ccw == (loop.kind == "hole")
            chain = tuple((e, not forward) for e, forward in reversed(loop.edges)) if turn else loop.edges
            loops.append(replace(loop, edges=chain, piece=place.of_loop(i)))
        same = layout.vertex_names, layout.edges, tuple(loops), layout.embedded, layout.groups, layout.size
        embedded = tuple(place.of_point(shape.points[i]) for i in layout.embedded)
        return Outline(Layout(*same, embedded), shape.points, shape.bulges, shape.frames)

    def _check_names(self) -> None:
        seen: dict[str, str] = dict.fromkeys(RESERVED, "reserved")
        loops = [(name, kind) for name, kind, _ in self.loops if name != "outline"]
        named = [*((n, "vertex") for n in self.vertices), *((n, "edge") for n in self.edges), *loops]
        for name, kind in [*named, *((n, "group") for n in self.groups)]:
            if name in seen:
                raise UserError(f"the name {name!r} is used twice: {seen[name]} and {kind}", do="rename one of them")
            seen[name] = kind
        for edge in self.edges.values():
            if edge.parent and seen.get(edge.parent, "edge") != "edge":
                what = f"edge {edge.name!r} is part of {edge.parent!r}, which names a {seen[edge.parent]}"
                raise UserError(what, do="let part_of name the edge that it was cut from")


def draft_of(outline: Outline) -> Draft:
    """The draft of an outline, to be cut and made into another one."""
    names = outline.vertex_names
    points = [(float(x), float(y)) for x, y in outline.points]
    draft = Draft(groups=dict(outline.groups), size=outline.size, frames=outline.frames)
    draft.vertices = dict(zip(names, points))
    for edge, bulge in zip(outline.edges, outline.bulges):
        draft.edges[edge.name] = DraftEdge(
            edge.name,
            edge.kind,
            names[edge.start],
            names[edge.end],
            edge.parent,
            tuple(points[i] for i in edge.inner),
            edge.knots,
            edge.ends,
            float(bulge),
        )
    for loop in outline.loops:
        draft.loops.append((loop.name, loop.kind, [(outline.edges[e].name, forward) for e, forward in loop.edges]))
    return draft


def add_circle(draft: Draft, name: str, kind: str, center: tuple[float, float], radius: float) -> None:
    """Adds a round loop to a draft: arcs ``NAME.1`` to ``NAME.4`` through vertices ``NAME.v1`` to ``NAME.v4``."""
    x, y = float(center[0]), float(center[1])
    for i, (dx, dy) in enumerate(((radius, 0.0), (0.0, radius), (-radius, 0.0), (0.0, -radius)), 1):
        _claim(draft, f"{name}.v{i}")
        draft.vertices[f"{name}.v{i}"] = (x + dx, y + dy)
    quarter = float(np.tan(np.pi / 8.0))
    for i in range(1, 5):
        _claim(draft, f"{name}.{i}")
        draft.edges[f"{name}.{i}"] = DraftEdge(
            f"{name}.{i}", "arc", f"{name}.v{i}", f"{name}.v{i % 4 + 1}", bulge=quarter
        )
    draft.loops.append((name, kind, [(f"{name}.{i}", True) for i in range(1, 5)]))


def add_polygon(draft: Draft, name: str, kind: str, corners: list[tuple[float, float]]) -> None:
    """Adds a loop of straight edges to a draft: ``NAME.1`` ... through vertices ``NAME.v1`` ...

    Raises:
        UserError: a name is in use, or the first corner comes again as the last one.
    """
    n = len(corners)
    if n > 1 and tuple(corners[0]) == tuple(corners[-1]):
        raise UserError(f"polygon {name!r} ends with its first corner", do="leave that out: a polygon closes by itself")
    for i, (x, y) in enumerate(corners, 1):
        _claim(draft, f"{name}.v{i}")
        draft.vertices[f"{name}.v{i}"] = (float(x), float(y))
    for i in range(1, n + 1):
        _claim(draft, f"{name}.{i}")
        draft.edges[f"{name}.{i}"] = DraftEdge(f"{name}.{i}", "line", f"{name}.v{i}", f"{name}.v{i % n + 1}")
    draft.loops.append((name, kind, [(f"{name}.{i}", True) for i in range(1, n + 1)]))


def add_loop(draft: Draft, name: str, kind: str, edges: list[str]) -> None:
    """Adds a loop of edges that the draft holds already, in the order given.

    Raises:
        UserError: an edge is not there or comes twice, or the loop is open.
    """
    for edge in edges:
        if edge not in draft.edges:
            raise UserError(f"loop {name!r} names the edge {edge!r}, which is not there", do=", ".join(draft.edges))
        if edges.count(edge) > 1:
            raise UserError(f"loop {name!r} names the edge {edge!r} twice")
    chain: list[tuple[str, bool]] = []
    first = draft.edges[edges[0]]
    next_edge = draft.edges[edges[1]] if len(edges) > 1 else first
    at = first.start if first.end in (next_edge.start, next_edge.end) else first.end
    begin = at
    for edge_name in edges:
        here = draft.edges[edge_name]
        if at not in (here.start, here.end):
            raise UserError(
                f"loop {name!r} is open: edge {edge_name!r} goes from {here.start!r} to {here.end!r}, "
                f"but the edge before it ends at {at!r}",
                do="list the edges in the order in which they are joined",
            )
        forward = at == here.start
        chain.append((edge_name, forward))
        at = here.end if forward else here.start
    if at != begin:
        raise UserError(f"loop {name!r} is open: it begins at {begin!r} and ends at {at!r}", do="add the missing edge")
    draft.loops.append((name, kind, chain))


def _claim(draft: Draft, name: str) -> None:
    if name in draft.vertices or name in draft.edges:
        raise UserError(f"the name {name!r} is used twice", do="rename one of them")
