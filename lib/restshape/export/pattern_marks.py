"""Marks on the pieces of a pattern: notches at the ends of seams, names of seams, and the line of the grain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from restshape.arrays import Reals
from restshape.scene.pleat_keys import is_fold
from restshape.shape.outline import Outline
from restshape.shape.outward import outward_of, text_angle
from restshape.shape.patterns.seam_parts import SeamPart

ALONG = 0.3
"""Half the length of the line of a grain, over the size of its piece."""
WITHIN = 0.4
"""The same at most, over the width of the box around the piece along the grain."""


@dataclass(frozen=True)
class Notch:
    """A notch at one end of a seam.

    Args:
        place: (2,) [m]; outward: (2,) direction away from the piece, across the seam; vertex: number of its vertex.
        seam: name of it.
    """

    place: Reals
    outward: Reals
    vertex: int
    seam: str


@dataclass(frozen=True)
class EdgeLabel:
    """The name of a seam at the middle of an edge.

    Args:
        seam: its name; edge: number of the edge; place: (2,) middle of the edge [m]; outward: (2,) direction away from
            the piece; angle: of text along the edge, which can be read from below [rad].
    """

    seam: str
    edge: int
    place: Reals
    outward: Reals
    angle: float


def notches(outline: Outline, name: str, parts: Mapping[str, Sequence[SeamPart]]) -> list[Notch]:
    """Notches at the ends of the seams of a piece, and at the folds of their pleats; none at other vertices within.

    Args:
        outline: of the piece; name: of it; parts: of all edges ``PIECE.EDGE`` that are sewn.
    """
    found = []
    for loop in outline.loops:
        if loop.kind == "region":
            continue
        for k, (e, forward) in enumerate(loop.edges):
            for part in parts.get(f"{name}.{outline.edges[e].name}", ()):
                beside = [loop.edges[k - 1], loop.edges[(k + 1) % len(loop.edges)]]
                for end, (other, _) in enumerate(beside):
                    same = {(p.seam, p.side) for p in parts.get(f"{name}.{outline.edges[other].name}", ())}
                    s = float(end) if forward else 1.0 - end
                    edge = outline.edges[e]
                    vertex = edge.start if s == 0.0 else edge.end
                    # Both edges that meet at a fold have it: one of them marks it.
                    fold = end == 1 and is_fold(outline.vertex_names[vertex], part.seam)
                    if other != e and (part.seam, part.side) in same and not fold:
                        continue
                    found.append(Notch(outline.points[vertex], outward_of(outline, e, forward, s), vertex, part.seam))
    return found


def edge_labels(outline: Outline, name: str, parts: Mapping[str, Sequence[SeamPart]]) -> list[EdgeLabel]:
    """The names of the seams of a piece at the middles of its edges; arguments as of `notches`."""
    found = []
    for loop in outline.loops:
        for e, forward in loop.edges if loop.kind != "region" else ():
            for part in parts.get(f"{name}.{outline.edges[e].name}", ()):
                outward = outward_of(outline, e, forward, 0.5)
                place = outline.point(e, 0.5)[0]
                found.append(EdgeLabel(part.seam, e, place, outward, text_angle(outward)))
    return found


def grain_line(outline: Outline, grain: float) -> Reals:
    """Both ends (2, 2) [m] of the line of a grain through the middle of a piece, at its angle [rad]."""
    low, high = outline.bounds()
    unit = np.array([np.cos(grain), np.sin(grain)])
    across = float(((high - low) / np.maximum(np.abs(unit), 1e-9)).min())
    way = min(ALONG * float(np.hypot(*(high - low))), WITHIN * across) * unit
    middle = 0.5 * (low + high)
    return np.array([middle - way, middle + way])


def regions_at_others(outline: Outline) -> list[str]:
    """The regions that share edges with loops before them."""
    found, seen = [], set[int]()
    for loop in outline.loops:
        own = {e for e, _ in loop.edges}
        if loop.kind == "region" and own & seen:
            found.append(loop.name)
        seen |= own
    return found
