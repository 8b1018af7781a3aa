"""Bodies in space, and supports that a hand may take hold of there, as parts of the picture."""

from __future__ import annotations

from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np

from restshape.application import application_of
from restshape.errors import UserError
from restshape.live.frame_arrays import PicturePart, sent_indices, sent_points
from restshape.live.grab_parts import Thing
from restshape.live.shifted_points import ShiftedPoints
from restshape.scene.bodies import bodies_of, pins_of
from restshape.scene.edit_script import SUPPORTS
from restshape.scene.held_point import CLOTH, can_hold

if TYPE_CHECKING:
    from restshape.arrays import Integers, Reals
    from restshape.fem.space import Space
    from restshape.scene.model import Scene

BODY = "body "
"""Before the name of a body, in that of its part."""
PINS = "supports"
"""Name of the part of the supports in space."""
DOTS = 40
"""Of a support at most."""


class BodyParts:
    """The bodies of a scene as surfaces; of one that has not changed the part is the same object.

    One that has moved as it is keeps its arrays, with the vector by which it has.
    """

    def __init__(self) -> None:
        self._scene: Scene | None = None
        self._parts: dict[str, tuple[object, PicturePart]] = {}
        self._shifted: dict[str, ShiftedPoints] = {}

    def __call__(self, scene: Scene, places: Reals) -> list[PicturePart]:
        """The parts of a frame.

        Args:
            scene: with the values that hold in it; places: (n, 3) [m] of what deforms.
        """
        if scene is not self._scene:
            bodies = bodies_of(scene)
            before, self._parts = self._parts, {}
            for name, body in bodies.items():
                # A body whose numbers are formulas follows the parameters.
                state = (body, scene.parameters)
                known = before.get(name)
                if known is None or known[0] != state:
                    known = state, self._surface(scene, name, places, known[1] if known else None)
                self._parts[name] = known
            self._scene = scene
        return [part for _, part in self._parts.values()]

    def _surface(self, scene: Scene, name: str, places: Reals, known: PicturePart | None) -> PicturePart:
        """The part of a body, with the arrays of what is known of it that still hold."""
        points, triangles = _surface(scene, name, places)
        cells = sent_indices(np.asarray(triangles), len(points))
        if known is None or not np.array_equal(known.arrays["cells"], cells):
            self._shifted[name] = ShiftedPoints()
        else:
            cells = known.arrays["cells"]
        sent, shift = self._shifted[name](np.asarray(points))
        said = {"shift": shift} if shift else {}
        return PicturePart(f"{BODY}{name}", "surface", "body", {"points": sent, "cells": cells}, said)


def _surface(scene: Scene, name: str, places: Reals) -> tuple[Reals, Integers]:
    """The points (n, 3) [m] and triangles of a body; one whose surface nobody knows has none."""
    low, high = places.min(axis=0), places.max(axis=0)
    found = (one.surface_of(scene, name, low, high) for one in application_of(scene).physics)
    surface = next((one for one in found if one is not None), None)
    return surface if surface is not None else (np.empty((0, 3)), np.empty((0, 3), dtype=np.int64))


def pin_part(scene: Scene, space: Space, places: Reals) -> PicturePart | None:
    """The supports in space as dots on their nodes; None without any.

    Args:
        scene: with the values that hold; space: of the frame; places: (n, 3) [m] of its nodes.
    """
    names, nodes = [], []
    for name, support in pins_of(scene).items():
        own = _nodes_of(space, support.on)
        own = own[:: max(1, len(own) // DOTS)]
        names += [name] * len(own)
        nodes.append(own)
    if not names:
        return None
    arrays = {"points": sent_points(places[np.concatenate(nodes)])}
    return PicturePart(PINS, "dots", "support", arrays, {"names": names})


def _nodes_of(space: Space, entities: list[str]) -> Reals:
    """The nodes of entities, of those that are there."""
    found = []
    for name in entities:
        try:
            found.append(space.nodes_of(name))
        except UserError:
            continue
    return np.unique(np.concatenate(found)) if found else np.empty(0, dtype=np.int64)


def things_in_space(scene: Scene, names: Collection[str] = ()) -> list[Thing]:
    """Bodies, supports in space, and points of a sheet, which a hand may take hold of.

    Args:
        scene: with the values that hold; names: of the shape's entities, which come first.
    """
    bodies = [Thing(name, "body", ("press",), f"{BODY}{name}") for name in bodies_of(scene)]
    if can_hold(scene) and CLOTH not in names:
        bodies.append(Thing(CLOTH, "cloth", ("press",), "shape"))
    return bodies + [Thing(f"{SUPPORTS}{name}", "support", ("press",), PINS, (name,)) for name in pins_of(scene)]
