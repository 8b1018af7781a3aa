"""A session that begins where another one stands: its first frame is the edit from there."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from restshape.application import Application
from restshape.scene.edit_script import Script
from restshape.scene.model import Scene
from restshape.shape.gesture import towards
from restshape.shape.outline import Layout, Outline
from restshape.shape.script_session import Step
from restshape.shape.session import EditSession

OF_SHAPES = ("shape", "parameters")
"""Tables whose numbers the outline has taken up."""


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
        self._first, self.outline = _first_step(self.outline, scene, before, new_mesh)
        if self._first.change == "values":
            self._first.change = self._scene_change(before.scene, scene)
        self._mark()

    @property
    def first_change(self) -> str:
        """What changes in the first frame."""
        return self._first.change

    def _first_step(self) -> Step:
        return self._first


def _first_step(outline: Outline, scene: Scene, before: Standing, new_mesh: bool) -> tuple[Step, Outline]:
    """The step from where a session stands to a shape, and the shape as a variation of the one there, where it is."""
    old = before.outline
    if (new_mesh and before.moved) or not _same_layout(outline.layout, old.layout):
        return Step("shape"), outline
    if np.array_equal(outline.points, old.points) and np.array_equal(outline.bulges, old.bulges):
        return Step("values"), old
    if new_mesh or not _same_but_shape(scene, before.scene):
        return Step("shape"), outline
    wanted = old.moved(outline.points, outline.bulges)
    return Step("move", gesture=towards("sweep", old, wanted), c=(1.0, 0.0)), wanted


def _same_layout(one: Layout, other: Layout) -> bool:
    """Whether two layouts have the same names, edges and loops."""
    keys = ("vertex_names", "edges", "loops", "embedded", "groups")
    return all(getattr(one, key) == getattr(other, key) for key in keys)


def _same_but_shape(one: Scene, other: Scene) -> bool:
    """Whether two scenes differ in their shapes at most."""
    keys = [key for key in type(one).model_fields if key not in OF_SHAPES]
    return type(one) is type(other) and all(getattr(one, key) == getattr(other, key) for key in keys)
