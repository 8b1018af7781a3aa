"""The scene of a piece as edits have left it: planks by lines, joints, weights and pushes by name."""

from __future__ import annotations

from typing import Any

from restshape_apps.furniture.session.plank_frame import PlankFrame
from restshape_apps.furniture.shape.plank_adoption import drawn_table, put_table
from restshape_apps.furniture.shape.planks import SIDES, Piece

from restshape.scene.plain_values import Table


def restated_tables(frame: PlankFrame) -> Table:
    """The plain tables of a scene that draws the piece of a frame, with the same joints and loads.

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
    return raw


def _pushed(piece: Piece, number: int) -> dict[str, Any]:
    load = piece.pushes[number]
    return {"on": piece.planks[load.plank].name, "force": list(map(float, load.force)), "at": list(load.place)}
