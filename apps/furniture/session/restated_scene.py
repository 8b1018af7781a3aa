"""The scene of a piece as edits have left it: planks by lines, joints, weights and pushes by name."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from restshape_apps.furniture.scene.plank_quantities import place_of
from restshape_apps.furniture.session.plank_frame import PlankFrame
from restshape_apps.furniture.shape.plank_adoption import drawn_table, put_table
from restshape_apps.furniture.shape.planks import SIDES, Piece

from restshape.scene.model import Scene
from restshape.scene.plain_values import Table


def restated_tables(frame: PlankFrame) -> Table:
    """The plain tables of a scene that draws the piece of a frame, with the same joints and loads.

    What names a plank that edits have deleted is left out.

    Raises:
        UserError: a weight has no mass that is known, for there is no gravity.
    """
    piece, raw = frame.design.furniture.moved(frame.gamma), dict(frame.scene.raw)
    names = [plank.name for plank in piece.planks]
    joints: dict[str, Any] = {"near": False, "reach": float(piece.reach)}
    for k, joint in enumerate(piece.joints, 1):
        end = {
            "plank": names[joint.i],
            "end": SIDES[joint.side],
            "to": names[joint.j],
            "face": SIDES[joint.face],
        }
        joints[f"joint-{k}"] = {**end, "fastener": joint.fastener}
    loads = {
        "weights": {load.name: put_table(piece, load) for load in piece.weights},
        "pushes": {load.name: _pushed(piece, k) for k, load in enumerate(piece.pushes)},
    }
    for table, entries in loads.items():
        # Pushes that the scene leaves out are none of the piece.
        if entries or (table == "weights" and table in raw):
            raw[table] = entries
    raw["planks"] = {plank.name: drawn_table(plank) for plank in piece.planks}
    raw["joints"] = joints
    return _without_the_deleted(raw, frame.scene, names)


def _without_the_deleted(raw: Table, scene: Scene, names: Sequence[str]) -> Table:
    """Tables without what names a plank that edits have deleted: quantities, and what suggestions keep."""
    there = {"", *names}
    gone = {name for name, one in scene.quantities.items() if place_of(one)[0] not in there}
    if gone:
        raw = raw | {"quantities": {name: one for name, one in raw["quantities"].items() if name not in gone}}
    guidance = raw.get("effects", {}).get("guidance", {})
    kept = [lock for lock in guidance.get("keep", ()) if lock.rpartition(" ")[0] in there]
    if len(kept) < len(guidance.get("keep", ())):
        raw = raw | {"effects": raw["effects"] | {"guidance": guidance | {"keep": kept}}}
    return raw


def _pushed(piece: Piece, number: int) -> dict[str, Any]:
    load = piece.pushes[number]
    return {"on": piece.planks[load.plank].name, "force": list(map(float, load.force)), "at": list(load.place)}
