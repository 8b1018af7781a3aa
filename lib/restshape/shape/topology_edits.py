"""Edits that change what a shape consists of: vertices put in and taken out, holes, lines that become arcs.

Each returns a new outline and leaves the old one as it is. Whether the result is valid is asked elsewhere.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.shape import curves
from restshape.shape.draft import Draft, DraftEdge, add_circle, add_polygon, draft_of
from restshape.shape.outline import Entity, Outline

NEAREST_SAMPLES = 64
SAME_CIRCLE = 1e-6
"""Distance of the middles of two arcs, over their radius, below which they are of one circle."""
MOST_QUARTERS = 1.5
"""A quarter of the angle [rad] of an arc that two may become at most."""


def insert(outline: Outline, on: str, name: str, at: Reals | None = None, s: float | None = None) -> Outline:
    """The outline with a vertex on an edge, which becomes two; no curve changes its form.

    Lines, arcs and polylines are cut exactly. A spline is cut into two splines that get one or two more inner points
    and continue their last polynomial ("smooth" ends), so that they trace the old curve to rounding error; from then on
    each follows its own points.

    Args:
        outline: the shape.
        on: an edge, or the former name of one that was cut.
        name: of the new vertex.
        at: (2,) the vertex comes to the nearest point of the edge [m]; or
        s: parameter on the edge, 0 < s < 1.

    Raises:
        UserError: not an edge, name in use, or the place is at an end of the edge.
    """
    _refuse_used(outline, name)
    edges = outline.entity(on)
    if not edges.edges or edges.vertices or edges.loops:
        raise UserError(f"{on} is not an edge")
    if s is not None and len(edges.edges) > 1:
        pieces = ", ".join(outline.edges[e].name for e in edges.edges)
        raise UserError(f"edge {on} is in pieces: name one of {pieces}, or give a point")
    index, s = (edges.edges[0], s) if s is not None else nearest(outline, edges, np.asarray(at, dtype=float))
    if not 1e-9 < s < 1.0 - 1e-9:
        raise UserError(f"that place is an end of edge {outline.edges[index].name}, where a vertex is already")
    draft = draft_of(outline)
    place = outline.point(index, s)[0]
    draft.vertices = {**draft.vertices, name: (float(place[0]), float(place[1]))}
    old = draft.edges[outline.edges[index].name]
    first, second = _cut(outline, draft, old, index, float(s), name)
    draft.edges = {
        key: edge
        for known in draft.edges.values()
        for key, edge in (
            ((first.name, first), (second.name, second)) if known.name == old.name else ((known.name, known),)
        )
    }
    draft.loops = [
        (loop, kind, _replaced(chain, old.name, first.name, second.name)) for loop, kind, chain in draft.loops
    ]
    draft.groups = {
        group: tuple(new for part in parts for new in ((first.name, second.name) if part == old.name else (part,)))
        for group, parts in draft.groups.items()
    }
    return draft.outline()


def _refuse_used(outline: Outline, name: str) -> None:
    if name in outline.layout.entities or name in outline.groups:
        raise UserError(f"the name {name!r} is in use already")


def _replaced(chain: list[tuple[str, bool]], old: str, first: str, second: str) -> list[tuple[str, bool]]:
    result: list[tuple[str, bool]] = []
    for edge, forward in chain:
        if edge != old:
            result.append((edge, forward))
        else:
            result.extend([(first, True), (second, True)] if forward else [(second, False), (first, False)])
    return result


def _cut(
    outline: Outline, draft: Draft, old: DraftEdge, index: int, s: float, name: str
) -> tuple[DraftEdge, DraftEdge]:
    taken = set(draft.edges) | set(draft.vertices)
    free = (f"{old.parent}.{i}" for i in range(1, len(taken) + 3))
    names = [candidate for candidate in free if candidate not in taken][:2]
    first = replace(old, name=names[0], end=name)
    second = replace(old, name=names[1], start=name)
    if old.kind == "line":
        return first, second
    if old.kind == "arc":
        quarter = np.arctan(old.bulge)
        return (
            replace(first, bulge=float(np.tan(s * quarter))),
            replace(second, bulge=float(np.tan((1.0 - s) * quarter))),
        )
    halves = []
    for edge, lower, upper in ((first, 0.0, s), (second, s, 1.0)):
        knots = [lower, *(u for u in old.knots if lower < u < upper), upper]
        ends = old.ends
        if old.kind == "spline":
            ends = (old.ends[0], "smooth") if edge is first else ("smooth", old.ends[1])
            knots = _room_for_smooth_ends(knots, ends, at_end=edge is first)
        inner = outline.point(index, np.array(knots[1:-1])) if len(knots) > 2 else np.zeros((0, 2))
        own = tuple(((np.array(knots) - lower) / (upper - lower)).tolist())
        kind = "line" if old.kind == "polyline" and len(knots) == 2 else old.kind
        halves.append(
            replace(edge, kind=kind, inner=tuple((float(x), float(y)) for x, y in inner), knots=own, ends=ends)
        )
    return halves[0], halves[1]


def _room_for_smooth_ends(knots: list[float], ends: tuple[str, str], at_end: bool) -> list[float]:
    """Knots with as many more in the cut span as the end conditions need to hold the old polynomial there."""
    span = (knots[-2], knots[-1]) if at_end else (knots[0], knots[1])
    count = 2 if ends == ("smooth", "smooth") and len(knots) == 2 else 1
    more = np.linspace(*span, count + 2)[1:-1].tolist()
    return sorted([*knots, *more])


def nearest(outline: Outline, edges: Entity, at: Reals) -> tuple[int, float]:
    """Edge index and parameter of the point of some edges that is nearest to a place (2,)."""
    best = (np.inf, -1, 0.0)
    for e in edges.edges:
        pieces = np.union1d(np.linspace(0.0, 1.0, NEAREST_SAMPLES + 1), outline.edges[e].knots)
        gaps = np.hypot(*(outline.point(e, pieces) - at).T)
        k = int(gaps.argmin())
        s = _refined(outline, e, at, pieces[max(k - 1, 0)], pieces[min(k + 1, len(pieces) - 1)])
        gap = float(np.hypot(*(outline.point(e, s)[0] - at)))
        if gap < best[0]:
            best = (gap, e, s)
    return best[1], best[2]


def _refined(outline: Outline, edge: int, at: Reals, lower: float, upper: float) -> float:
    """The nearest parameter between two, by golden section, then exactly where the edge is straight."""
    if outline.edges[edge].kind == "line":
        a, b = outline.point(edge, np.array([0.0, 1.0]))
        return float(np.clip((at - a) @ (b - a) / ((b - a) @ (b - a)), 0.0, 1.0))
    ratio = (np.sqrt(5.0) - 1.0) / 2.0
    while upper - lower > 1e-10:
        inner = np.array([upper - ratio * (upper - lower), lower + ratio * (upper - lower)])
        gaps = np.hypot(*(outline.point(edge, inner) - at).T)
        lower, upper = (lower, inner[1]) if gaps[0] < gaps[1] else (inner[0], upper)
    return 0.5 * (lower + upper)


def delete(outline: Outline, on: str) -> Outline:
    """The outline without a hole, a region, or a vertex, whose two edges become one.

    It is an arc where both were arcs of one circle, else straight. The edge that arrives at the vertex, with the
    material on the left, keeps its name.

    Raises:
        UserError: anything else, or a vertex that its loop cannot do without.
    """
    entity = outline.entity(on)
    draft = draft_of(outline)
    own = [outline.loops[i] for i in entity.loops]
    if len(own) == 1 and own[0].name == on and own[0].kind != "outline":
        draft.loops = [loop for loop in draft.loops if loop[0] != on]
        _drop_unused(draft, outline)
    elif on in outline.vertex_names and entity.vertices[0] not in outline.embedded:
        _merge(draft, on)
    else:
        raise UserError(f"{on} cannot be deleted: only a hole, a region or a vertex between two edges can")
    _tidy_groups(draft)
    return draft.outline()


def _drop_unused(draft: Draft, outline: Outline) -> None:
    used = {edge for _, _, chain in draft.loops for edge, _ in chain}
    draft.edges = {name: edge for name, edge in draft.edges.items() if name in used}
    ends = {v for edge in draft.edges.values() for v in (edge.start, edge.end)}
    free = {outline.vertex_names[i] for i in outline.embedded}
    draft.vertices = {name: p for name, p in draft.vertices.items() if name in ends or name in free}


def _merge(draft: Draft, vertex: str) -> None:
    touching = [edge.name for edge in draft.edges.values() if vertex in (edge.start, edge.end)]
    if len(touching) != 2:
        raise UserError(f"vertex {vertex} cannot be deleted: {len(touching)} edges meet there, not two")
    chain = next(chain for _, _, chain in draft.loops if any(edge == touching[0] for edge, _ in chain))
    if len(chain) < 3:
        raise UserError(f"vertex {vertex} cannot be deleted: its loop would be left with one straight edge")
    arriving, forward = next(
        (edge, forward)
        for edge, forward in chain
        if edge in touching and (draft.edges[edge].end if forward else draft.edges[edge].start) == vertex
    )
    leaving = next(edge for edge in touching if edge != arriving)
    kept, gone = draft.edges[arriving], draft.edges[leaving]
    far = gone.end if gone.start == vertex else gone.start
    ends = {"end": far} if forward else {"start": far}
    bulge = _bulge_of_both(draft, kept, gone, vertex)
    kind = "arc" if bulge else "line"
    draft.edges[arriving] = replace(
        kept, kind=kind, inner=(), knots=(), ends=("natural", "natural"), bulge=bulge, **ends
    )
    del draft.edges[leaving]
    draft.loops = [(loop, kind, [part for part in parts if part[0] != leaving]) for loop, kind, parts in draft.loops]
    draft.vertices = {name: p for name, p in draft.vertices.items() if name != vertex}


def _bulge_of_both(draft: Draft, kept: DraftEdge, gone: DraftEdge, vertex: str) -> float:
    """The bulge, along the kept edge, of two arcs that meet at a vertex as one; 0 unless they are of one circle."""
    if kept.kind != "arc" or gone.kind != "arc":
        return 0.0
    on = (kept.end == vertex) == (gone.start == vertex)
    other = gone.bulge if on else -gone.bulge
    middles = [_middle(draft, edge) for edge in (kept, gone)]
    size = abs(middles[0] - complex(*draft.vertices[vertex]))
    quarters = float(np.arctan(kept.bulge) + np.arctan(other))
    if kept.bulge * other <= 0.0 or abs(middles[1] - middles[0]) > SAME_CIRCLE * size or abs(quarters) >= MOST_QUARTERS:
        return 0.0
    return float(np.tan(quarters))


def _middle(draft: Draft, edge: DraftEdge) -> complex:
    """The middle [m] of an arc's circle, x + iy."""
    start, end = (complex(*draft.vertices[name]) for name in (edge.start, edge.end))
    return 0.5 * (start + end) + 0.25j * (end - start) * (1.0 / edge.bulge - edge.bulge)


