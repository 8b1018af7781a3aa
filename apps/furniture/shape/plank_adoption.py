"""Scenes that name the planks and weights that edits have made, so that their keys can be set as others."""

from __future__ import annotations

from typing import Any

import numpy as np
from restshape_apps.furniture.shape.planks import Load, Piece, Plank

from restshape.errors import UserError
from restshape.scene.load import remade
from restshape.scene.model import Scene
from restshape.scene.source import split_key
from restshape.scene.space_values import number

OWN = {"planks": "plank", "weights": "weight", "pushes": "push"}
"""Tables that name what a piece has."""


def adopted(scene: Scene, piece: Piece, key: str) -> Scene:
    """The scene, with what a key of it is about also where edits have made that.

    Args:
        scene: of a piece that edits have changed.
        piece: as it is now.
        key: that is to be set.

    Raises:
        UserError: the key is about something that was deleted, or about a weight without gravity.
    """
    table, name, *_ = (*split_key(key), "", "")
    if table not in OWN or not name:
        return scene
    here = {one.name for one in getattr(piece, table)}
    if name in getattr(scene, table) and name not in here:
        known = table != "pushes" or "push" in scene.effects
        if known:
            raise UserError(f"the {OWN[table]} {name} was deleted", do="undo that, or make another one")
    missing = {plank.name: plank for plank in piece.planks if plank.name not in scene.planks}
    weights = {w.name: w for w in piece.weights if w.name == name and name not in scene.weights}
    if not missing and not weights:
        return scene
    raw = dict(scene.raw)
    raw["planks"] = {**raw["planks"], **{k: _following(scene, plank, key) for k, plank in missing.items()}}
    if weights:
        raw["weights"] = {**raw.get("weights", {}), **{k: put_table(piece, load) for k, load in weights.items()}}
    return remade(scene, raw)


def _following(scene: Scene, plank: Plank, key: str) -> dict[str, Any]:
    """The table of a plank, without the thickness and the wood that it has as all have, so that it follows these."""
    table, usual = drawn_table(plank), scene.wood
    same = {"thickness": table["thickness"] == number(usual.thickness, scene.parameters)}
    same["wood"] = plank.wood == usual.name
    # One that is to be set needs its value before.
    return {k: value for k, value in table.items() if not same.get(k) or split_key(key) == ("planks", plank.name, k)}


def drawn_table(plank: Any) -> dict[str, Any]:
    """The table of a plank."""
    lines = {"from": plank.end(0), "to": plank.end(1), "width": plank.axes[:, 1] * plank.size[1]}
    return {
        **{key: [float(x) for x in line] for key, line in lines.items()},
        "thickness": float(plank.size[2]),
        "wood": plank.wood,
    }


def put_table(piece: Piece, load: Load) -> dict[str, Any]:
    """The table of a weight."""
    g2 = float(np.dot(piece.gravity, piece.gravity))
    if g2 == 0.0:
        raise UserError(f"the weight {load.name} weighs nothing: there is no gravity", do="add [effects.gravity]")
    mass = float(np.dot(load.force, piece.gravity)) / g2
    return {"on": piece.planks[load.plank].name, "mass": mass, "at": list(load.place)}
