"""Marks of a frame of a recording: what its scene, its outline and its columns say of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from restshape.errors import UserError
from restshape.live.condition_marks import arrows_of
from restshape.live.shown_marks import Lines, Mark
from restshape.replay.recorded_places import SINGULAR_PLACES, decode_places
from restshape.report.entity_outlines import Place, place_of
from restshape.report.goal_curves import goals_in
from restshape.report.load_vectors import accelerations, in_plane

if TYPE_CHECKING:
    from restshape.arrays import Reals
    from restshape.scene.model import Scene
    from restshape.shape.outline import Outline


def recorded_marks(scene: Scene, outline: Outline, row: Mapping[str, object], X: Reals) -> list[Mark]:
    """The supports, loads, goals and singular places of a frame of a shape in the plane.

    Args:
        scene: the values that hold in it; outline: its shape; row: its columns.
        X: (n, 2) nodes of its mesh [m].
    """
    goals = [Lines(f"goal {name}", curve, meaning="goal") for name, curve in goals_in(scene)]
    return [*_supports(scene, outline), *_loads(scene, outline, X), *goals, *singular_marks(row)]


def singular_marks(row: Mapping[str, object]) -> list[Lines]:
    """Where quantities of a row have no limit under refinement."""
    found = decode_places(str(row.get(SINGULAR_PLACES, "")))
    if not len(found.points):
        return []
    words = [f"singular place of {', '.join(found.exponents)}", *[""] * (len(found.points) - 1)]
    return [Lines("singular places", found.points, range(len(words)), "uncertain", None, words)]


def _supports(scene: Scene, outline: Outline) -> Iterator[Mark]:
    """Where supports act; what an edit has removed is left out."""
    for name, support in scene.supports.items():
        for place in filter(None, (_place(outline, on) for on in support.on)):
            pieces = place.lines or list(place.points[:, None])
            starts = np.cumsum([0, *(len(piece) for piece in pieces[:-1])]).tolist()
            yield Lines(f"support {name}", np.concatenate(pieces), starts, "support")


def _loads(scene: Scene, outline: Outline, X: Reals) -> Iterator[Mark]:
    """The arrows of loads and accelerations; those inside stand near the middle of the material."""
    middle = X[((X - X.mean(axis=0)) ** 2).sum(axis=1).argmin()][None]
    inner = Place([], middle, middle, np.zeros((1, 2)), middle[0])
    for name, load in scene.loads.items():
        for on in load.on:
            inside = load.kind == "body" or on == "all"
            place = inner if inside else _place(outline, on)
            if place is not None:
                yield arrows_of(scene, name, load, place, inside)
    for name, value in accelerations(scene).items():
        if (way := in_plane(scene, name, value)).any():
            yield arrows_of(scene, name, None, inner, True, way)


def _place(outline: Outline, on: str) -> Place | None:
    """Where an entity is; None where there is none of this name."""
    try:
        return place_of(outline, on)
    except UserError:
        return None
