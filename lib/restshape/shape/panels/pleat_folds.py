"""Outlines with vertices at the folds of pleats, so that meshes have nodes there."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from restshape.errors import UserError
from restshape.scene.dart_keys import END
from restshape.scene.pleat_keys import PlacedPleat
from restshape.shape.outline import Outline
from restshape.shape.panels.dart_mouth import length_along, place_along
from restshape.shape.topology_edits import insert


def with_pleats(outline: Outline, pleats: Sequence[PlacedPleat]) -> Outline:
    """The outline with both folds of each pleat; those whose vertices are there already stay.

    Raises:
        UserError: a pleat has no place on its edge.
    """
    for one in pleats:
        entity = outline.entity(one.edge)
        if not entity.edges or entity.vertices or entity.loops:
            raise UserError(f"the pleat is to be on {one.edge!r}, which is no edge", one.where, "name an edge")
        length = length_along(outline, entity)
        middle, half = one.pleat.at * length, 0.5 * one.pleat.depth
        if middle - half <= 0.0 or middle + half >= length:
            what = f"the pleat reaches beyond an end of {one.edge!r}, which is {1e3 * length:.4g} mm long"
            raise UserError(what, one.where, "change `at`, or make it less deep")
        _refuse_darts(outline, one, (middle - half, middle + half))
        for name, place in zip(one.folds, (middle - half, middle + half)):
            if name not in outline.vertex_names:
                outline = _with_fold(outline, one, name, place)
    return outline


def _refuse_darts(outline: Outline, one: PlacedPleat, places: Sequence[float]) -> None:
    """Refuses a pleat with folds at places [m] along its edge where a dart is: its layers would be short."""
    pieces = list(outline.entity(one.edge).edges)
    first, last = (place_along(outline, outline.entity(one.edge), place)[0] for place in places)
    if first is not None and last is not None:
        ways = (
            outline.point(b, 0.0)[0] - outline.point(a, 1.0)[0]
            for a, b in pairwise(pieces[pieces.index(first) : pieces.index(last) + 1])
        )
        if all(np.hypot(*way) <= END * outline.size for way in ways):
            return
    what = f"a dart is where the pleat lies on {one.edge!r}"
    raise UserError(what, one.where, "move one of them along the edge")


def _with_fold(outline: Outline, one: PlacedPleat, name: str, place: float) -> Outline:
    """The outline with a vertex at a length [m] along the edge of a pleat."""
    edge, s = place_along(outline, outline.entity(one.edge), place)
    assert edge is not None, "a dart at the fold is refused before"
    try:
        return insert(outline, outline.edges[edge].name, name, s=s)
    except UserError as error:
        raise UserError(f"the pleat has no fold there: {error.what}", one.where, "move it along the edge") from None
