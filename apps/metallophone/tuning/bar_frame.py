"""Frames of a bar whose scene changes otherwise than by edits."""

from __future__ import annotations

import numpy as np

from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.shape.build import unchecked_outline
from restshape.shape.hand.gesture import other_curves, towards
from restshape.shape.outline import Outline
from restshape.shape.script_session import STILL
from restshape.shape.session import EditFrame
from restshape.shape.validity import problem


def bar_frame(index: int, change: str, scene: Scene, before: Outline, shown: Outline | None = None) -> EditFrame:
    """A frame that shows a scene.

    Args:
        index: of the frame.
        change: "start"; "shape": on a new mesh; or "move": on the mesh of the frame before.
        scene: that is shown.
        before: outline of the frame before; shown: that of the scene, where it is known to be valid.

    Raises:
        UserError: the scene has no valid outline.
    """
    outline = shown or unchecked_outline(scene.shape, scene.folder)
    wrong = None if shown else problem(outline)
    if wrong is not None:
        raise UserError(wrong)
    gesture, c, ended = None, STILL, change != "move"
    if change == "move":
        outline = before.moved(outline.points, outline.bulges)
        same = np.array_equal(outline.points, before.points) and not other_curves(before, outline)
        change = "values" if same else change
        gesture, c = (None, STILL) if same else (towards("set", before, outline), (1.0, 0.0))
    do = "start" if change == "start" else "set"
    return EditFrame(index, 0.0, 0, do, change, gesture, c, scene, None, outline=outline, edit_ended=ended)
