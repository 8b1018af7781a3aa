"""Events of furniture that change what the piece is made of: planks drawn and deleted, joints made, weights put."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
from restshape_apps.furniture.physics.plank_phrases import lying
from restshape_apps.furniture.scene.furniture import BESIDE
from restshape_apps.furniture.shape import plank_edits
from restshape_apps.furniture.shape.free_ends import free_ends
from restshape_apps.furniture.shape.plank_scene import top_of, weighing
from restshape_apps.furniture.shape.planks import Joint, Piece, Plank

from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.scene.source import suggestion
from restshape.scene.space_values import number

Change = tuple[Piece, str]
"""A piece, and what there is to note of how it came to be."""


def plank_number(piece: Piece, name: str) -> int:
    """The number of a plank by its name.

    Raises:
        UserError: there is none of that name.
    """
    names = [plank.name for plank in piece.planks]
    if name not in names:
        raise UserError(f"there is no plank {name!r}", do=suggestion(name, names))
    return names.index(name)


def drawn(piece: Piece, scene: Scene, event: Any) -> Change:
    """The piece with a plank by two lines, as thick and made as the scene's are where the event says nothing else."""
    _refuse_taken(piece, event.name)
    thickness = event.thickness or number(scene.wood.thickness, scene.parameters)
    wood = event.wood or scene.wood.name
    plank = Plank.between(event.name, event.start, event.to, event.width, thickness, wood=wood)
    grown = plank_edits.added(piece, plank, scene.joints.reach, event.fastener or scene.fastener.name)
    free = [end.missed(grown) for end in free_ends(grown, [len(grown.planks) - 1])]
    return grown, "; ".join(filter(None, [_met(piece, grown), *free]))


def joined(piece: Piece, scene: Scene, event: Any) -> Change:
    """The piece with joints and feet where a plank has come near others or the floor."""
    plank = plank_number(piece, event.on)
    found = plank_edits.connected(piece, plank, scene.joints.reach, event.fastener or scene.fastener.name)
    if len(found.joints) == len(piece.joints) and len(found.feet) == len(piece.feet):
        missed = [end.words(piece) for end in free_ends(piece, [plank])] or lying(piece, plank)
        raise UserError(f"{event.on} is near nothing that it is not joined to already", do=", ".join(missed))
    return found, _met(piece, found)


def put(piece: Piece, scene: Scene, event: Any) -> Change:
    """The piece with a mass on a plank."""
    if event.name not in {load.name for load in piece.weights}:
        _refuse_taken(piece, event.name)
    on = plank_number(piece, event.on)
    at = event.at or top_of(piece.planks[on])
    if max(map(abs, at)) > 0.5:
        plank = piece.planks[on]
        size, middle = (", ".join(f"{x:.4g}" for x in values) for values in (plank.size, plank.centre))
        where = f"a plank of ({size}) m with its middle at ({middle}) m"
        raise UserError(f"the place {list(at)} is beside {event.on}, {where}", do=BESIDE)
    load = weighing(scene, event.name, on, event.mass, at)
    note = "" if np.any(load.force) else f"{event.name} weighs nothing: there is no gravity (add [effects.gravity])"
    return plank_edits.loaded(piece, load), note


def without(piece: Piece, scene: Scene, event: Any) -> Change:
    """The piece without a plank and what is on it, or without a weight."""
    if event.on in {load.name for load in piece.weights}:
        return replace(piece, weights=tuple(load for load in piece.weights if load.name != event.on)), ""
    if event.on in {load.name for load in piece.pushes}:
        do = f"set pushes.{event.on}.force to [0, 0, 0], or leave its plank out"
        raise UserError(f"{event.on!r} is a push, and pushes cannot be deleted", do=do)
    names = [plank.name for plank in piece.planks]
    if event.on not in names:
        known = [*names, *(load.name for load in piece.weights)]
        raise UserError(f"there is no plank or weight {event.on!r}", do=suggestion(event.on, known))
    plank = names.index(event.on)
    gone = [f"weight {load.name}" for load in piece.weights if load.plank == plank]
    gone += [f"push {load.name}" for load in piece.pushes if load.plank == plank]
    return plank_edits.removed(piece, plank), f"with {event.on} go {' and '.join(gone)}" if gone else ""


CHANGES: dict[str, Callable[[Piece, Scene, Any], Change]] = {
    "plank": drawn,
    "connect": joined,
    "weight": put,
    "delete": without,
}
"""What each of these events does to a piece; they raise `UserError` where they cannot."""


def _refuse_taken(piece: Piece, name: str) -> None:
    """Refuse a name that stands for something already."""
    if name in {one.name for one in (*piece.planks, *piece.weights, *piece.pushes)}:
        raise UserError(f"there is {name!r} already", do="give it another name")


def _met(before: Piece, after: Piece) -> str:
    """Which joints and feet a piece has more than before."""

    def described(joint: Joint) -> str:
        return f"{after.planks[joint.i].name} on {after.planks[joint.j].name}"

    met = [described(joint) for joint in after.joints[len(before.joints) :]]
    met += [f"{after.planks[foot.plank].name} on the floor" for foot in after.feet[len(before.feet) :]]
    return f"joined: {', '.join(met)}" if met else "joined to nothing: it is near no face and not near the floor"
