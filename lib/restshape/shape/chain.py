"""Chains: the control points along a curve of one or more edges, one after the other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.arrays import Integers, Reals
from restshape.errors import UserError
from restshape.shape.outline import Outline


@dataclass(frozen=True, eq=False)
class Chain:
    """A curve of edges that join end to end.

    Args:
        name: of the entity.
        edges: (index, forward) along the curve.
        begins: length along the curve at which each of them begins [m].
        controls: (n,) control points along the curve, each once.
        closed: the last one joins the first.
        places: (n,) length along the edges at each control point, 0 at the first [m].
        length: of the whole curve [m].
    """

    name: str
    edges: tuple[tuple[int, bool], ...]
    begins: tuple[float, ...]
    controls: Integers
    closed: bool
    places: Reals
    length: float

    def gaps(self, start: float, places: Reals, sign: float) -> Reals:
        """Lengths (n,) [m] along the curve from one place to others, forwards (sign 1) or backwards (sign -1).

        On an open curve they are negative where that way does not lead there.
        """
        gaps = sign * (places - start)
        return gaps % self.length if self.closed else gaps


def chain_of(outline: Outline, name: str) -> Chain:
    """The chain of an edge, of all pieces of one that was split, of a hole, or of a group of edges that join.

    Raises:
        UserError: no such entity, or its edges do not make one curve.
    """
    entity = outline.entity(name)
    if not entity.edges or entity.vertices:
        raise UserError(f"{name} is not a curve", do="name an edge, a hole, or a group of edges that join")
    edges = _ordered(outline, entity.edges, name)
    controls: list[int] = []
    places: list[float] = []
    begins = [0.0]
    for e, forward in edges:
        own = outline.layout.controls[e] if forward else outline.layout.controls[e][::-1]
        along = begins[-1] + _lengths(outline, e, forward)
        controls.extend(own[:-1].tolist())
        places.extend(along[:-1].tolist())
        begins.append(float(along[-1]))
    closed = len(edges) > 1 and own[-1] == controls[0]
    if not closed:
        controls.append(int(own[-1]))
        places.append(begins[-1])
    return Chain(name, tuple(edges), tuple(begins[:-1]), np.array(controls), closed, np.array(places), begins[-1])


def _ordered(outline: Outline, edges: tuple[int, ...], name: str) -> list[tuple[int, bool]]:
    """Edges with their direction along the curve; a closed one begins with the edge that is named first."""
    ends = {e: (outline.edges[e].start, outline.edges[e].end) for e in edges}
    meeting: dict[int, list[int]] = {}
    for e, pair in ends.items():
        for vertex in pair:
            meeting.setdefault(vertex, []).append(e)
    free = [vertex for e in edges for vertex in ends[e] if len(meeting[vertex]) == 1]
    here = free[0] if free else ends[edges[0]][0]
    left, found = list(edges), []
    while True:
        following = next((e for e in left if here in ends[e]), None)
        if following is None:
            break
        left.remove(following)
        start, end = ends[following]
        found.append((following, start == here))
        here = end if start == here else start
    if left or any(len(touching) > 2 for touching in meeting.values()):
        raise UserError(f"the edges of {name} do not make one curve", do="name edges that join end to end")
    return found


def _lengths(outline: Outline, edge: int, forward: bool) -> Reals:
    """Length [m] along an edge at each of its control points, 0 at the first in that direction."""
    knots = np.array(outline.edges[edge].knots)
    if outline.edges[edge].kind == "spline":
        fine = np.union1d(np.linspace(0.0, 1.0, 33), knots)
        steps = np.hypot(*np.diff(outline.point(edge, fine), axis=0).T)
        at = np.concatenate([[0.0], np.cumsum(steps)])[np.searchsorted(fine, knots)]
    elif outline.edges[edge].kind == "polyline":
        steps = np.hypot(*np.diff(outline.points[outline.layout.controls[edge]], axis=0).T)
        at = np.concatenate([[0.0], np.cumsum(steps)])
    else:
        at = np.array([0.0, outline.length(edge)])
    return at if forward else at[-1] - at[::-1]


def place_on(outline: Outline, chain: Chain, edge: int, s: float) -> float:
    """Length along the chain [m] of the point of one of its edges at the parameter s."""
    k, forward = next((k, forward) for k, (e, forward) in enumerate(chain.edges) if e == edge)
    fine = np.linspace(0.0 if forward else 1.0, s, 65)
    return chain.begins[k] + float(np.hypot(*np.diff(outline.point(edge, fine), axis=0).T).sum())


def control_of(outline: Outline, chain: Chain, pin: str | tuple[float, float]) -> int:
    """Index into `chain.controls` of a vertex by name, or of the control point nearest to a place [m].

    Raises:
        UserError: the vertex is not on the curve.
    """
    if isinstance(pin, str):
        vertex = outline.entity(pin).vertices
        found = np.flatnonzero(np.isin(chain.controls, vertex))
        if len(vertex) != 1 or not len(found):
            raise UserError(f"{pin} is not a vertex of {chain.name}", do="name one of its vertices, or a place on it")
        return int(found[0])
    return int(np.hypot(*(outline.points[chain.controls] - pin).T).argmin())
