"""What the hand holds of a sheet in space: a point of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from restshape.errors import UserError
from restshape.scene.held_point import CLOTH, can_hold, hold_of
from restshape.scene.load import revise, without
from restshape.scene.model import Scene
from restshape.shape.hand.space_grab import Draggable, Place, SpaceGrab
from restshape.shape.outline import Outline
from restshape.shape.panels.panel_placement import PatternPlacement
from restshape.shape.pieces import PieceFinder, distance_outside
from restshape.shape.script_session import Step

KEY = "hold"
"""Table of scenes that says which point is held, and where."""
BESIDE = 0.03
"""Share of the shape's size within which a point beside it is on its edge, where the scene has no mesh size: sides of
triangles cut off round edges."""


@dataclass(slots=True, kw_only=True)
class PointGrab(SpaceGrab):
    """A point of the sheet that the hand holds; arguments as of `SpaceGrab`.

    Args:
        at: the point in the pattern plane [m].
        seen: the hand has been at a place in space: before that the simulation alone knows where the point is.
    """

    at: tuple[float, float]
    seen: bool = False

    def moved(self, scene: Scene, c: Place) -> Scene:
        """The scene whose point is held where the cursor is."""
        return revise(scene, KEY, {"at": [*self.at], "to": [*self.cursor]})

    def through(self, path: Sequence[tuple[float, ...]]) -> Sequence[tuple[float, ...]]:
        """Points [m] that the cursor goes through, in space.

        Raises:
            UserError: the first one has no height, and the hand has been nowhere yet.
        """
        if not self.seen and len(path[0]) < 3:
            raise UserError("a point of the cloth is held in space, and this place has no z", do="write three numbers")
        return SpaceGrab.through(self, path)

    def whole_way(self, path: Sequence[tuple[float, ...]]) -> Sequence[tuple[float, ...]]:
        """Points [m] of a way of several frames: from where the hand is; from the first one, where it was nowhere."""
        if self.seen:
            return [self.cursor, *path]
        return path if len(path) > 1 else [path[0], path[0]]

    def dragged(self, session: Draggable, point: tuple[float, ...]) -> Step:
        """The frame in which the point goes to a place [m]."""
        before = self.cursor, self.seen
        c = self.way_to(point)
        if self.seen and self.cursor == before[0]:
            return Step("none")
        step = session.revised(lambda: self.moved(session.scene, c))
        if step.refused:
            self.cursor, self.seen = before
        else:
            self.c, self.seen = c, True
        return step

    def let_go(self, session: Draggable) -> Step:
        """The frame in which the hand lets go: the point is held as it was before the press, which mostly is not."""
        if not self.seen:
            return Step("none")
        hold = hold_of(self.before[1])
        if hold is None:
            return session.revised(lambda: without(session.scene, KEY))
        return session.revised(lambda: revise(session.scene, KEY, {"at": [*hold.at], "to": [*hold.to]}))


def is_point(outline: Outline, scene: Scene, on: str) -> bool:
    """Whether a press takes hold of a point of the sheet, and of nothing that has this name."""
    return on == CLOTH and can_hold(scene) and on not in outline.layout.entities and on not in outline.groups


def begin_point_grab(outline: Outline, scene: Scene, at: tuple[float, ...] | None) -> PointGrab:
    """A hand that takes hold of a point of the sheet, named in the pattern plane [m].

    Raises:
        UserError: no point is named, or one that is farther from the cloth than a triangle is wide.
    """
    if at is None or len(at) != 2:
        what = "a point of the cloth is named in the pattern plane"
        raise UserError(what, do='add "at": [x, y] to the press; drags then say where in space it is held')
    point = np.array(at)
    if distance_outside(outline, point) > (scene.mesh.size or BESIDE * outline.size):
        what = f"there is no cloth at ({at[0]:.6g}, {at[1]:.6g}) m of the pattern"
        raise UserError(what, do="name a point inside of the outline")
    piece = PieceFinder(outline).of_point(point)
    x, y, z = PatternPlacement(scene).places(point[None], np.array([piece]))[0].tolist()
    return PointGrab(CLOTH, (x, y, z), (x, y, z), (outline, scene), at=(at[0], at[1]))
