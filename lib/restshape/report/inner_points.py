"""A point inside what a name of an outline fills, for its label and its arrows."""

import numpy as np

from restshape.mesh.entity_area import signed_loops
from restshape.mesh.regions import contains, loop_polygon
from restshape.shape.nearness import distances
from restshape.shape.outline import Entity, Outline

GRID = 48
"""Points that are tried along the longer side of the box around an area."""
NEARLY = 0.5
"""The middle is taken where it is at least this share of the largest distance away from all edges."""


def inner_point(outline: Outline, name: str, entity: Entity, middle: np.ndarray) -> np.ndarray:
    """A point (2,) [m] in an area, its middle where that is well inside, else a point far from all edges.

    Args:
        outline: the shape.
        name: of the entity: all, a region, which is less what lies in it, or a hole.
        entity: it, with loops.
        middle: (2,) of its edges [m].
    """
    loops = [loop for loop, _ in signed_loops(outline, name)] or list(entity.loops)
    polygons = [loop_polygon(outline, outline.loops[loop]) for loop in loops]
    ends = np.concatenate(polygons)
    low, high = ends.min(axis=0), ends.max(axis=0)
    step = float(max(high - low)) / GRID
    across = [np.arange(low[k] + 0.5 * step, high[k], step) for k in (0, 1)]
    tried = np.vstack([middle, np.stack(np.meshgrid(*across), axis=-1).reshape(-1, 2)])
    # Loops within loops take turns: what is in an odd number of them is filled.
    filled = np.sum([contains(polygon, tried) for polygon in polygons], axis=0) % 2 == 1
    if not filled.any():
        return middle
    starts, ends = np.concatenate(polygons), np.concatenate([np.roll(one, -1, axis=0) for one in polygons])
    room = np.where(filled, distances(tried, starts, ends), 0.0)
    return middle if room[0] >= NEARLY * room.max() else tried[int(np.argmax(room))]
