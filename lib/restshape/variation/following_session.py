"""A session that begins where another one stands: its first frame is the edit from there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from restshape.application import Application
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.shape.given_shape import same_layout, varied
from restshape.shape.hand.gesture import other_curves, towards
from restshape.shape.outline import Outline
from restshape.shape.script_session import Step
from restshape.shape.session import EditSession


class Standing(NamedTuple):
    """Where a session stands.

    Args:
        outline, scene: of its last frame.
        moved: its mesh is another one than at its start.
    """

    outline: Outline
    scene: Scene
    moved: bool


class FollowingSession(EditSession):
    """A session whose first frame goes on from the last frame of another one.

    Args:
        scene, script, application, outline: as of every session.
        before: where the other session stands.
        new_mesh: the first frame has a new mesh wherever the mesh has moved, that of a replay of its own; else nodes
            move to where the first shape has them.

    Raises:
        UserError: the scene's shape is not valid.
    """

    def __init__(
        self,
        scene: Scene,
        script: Script,
        application: Application,
        before: Standing,
        new_mesh: bool,
        outline: Outline | None = None,
    ) -> None:
        super().__init__(scene, script, application, outline)
        change = self._scene_change(before.scene, scene)
        self._first, self.outline = _first_step(self.outline, before, change, new_mesh)
        self._mark()

    @property
    def first_change(self) -> str:
        """What changes in the first frame."""
        return self._first.change

    def _first_step(self) -> Step:
        return self._first


def _first_step(outline: Outline, before: Standing, change: str, new_mesh: bool) -> tuple[Step, Outline]:
    """The step from where a session stands to a shape, and the shape as a variation of the one there, where it is.

    Args:
        outline: the shape.
        before: where the session stands.
        change: of the scene, as for a shape that stays.
        new_mesh: as of `FollowingSession`.
    """
    old = before.outline
    if (new_mesh and before.moved) or not same_layout(outline.layout, old.layout):
        return Step("shape"), outline
    wanted = varied(old, outline)
    if np.array_equal(wanted.points, old.points) and not other_curves(old, wanted):
        return Step(change), old
    if new_mesh or change != "values":
        return Step("shape"), outline
    return Step("move", gesture=towards("sweep", old, wanted), c=(1.0, 0.0)), wanted
