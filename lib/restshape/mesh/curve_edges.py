"""How many mesh edges the curves of a shape get, before any mesh is made."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.mesh.boundary import discretise
from restshape.mesh.sizing import SizeSpec, sizing_of
from restshape.shape.outline import Outline

CURVED = ("arc", "spline")


@dataclass(frozen=True)
class CurveEdges:
    """Mesh edges along a hole with curves, or along the curves of the outline.

    Args:
        name: of the loop.
        count: of mesh edges on its curves.
        length: of the longest of them [m].
        turn: largest angle between two of them that follow each other on one curve [rad].
    """

    name: str
    count: int
    length: float
    turn: float


def curve_edges(outline: Outline, spec: SizeSpec) -> list[CurveEdges]:
    """What each loop with arcs or splines gets from a scene's ``[mesh]``.

    Raises:
        UserError: the sizes make no sense.
    """
    if not any(edge.kind in CURVED for edge in outline.edges):
        return []
    boundary = discretise(outline, sizing_of(outline, spec))
    found = []
    for loop in outline.loops:
        chains = [boundary.chains[e] for e, _ in loop.edges if outline.edges[e].kind in CURVED]
        if chains:
            sides = [np.diff(boundary.points[chain], axis=0) for chain in chains]
            longest = max(float(np.hypot(*side.T).max()) for side in sides)
            found.append(CurveEdges(loop.name, sum(map(len, sides)), longest, max(map(_largest_turn, sides))))
    return found


def _largest_turn(sides: np.ndarray) -> float:
    """The largest angle [rad] from one side (m, 2) to the next."""
    u, v = sides[:-1], sides[1:]
    turns = np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], np.sum(u * v, axis=1))
    return float(np.abs(turns).max(initial=0.0))
