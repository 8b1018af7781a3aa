"""Planks of a scene whose thickness the command line replaces: those that lay on each other in its file still do."""

from __future__ import annotations

from typing import Any

import numpy as np
from restshape_apps.furniture.shape.face_contacts import kept_contacts
from restshape_apps.furniture.shape.plank_scene import drawn_planks, floor_of, same_place

from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table
from restshape.scene.space_values import number


def kept_places(written: Scene, scene: Scene) -> Table | None:
    """The plain tables of a scene, with other places of the planks that another thickness moves; None without any.

    It is what a `set` in a script does. What moves along an axis of space becomes a number there.

    Args:
        written: the scene as its file has it.
        scene: with values that the command line replaces.
    """
    names = [name for name in scene.planks if name in written.planks]
    try:
        old, new = ({plank.name: plank for plank in drawn_planks(one)} for one in (written, scene))
    except UserError:
        # What is wrong with a plank is said where the piece is made.
        return None
    before, after = [old[name] for name in names], [new[name] for name in names]
    drawn = {k for k, pair in enumerate(zip(before, after)) if not same_place(*pair)}
    kept = kept_contacts(before, after, (floor_of(written),), drawn)
    shifts = {plank.name: there.centre - plank.centre for plank, there in zip(after, kept) if there is not plank}
    if not shifts:
        return None
    planks = dict(scene.raw["planks"])
    for name, shift in shifts.items():
        planks[name] = _shifted(planks[name], scene, name, shift)
    return {**scene.raw, "planks": planks}


def _shifted(table: Table, scene: Scene, name: str, shift: np.ndarray) -> Table:
    """The plain table of a plank at another place."""
    spec = scene.planks[name]
    lines = {"from": spec.start, "to": spec.to} if spec.drawn else {"center": spec.center}

    def moved(key: str, values: Any) -> list[Any]:
        known = (number(value, scene.parameters) for value in values)
        return [there + float(by) if by else given for given, there, by in zip(table[key], known, shift)]

    return {**table, **{key: moved(key, values) for key, values in lines.items()}}
