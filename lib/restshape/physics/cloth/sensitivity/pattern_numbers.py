"""Numbers that draw the pattern: those of its corners, darts and pleats, whose nodes follow the outline."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.sensitivity.scene_numbers import ChangingNumber
from restshape.scene.model import Scene
from restshape.sensitivity.outline_velocity import outline_velocity
from restshape.shape.build import unchecked_outline

STEP = 1e-5
"""Of the differences of control points, over the value, or for 0 this [SI]: their rates are good to ten digits."""
PLACING = ("at", "angle", "turn", "about", "move", "radius", "grain", "layer")
"""Keys of panels that lay them somewhere, and draw nothing."""


def draws(key: Sequence[str]) -> bool:
    """Whether the number at a key is one of the pattern's outline."""
    if key[0] == "panels":
        return len(key) > 2 and key[2] not in PLACING
    return key[0] in ("shape", "darts") or (key[0] == "seams" and len(key) > 3 and key[2] == "pleats")


def lays(key: Sequence[str]) -> bool:
    """Whether the number at a key lays a panel somewhere, or turns its grain."""
    return key[0] == "panels" and not draws(key)


def pattern_motion(mesh: Mesh, number: ChangingNumber) -> np.ndarray | None:
    """Rates (n, 2) of the places of a mesh's nodes in the material, a unit of a number; None where none moves.

    Nodes follow the outline as in an edit. Control points are differenced, which no drape enters.

    Raises:
        UserError: the mesh would be another one on one side of the value.
    """
    if not (number.parameter or draws(number.key.split("."))):
        return None
    step = STEP * (abs(number.value) or 1.0)
    return outline_velocity(mesh, number.scene, [_end(number, h) for h in (step, -step)], step)


def _end(number: ChangingNumber, step: float) -> Scene:
    """The scene with the number larger by a step.

    Raises:
        UserError: it makes no sense there.
    """
    try:
        scene = number.scene_with(number.value + step)
        unchecked_outline(scene.shape, scene.folder)
    except UserError as error:
        side = "larger" if step > 0.0 else "smaller"
        what = (
            f"{number.key} is at an end of what it may be, and the pattern has no derivative there: a little {side}, "
        )
        raise UserError(f"{what}{error.what}", "--by", "choose another value, or name another number") from None
    return scene