def _tidy_groups(draft: Draft) -> None:
    """Takes names out of groups that nothing has any more; a group without members goes."""
    known = set(draft.vertices) | set(draft.edges) | {edge.parent for edge in draft.edges.values()}
    known |= {name for name, _, _ in draft.loops} | {"all"}
    kept = {group: tuple(part for part in parts if part in known) for group, parts in draft.groups.items()}
    draft.groups = {group: parts for group, parts in kept.items() if parts}


def add_hole(
    outline: Outline,
    name: str,
    center: tuple[float, float] | None = None,
    radius: float | None = None,
    polygon: list[tuple[float, float]] | None = None,
) -> Outline:
    """The outline with one more hole, a circle or a polygon [m].

    Raises:
        UserError: the name is in use.
    """
    _refuse_used(outline, name)
    draft = draft_of(outline)
    if polygon is not None:
        add_polygon(draft, name, "hole", polygon)
    elif center is not None and radius is not None:
        add_circle(draft, name, "hole", center, radius)
    return draft.outline()


def as_arc(outline: Outline, edge: int, bulge: float) -> Outline:
    """The outline with a line or an arc made an arc of that bulge; a new layout if it was a line.

    Raises:
        UserError: the edge is a spline or polyline, or the bulge is beyond reach.
    """
    found = outline.edges[edge]
    if found.kind not in ("line", "arc"):
        raise UserError(f"edge {found.name} is a {found.kind}: only a line or an arc can change its curvature")
    if not np.isfinite(bulge):
        raise UserError(f"edge {found.name} cannot have the bulge {bulge}")
    if found.kind == "arc":
        bulges = outline.bulges.copy()
        bulges[edge] = bulge
        return outline.moved(bulges=bulges)
    draft = draft_of(outline)
    draft.edges[found.name] = replace(draft.edges[found.name], kind="arc", bulge=float(bulge))
    return draft.outline()


def bulge_of(outline: Outline, edge: int, through: Reals) -> float:
    """The bulge that takes an edge through a point (2,).

    Raises:
        UserError: no arc does.
    """
    found = outline.edges[edge]
    try:
        return curves.bulge_through(outline.points[found.start], through, outline.points[found.end])
    except ValueError:
        name = found.name
        raise UserError(f"no arc passes through the ends of edge {name} and ({through[0]:g}, {through[1]:g})") from None
