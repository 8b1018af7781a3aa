"""Outlines: closed loops of lines, arcs, splines and polylines between named vertices."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from difflib import get_close_matches

import numpy as np

from restshape.arrays import Indices, Reals
from restshape.bounds import OUTLINE_PIECES
from restshape.errors import UserError
from restshape.shape import curves
from restshape.shape.swept_area import SweptArea

CHORD_ERROR = 1e-3
"""Largest distance between a curve and its straight pieces, relative to the size of the shape."""

RESERVED = ("outline", "all")
_topologies = itertools.count(1)


@dataclass(frozen=True)
class Edge:
    """A curve between two vertices.

    Args:
        name: unique; parent: name that the scene gave it before it was split.
        kind: "line", "arc", "spline" or "polyline".
        start, end: control points at its ends.
        inner: control points between them (splines and polylines).
        knots: parameters of start, inner points and end, rising from 0 to 1, fixed at creation.
        ends: end conditions of a spline, see :func:`restshape.shape.curves.second_derivatives`.
    """

    name: str
    parent: str
    kind: str
    start: int
    end: int
    inner: tuple[int, ...] = ()
    knots: tuple[float, ...] = (0.0, 1.0)
    ends: tuple[str, str] = ("natural", "natural")


@dataclass(frozen=True)
class Loop:
    """A closed chain of edges: (edge index, forward) in the order that keeps the material on the left.

    Regions are traversed counter-clockwise, so that their own inside is on the left.

    Args:
        name: of the entity.
        kind: "outline", "hole" or "region".
        edges: see above.
        piece: number of the outline that it is, or lies in.
    """

    name: str
    kind: str
    edges: tuple[tuple[int, bool], ...]
    piece: int = 0


@dataclass(frozen=True)
class Entity:
    """What a name addresses, as indices into an outline.

    A vertex has no edges, an edge no vertices (its ends are in ``Edge``), a hole or region its edges and its loop.
    """

    vertices: tuple[int, ...] = ()
    edges: tuple[int, ...] = ()
    loops: tuple[int, ...] = ()


class Layout:
    """What stays while control points move: names, edges, loops, groups.

    Attributes:
        pieces: names of the outlines, one of each connected piece; that of a single one may be "outline".
        edge_piece: (n_edges,) number of the piece of each edge.
        control_piece: (k,) likewise of each control point.
    """

    def __init__(
        self,
        vertex_names: tuple[str, ...],
        edges: tuple[Edge, ...],
        loops: tuple[Loop, ...],
        embedded: tuple[int, ...],
        groups: dict[str, tuple[str, ...]],
        size: float,
        embedded_pieces: tuple[int, ...] = (),
    ) -> None:
        self.vertex_names, self.edges, self.loops = vertex_names, edges, loops
        self.embedded, self.groups, self.size = embedded, groups, size
        self.topology = next(_topologies)
        self.controls = tuple(np.array([e.start, *e.inner, e.end], dtype=np.int32) for e in edges)
        self.ends = np.array([(e.start, e.end) for e in edges], dtype=np.int32).reshape(-1, 2)
        self.curved = tuple(i for i, e in enumerate(edges) if e.kind not in ("line", "arc"))
        self.pieces = tuple(loop.name for loop in loops if loop.kind == "outline")
        self.edge_piece, self.control_piece = self._pieces(embedded_pieces)
        self.entities = self._entities()
        self._swept: dict[tuple[tuple[int, int], ...], SweptArea] = {}

    def with_knots(self, knots: Sequence[tuple[float, ...]]) -> Layout:
        """The layout of the same topology whose edges have these knots, each as many as it has now."""
        if all(edge.knots == own for edge, own in zip(self.edges, knots)):
            return self
        found = copy(self)
        found.edges = tuple(replace(edge, knots=own) for edge, own in zip(self.edges, knots))
        found._swept = {}
        return found

    def swept_area(self, signed: tuple[tuple[int, int], ...]) -> SweptArea:
        """What computes the area of loops, each times its sign, while control points move; made once."""
        if signed not in self._swept:
            edges = [
                (edge, float(sign if forward else -sign))
                for loop, sign in signed
                for edge, forward in self.loops[loop].edges
            ]
            self._swept[signed] = SweptArea(self.edges, self.controls, edges)
        return self._swept[signed]

    def _pieces(self, embedded: tuple[int, ...]) -> tuple[Indices, Indices]:
        """Numbers of the pieces of edges and control points."""
        of_edge = np.zeros(len(self.edges), dtype=np.int32)
        for loop in self.loops:
            of_edge[[e for e, _ in loop.edges]] = loop.piece
        last = max((int(own.max()) for own in self.controls), default=-1)
        of_control = np.zeros(max(last + 1, len(self.vertex_names)), dtype=np.int32)
        for own, piece in zip(self.controls, of_edge):
            of_control[own] = piece
        if embedded:
            of_control[list(self.embedded)] = embedded
        return of_edge, of_control

    def _entities(self) -> dict[str, Entity]:
        named = {name: Entity(vertices=(i,)) for i, name in enumerate(self.vertex_names)}
        children: dict[str, list[int]] = {}
        for i, edge in enumerate(self.edges):
            named[edge.name] = Entity(edges=(i,))
            children.setdefault(edge.parent, []).append(i)
        for parent, indices in children.items():
            named.setdefault(parent, Entity(edges=tuple(indices)))
            if parent in (self.edges[i].name for i in indices):
                named[parent] = Entity(edges=tuple(indices))
        for i, loop in enumerate(self.loops):
            named[loop.name] = Entity(edges=tuple(sorted({e for e, _ in loop.edges})), loops=(i,))
        if self.pieces not in ((), ("outline",)):
            named |= self._panels()
        everything = range(len(self.vertex_names)), range(len(self.edges)), range(len(self.loops))
        named["all"] = Entity(*(tuple(indices) for indices in everything))
        return named

    def _panels(self) -> dict[str, Entity]:
        """Each piece by its name: all that is in it; and the outlines of all of them."""
        found = {}
        for k, name in enumerate(self.pieces):
            vertices = np.flatnonzero(self.control_piece[: len(self.vertex_names)] == k).tolist()
            loops = [i for i, loop in enumerate(self.loops) if loop.piece == k]
            found[name] = Entity(tuple(vertices), tuple(np.flatnonzero(self.edge_piece == k).tolist()), tuple(loops))
        around = [i for i, loop in enumerate(self.loops) if loop.kind == "outline"]
        edges = {e for i in around for e, _ in self.loops[i].edges}
        return {**found, "outline": Entity(edges=tuple(sorted(edges)), loops=tuple(around))}


Frames = Mapping[str, tuple[float, float, float]]
"""Of panels by name: the place (x, y) [m] of their own origin in the pattern plane, and the angle [rad] of its axes."""


class Outline:
    """A shape in the plane; its layout never changes, :meth:`moved` gives another one with other control points.

    Args:
        layout: names, edges, loops, groups.
        points: (k, 2) control points [m]: vertices first, then inner points of splines and polylines.
        bulges: (n_edges,) tan(angle/4) of arcs, 0 elsewhere.
        frames: of panels by name: where the origin of a panel's own coordinates lies [m], and their angle [rad].
    """

    __slots__ = ("_area", "bulges", "frames", "layout", "points")

    def __init__(self, layout: Layout, points: Reals, bulges: Reals, frames: Frames | None = None) -> None:
        self.layout, self.points, self.bulges, self.frames = layout, points, bulges, frames or {}
        self._area: float | None = None

    @property
    def vertex_names(self) -> tuple[str, ...]:
        """Names of the vertices, in the order of the first rows of ``points``."""
        return self.layout.vertex_names

    @property
    def edges(self) -> tuple[Edge, ...]:
        """All edges."""
        return self.layout.edges

    @property
    def loops(self) -> tuple[Loop, ...]:
        """All loops; the outline, or those of all pieces, are the first."""
        return self.layout.loops

    @property
    def piece_names(self) -> tuple[str, ...]:
        """Names of the connected pieces: ("outline",), or those of panels."""
        return self.layout.pieces

    @property
    def embedded(self) -> tuple[int, ...]:
        """Vertices that lie on no edge."""
        return self.layout.embedded

    @property
    def groups(self) -> dict[str, tuple[str, ...]]:
        """Named groups of entity names."""
        return self.layout.groups

    @property
    def topology(self) -> int:
        """Version of the layout: equal versions mean the same edges, loops and names."""
        return self.layout.topology

    @property
    def size(self) -> float:
        """Diagonal of the box around the shape when it was made [m]; tolerances are relative to it."""
        return self.layout.size

    def moved(self, points: Reals | None = None, bulges: Reals | None = None) -> Outline:
        """An outline of the same layout with other control points or bulges."""
        points, bulges = self.points if points is None else points, self.bulges if bulges is None else bulges
        return Outline(self.layout, points, bulges, self.frames)

    def names(self, kind: str) -> list[str]:
        """Names of all entities of a kind: "vertex", "edge", "hole", "region" or "group"."""
        if kind == "vertex":
            return list(self.vertex_names)
        if kind == "edge":
            return [edge.name for edge in self.edges]
        if kind == "group":
            return list(self.groups)
        return [loop.name for loop in self.loops if loop.kind == kind]

    def entity(self, name: str, besides: Iterable[str] = ()) -> Entity:
        """What a name addresses: a vertex, edge, hole, region, group, "outline" or "all".

        The name of an edge that was split addresses all its pieces.

        Args:
            name: of the entity.
            besides: other names that may have been meant, which a refusal suggests, too.

        Raises:
            UserError: there is no such entity.
        """
        found = self.layout.entities.get(name)
        if found is not None:
            return found
        if name in self.groups:
            parts = [self.entity(part) for part in self.groups[name]]
            return Entity(
                *(
                    tuple(dict.fromkeys(itertools.chain.from_iterable(getattr(part, key) for part in parts)))
                    for key in ("vertices", "edges", "loops")
                )
            )
        raise self.unknown(name, besides)

    def unknown(self, name: str, besides: Iterable[str] = (), where: str = "") -> UserError:
        """The error of a name that no entity has; `besides` as of `entity`, `where`: the key that names it."""
        known = [*besides, *self.layout.entities, *self.groups]
        near = get_close_matches(name, [one for one in known if one not in RESERVED or one[:2] == name[:2]], 1)
        some = ", ".join(known[:12]) + (", ..." if len(known) > 12 else "")
        do = f"did you mean {near[0]!r}?" if near else f"use one of: {some}"
        return UserError(f"the shape has no entity named {name!r}", where, do)

    def control_points(self, entity: Entity) -> Indices:
        """Sorted indices of the control points that a drag of an entity moves: ends and inner points of edges too."""
        chosen = set(entity.vertices)
        for e in entity.edges:
            chosen.update(self.layout.controls[e].tolist())
        return np.array(sorted(chosen), dtype=np.int32)

    def point(self, edge: int, s: Reals | float, points: Reals | None = None) -> Reals:
        """Points (m, 2) of an edge; linear and homogeneous in the control points for fixed bulges.

        Args:
            edge: index.
            s: (m,) from 0 at its start to 1 at its end: share of length (line), angle (arc), chord parameter (others).
            points: (k, 2) control points, or a displacement of them; default: this outline's.
        """
        return self._combine(edge, np.atleast_1d(np.asarray(s, dtype=float)), points, rate=False)

    def points_on_all(self, first: Indices, s: Reals, points: Reals | None = None) -> Reals:
        """Points (m, 2) of all edges in one call: the same as those of :meth:`point`.

        Args:
            first: (n_edges + 1,) where the parameters of each edge start, the last one m.
            s: (m,) parameters, edge after edge.
            points: (k, 2) control points, or a displacement of them; default: this outline's.
        """
        own, counts, t = self.points if points is None else points, np.diff(first), s[:, None]
        a, b = own[self.layout.ends[:, 0]], own[self.layout.ends[:, 1]]
        found: Reals = np.add(np.repeat(a, counts, axis=0) * np.subtract(1.0, t), np.repeat(b, counts, axis=0) * t)
        half = curves.half_angles(self.bulges)
        bent = np.abs(half) >= curves.STRAIGHT
        if bent.any():
            rows, share = np.repeat(bent, counts), counts[bent]
            z = curves.arc_fractions(np.repeat(half[bent], share), s[rows])
            start, end = (np.repeat(ends[bent].view(np.complex128)[:, 0], share) for ends in (a, b))
            found[rows] = (start * (1.0 - z) + end * z).view(np.float64).reshape(-1, 2)
        for edge in self.layout.curved:
            found[first[edge] : first[edge + 1]] = self.point(edge, s[first[edge] : first[edge + 1]], points)
        return found

    def lengths(self) -> Reals:
        """Lengths (n_edges,) of all edges [m]: the same as those of :meth:`length`."""
        a, b = self.points[self.layout.ends[:, 0]], self.points[self.layout.ends[:, 1]]
        straight, half = np.hypot(*(b - a).T), curves.half_angles(np.abs(self.bulges))
        found: Reals = np.divide(straight * half, np.sin(half), out=straight, where=half >= curves.STRAIGHT)
        for edge in self.layout.curved:
            found[edge] = self.length(edge)
        return found

    def tangent(self, edge: int, s: Reals | float, points: Reals | None = None) -> Reals:
        """Derivatives (m, 2) of :meth:`point` with respect to s."""
        return self._combine(edge, np.atleast_1d(np.asarray(s, dtype=float)), points, rate=True)

    def _combine(self, index: int, s: Reals, points: Reals | None, rate: bool) -> Reals:
        edge, controls = self.layout.edges[index], self.layout.controls[index]
        own = (self.points if points is None else points)[controls]
        if edge.kind == "spline":
            weights = curves.spline_weight_rates if rate else curves.spline_weights
            return weights(edge.knots, edge.ends, s) @ own
        if edge.kind == "polyline":
            return (curves.polyline_weight_rates if rate else curves.polyline_weights)(edge.knots, s) @ own
        a, b = complex(*own[0]), complex(*own[1])
        bulge = float(self.bulges[index])
        if rate:
            p = (b - a) * curves.arc_fraction_rate(bulge, s)
        else:
            z = curves.arc_fraction(bulge, s)
            p = a * (1.0 - z) + b * z
        return p.view(np.float64).reshape(-1, 2)

    def length(self, edge: int) -> float:
        """Length of an edge [m]; exact but for splines (Gauss quadrature)."""
        kind = self.edges[edge].kind
        own = self.points[self.layout.controls[edge]]
        if kind == "spline":
            s, w = curves.gauss_parameters(tuple(np.union1d(np.linspace(0.0, 1.0, 65), self.edges[edge].knots)))
            return float(np.hypot(*self.tangent(edge, s).T) @ w)
        straight = float(np.hypot(*np.diff(own, axis=0).T).sum())
        half = float(curves.half_angles(abs(self.bulges[edge])))
        return straight if half < curves.STRAIGHT else straight * half / float(np.sin(half))

    def pieces(self, edge: int, error: float) -> Reals:
        """Parameters from 0 to 1 whose points make a chain of chords no farther than `error` [m] from the edge.

        Raises:
            UserError: there would be more than `bounds.OUTLINE_PIECES` of them.
        """
        found = self.edges[edge]
        if found.kind in ("line", "polyline"):
            return np.array(found.knots)
        if found.kind == "arc":
            bulge = float(self.bulges[edge])
            if abs(bulge) < 1e-12:
                return np.array([0.0, 1.0])
            a, b = self.points[found.start], self.points[found.end]
            angle = 4.0 * np.arctan(abs(bulge))
            step = 2.0 * np.arccos(max(1.0 - error / curves.arc_centre(a, b, bulge)[1], 0.5))
            self._refuse_many(edge, angle / step if step > 0.0 else np.inf)
            return np.linspace(0.0, 1.0, 1 + max(int(np.ceil(angle / step)), 2))
        second = curves.second_derivatives(found.knots, found.ends) @ self.points[self.layout.controls[edge]]
        bend = np.hypot(*second.T)
        counts = np.ceil(np.diff(found.knots) * np.sqrt(np.maximum(bend[:-1], bend[1:]) / (8.0 * error)))
        self._refuse_many(edge, float(counts.sum()))
        ends = zip(itertools.pairwise(found.knots), np.maximum(counts, 1.0).astype(int))
        return np.concatenate([*(np.linspace(u, v, n + 1)[:-1] for (u, v), n in ends), [1.0]])

    def _refuse_many(self, edge: int, pieces: float) -> None:
        if not pieces <= OUTLINE_PIECES:
            what = f"edge {self.edges[edge].name} would be cut into {pieces:.3g} straight pieces"
            raise UserError(
                f"{what}, more than {OUTLINE_PIECES}", do="bring its points closer, or take a smaller bulge"
            )

    def polyline(self, edge: int, error: float | None = None) -> Reals:
        """Points (m, 2) from start to end whose chords stay within `error` [m] of the edge (default: 1e-3 of size)."""
        return self.point(edge, self.pieces(edge, CHORD_ERROR * self.size if error is None else error))

    def area(self) -> float:
        """Area of the material [m^2]: the outline less the holes, exact for every kind of edge."""
        if self._area is None:
            # Holes go round the other way.
            self._area = self.swept_area(tuple((i, 1) for i, loop in enumerate(self.loops) if loop.kind != "region"))
        return self._area

    def loop_area(self, loop: int) -> float:
        """Signed area of a loop [m^2]: positive counter-clockwise, so negative for holes."""
        return self.swept_area(((loop, 1),))

    def swept_area(self, signed: tuple[tuple[int, int], ...]) -> float:
        """Sum of the signed areas [m^2] of loops, each times its sign; pairs of a loop's index and 1 or -1."""
        return self.layout.swept_area(signed)(self.points, self.bulges)

    def bounds(self) -> tuple[Reals, Reals]:
        """Lower and upper corner (2,) of the box around the shape, exact for every kind of edge."""
        found = np.concatenate([self.point(e, self._extremes(e)) for e in range(len(self.edges))])
        return found.min(axis=0), found.max(axis=0)

    def _extremes(self, edge: int) -> Reals:
        """Parameters of an edge of which some are those of its lowest, highest, leftmost and rightmost points."""
        found, own = self.edges[edge], self.points[self.layout.controls[edge]]
        if found.kind == "spline":
            return np.concatenate([found.knots, curves.spline_extremes(found.knots, found.ends, own)])
        if found.kind == "arc":
            return np.concatenate([found.knots, curves.arc_extremes(float(self.bulges[edge]), own[1] - own[0])])
        return np.array(found.knots)

    def centroid(self, entity: Entity) -> Reals:
        """Mean (2,) of the control points of an entity [m]."""
        return self.points[self.control_points(entity)].mean(axis=0)
