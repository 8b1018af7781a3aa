"""The exact area of what a name of an outline fills: all of the material, or regions less what lies in them."""

from __future__ import annotations

import numpy as np

from restshape.mesh.regions import contains, loop_polygon, signed_area
from restshape.shape.outline import Loop, Outline

INWARD = 1e-6
"""How far inside a loop the point is that stands for it, over the length of the side that it is taken from."""


def signed_loops(outline: Outline, name: str | None = None) -> tuple[tuple[int, int], ...]:
    """Loops, and the signs with which they count, whose areas add up to what an entity fills.

    A region is less the regions and the holes in it, as the cells of a mesh are sorted; see `Mesh.cells_of`. A piece of
    several, as a panel, is less its own holes. Empty for an entity without an inside.

    Args:
        outline: the shape; loops must not cross.
        name: of an entity; default: all of the material.

    Raises:
        UserError: there is no such entity.
    """
    loops = outline.loops
    wanted = range(len(loops)) if name is None else outline.entity(name).loops
    if outer := {i for i in wanted if loops[i].kind == "outline"}:
        pieces = {int(outline.layout.edge_piece[loops[i].edges[0][0]]) for i in outer}
        holes = {i for i, loop in enumerate(loops) if loop.kind == "hole"}
        own = {i for i in holes if int(outline.layout.edge_piece[loops[i].edges[0][0]]) in pieces}
        return tuple((i, 1) for i in sorted(outer | own))
    regions = [i for i in wanted if loops[i].kind == "region"]
    if not regions:
        return ()
    around = _innermost_around(outline)
    # A hole goes round the other way, a region in a region the same way.
    inside = [(j, -1 if loops[j].kind == "region" else 1) for j in range(len(loops)) for i in regions if around[j] == i]
    return (*((i, 1) for i in regions), *inside)


def entity_area(outline: Outline, name: str | None = None) -> float:
    """The area [m^2] that an entity fills, exact for every kind of edge; see `signed_loops`."""
    return outline.swept_area(signed) if (signed := signed_loops(outline, name)) else 0.0


def _innermost_around(outline: Outline) -> dict[int, int]:
    """For each hole and region the smallest region around it; -1 where there is none.

    A region around another loop is larger, whatever sides both share. Outlines lie in none.
    """
    polygons = [loop_polygon(outline, loop) for loop in outline.loops]
    sizes = [abs(signed_area(polygon)) for polygon in polygons]
    regions = sorted((i for i, loop in enumerate(outline.loops) if loop.kind == "region"), key=sizes.__getitem__)
    found = dict.fromkeys(range(len(polygons)), -1)
    for j, loop in enumerate(outline.loops):
        if loop.kind != "outline":
            place = _point_in(polygons[j], loop)
            holding = (i for i in regions if sizes[i] > sizes[j] and contains(polygons[i], place)[0])
            found[j] = next(holding, -1)
    return found


def _point_in(polygon: np.ndarray, loop: Loop) -> np.ndarray:
    """A point (1, 2) inside a loop's polygon, close to the middle of its longest side."""
    sides = np.roll(polygon, -1, axis=0) - polygon
    longest = int(np.argmax((sides**2).sum(axis=1)))
    along = sides[longest] if loop.kind != "hole" else -sides[longest]
    return (polygon[longest] + 0.5 * sides[longest] + INWARD * np.array([-along[1], along[0]]))[None]
