"""Planks of a scene whose thickness the command line replaces: what lay on or met each other in its file still does."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from restshape_apps.furniture.shape.face_contacts import kept_contacts
from restshape_apps.furniture.shape.plank_adoption import drawn_table
from restshape_apps.furniture.shape.plank_scene import drawn_planks, floor_of, piece_of, same_place
from restshape_apps.furniture.shape.planks import Piece, Plank

from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table
from restshape.scene.space_values import number

PLACE = ("from", "to", "width", "center", "size", "turn")
"""Keys of a plank's place."""


def kept_places(written: Scene, scene: Scene) -> Table | None:
    """The plain tables of a scene, with other places of the planks that another thickness moves; None without any.

    It is what a `set` in a script does. What moves along an axis of space becomes a number there. An end that was
    within reach of its face, and is no more, goes as near as it was; all of its plank's place are then numbers.

    Args:
        written: the scene as its file has it.
        scene: with values that the command line replaces.
    """
    try:
        piece, planks = piece_of(written), {plank.name: plank for plank in drawn_planks(scene)}
    except UserError:
        # What is wrong with a plank is said where the piece is made.
        return None
    before = [plank for plank in piece.planks if plank.name in planks]
    after = [planks[plank.name] for plank in before]
    drawn = {k for k, pair in enumerate(zip(before, after)) if not same_place(*pair)}
    kept = {plank.name: plank for plank in kept_contacts(before, after, (floor_of(written),), drawn)}
    reaching = _reaching(piece, kept, {after[k].name for k in drawn}, scene.joints.reach)
    tables = dict(scene.raw["planks"])
    for name, plank in kept.items():
        if name in reaching:
            others = {key: value for key, value in tables[name].items() if key not in PLACE}
            given = drawn_table(reaching[name])
            tables[name] = {**others, **{key: given[key] for key in PLACE[:3]}}
        elif plank is not planks[name]:
            tables[name] = _shifted(tables[name], scene, name, plank.centre - planks[name].centre)
    return {**scene.raw, "planks": tables} if tables != scene.raw["planks"] else None


def _reaching(piece: Piece, planks: Mapping[str, Plank], drawn: set[str], reach: float) -> dict[str, Plank]:
    """Planks whose ends are no more within reach of the faces that they met, with these ends as near as they were.

    Args:
        piece: before.
        planks: by name, as they are now.
        drawn: names of those that are drawn elsewhere.
        reach: of joints [m].
    """
    found: dict[str, Plank] = {}
    for joint in piece.joints:
        old, other = piece.planks[joint.i], piece.planks[joint.j]
        if not {old.name, other.name} <= set(planks) - drawn:
            continue
        now, face = found.get(old.name, planks[old.name]), planks[other.name]
        normal = face.axes[:, 2] * (1.0 if joint.face == 5 else -1.0)
        was, short = ((one.end(joint.side) - at.end(joint.face)) @ normal for one, at in ((old, other), (now, face)))
        if abs(short) > reach and short != was:
            a = joint.side // 2
            axis = now.axes[:, a] * (1.0 if joint.side % 2 else -1.0)
            more = float((was - short) / (axis @ normal))
            size = now.size.copy()
            size[a] += more
            found[old.name] = replace(now, centre=now.centre + 0.5 * more * axis, size=size)
    return found


def _shifted(table: Table, scene: Scene, name: str, shift: np.ndarray) -> Table:
    """The plain table of a plank at another place."""
    spec = scene.planks[name]
    lines = {"from": spec.start, "to": spec.to} if spec.drawn else {"center": spec.center}

    def moved(key: str, values: Any) -> list[Any]:
        known = (number(value, scene.parameters) for value in values)
        return [there + float(by) if by else given for given, there, by in zip(table[key], known, shift)]

    return {**table, **{key: moved(key, values) for key, values in lines.items()}}
