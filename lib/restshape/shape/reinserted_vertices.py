"""Vertices that edits have inserted, put into the other shapes that a scene gives: one without a dart, for example."""

from __future__ import annotations

from restshape.errors import UserError
from restshape.shape.outline import Outline
from restshape.shape.topology_edits import insert


def reinserted(outline: Outline, before: Outline, after: Outline) -> tuple[Outline, Outline] | None:
    """Both shapes of a scene with the vertices that edits have inserted into the first one, where they are nearest.

    Args:
        outline: as edits have left it.
        before: the shape that the scene gave until now; after: the one that it gives from now on.

    Returns: None where edits have done more than insert vertices, or an edge of one of them is gone.
    """
    known, found = set(before.vertex_names), [before, after]
    for vertex, name in enumerate(outline.vertex_names):
        if name in known:
            continue
        edges = [edge for edge in outline.edges if vertex in (edge.start, edge.end)]
        if not edges:
            return None
        try:
            found = [insert(one, edges[0].parent, name, at=outline.points[vertex]) for one in found]
        except (UserError, KeyError):
            return None
    return (found[0], found[1]) if _parts(found[0]) == _parts(outline) else None


def arranged_as(outline: Outline, other: Outline) -> Outline:
    """An outline with the order of vertices and edges of another one, of the same parts."""
    points = other.points.copy()
    vertices = {name: i for i, name in enumerate(outline.vertex_names)}
    for place, name in enumerate(other.vertex_names):
        points[place] = outline.points[vertices[name]]
    bulges, edges = other.bulges.copy(), {edge.name: i for i, edge in enumerate(outline.edges)}
    for place, edge in enumerate(other.edges):
        own = outline.edges[edges[edge.name]]
        points[list(edge.inner)] = outline.points[list(own.inner)]
        bulges[place] = outline.bulges[edges[edge.name]]
    return other.moved(points, bulges)


def _parts(outline: Outline) -> set[tuple[object, ...]]:
    """What edges an outline has, by names."""
    names = outline.vertex_names
    edges = {
        (edge.name, edge.parent, edge.kind, names[edge.start], names[edge.end], len(edge.inner))
        for edge in outline.edges
    }
    return edges | {(loop.kind, loop.name, len(loop.edges)) for loop in outline.loops}
