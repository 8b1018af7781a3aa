"""Panels under the hand: moved and turned as a whole in the pattern plane, and what their folds ask of edits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.panels import folds_of, frames_of, panels_of
from restshape.scene.pattern_packing import PanelFrame, turned
from restshape.scene.unfolding import IMAGE
from restshape.scene.values import PART
from restshape.shape.given_shape import ShapeFollower
from restshape.shape.hand.space_grab import Draggable, Place, SpaceGrab, in_space
from restshape.shape.outline import Entity, Outline
from restshape.shape.script_session import Step


def with_frames(scene: Scene, frames: Mapping[str, PanelFrame]) -> Scene:
    """The scene whose panels lie in these frames in the pattern plane.

    Raises:
        UserError: they make no scene.
    """
    if "layout" in scene.raw:
        raise UserError('layout = "auto" packs all panels', "layout", "leave it out, so that panels lie where they say")
    for name, frame in frames.items():
        known = panels_of(scene)[name]
        if known.at != (frame.x, frame.y):
            scene = revise(scene, f"panels.{name}.at", [frame.x, frame.y])
        if known.angle != frame.angle:
            scene = revise(scene, f"panels.{name}.angle", frame.angle)
    return scene


@dataclass(slots=True)
class PanelDrag(SpaceGrab):
    """A whole panel that the hand moves in the pattern plane; arguments as of `SpaceGrab`."""

    def moved(self, scene: Scene, c: Place) -> Scene:
        """The scene with the panel where it was at the press, plus a way c [m]; all others keep their places.

        Raises:
            UserError: the panel is there no more, or is to leave the plane.
        """
        if c[2] != 0.0:
            raise UserError(f"{self.name} is a panel, which moves in the pattern plane", do="leave z out")
        frames = dict(frames_of(self.before[1]))
        if self.name not in panels_of(scene):
            raise UserError(f"the panel {self.name!r} is there no more")
        x, y, angle = frames[self.name]
        return with_frames(scene, {**frames, self.name: PanelFrame(x + c[0], y + c[1], angle)})

    def dragged(self, session: Draggable, point: tuple[float, ...]) -> Step:
        """The frame in which the cursor goes to a point [m]."""
        c = self.way_to(point)
        if c == self.c:
            return Step("none")
        scene, follower = session.scene, ShapeFollower(session.outline, session.scene)

        def wanted(_: float = 1.0) -> Scene:
            return self.moved(scene, c)

        step = session.revised(wanted, partial(follower, part=1.0, whole=wanted))
        self.c = self.c if step.refused else c
        return step


def begin_panel_drag(outline: Outline, scene: Scene, name: str, at: tuple[float, ...] | None) -> PanelDrag:
    """A hand that takes hold of a whole panel at a point of the pattern plane [m], else in its middle."""
    x, y = outline.centroid(outline.entity(name)).tolist()
    origin = in_space(at, (x, y, 0.0))
    return PanelDrag(name, origin, origin, (outline, scene))


def turned_panel(scene: Scene, name: str, angle: float, about: tuple[float, float]) -> Scene:
    """The scene with a panel turned in the pattern plane by an angle [rad] about a point [m]."""
    frames = dict(frames_of(scene))
    x, y, before = frames[name]
    u, v = turned((x - about[0], y - about[1]), angle)
    return with_frames(scene, {**frames, name: PanelFrame(about[0] + u, about[1] + v, before + angle)})


def fold_beside(outline: Outline, scene: Scene, entity: Entity) -> Reals | None:
    """Two points (2, 2) [m] of the fold of the panel that an entity is part of; None where it has none.

    Raises:
        UserError: the entity is part of several panels, one of which is cut on the fold.
    """
    folds = folds_of(scene)
    pieces = set(outline.layout.control_piece[outline.control_points(entity)].tolist())
    beside = [folds[name] for k, name in enumerate(outline.piece_names) if k in pieces and name in folds]
    if not beside:
        return None
    if len(pieces) > 1:
        raise UserError("panels that are cut on the fold are moved one by one", do="name a part of one panel")
    edge = outline.edges[outline.entity(beside[0]).edges[0]]
    return np.asarray(outline.points[[edge.start, edge.end]])


def refuse_foreign_part(outline: Outline, scene: Scene, name: str) -> None:
    """Refuses a new part of a panel, of an outline that has it, where another load of the panels would not have it.

    Raises:
        UserError: its name is not one that the panel gives; or it is a hole of one half of a panel on the fold.
    """
    if not frames_of(scene):
        return
    entity = outline.entity(name)
    panel = outline.piece_names[int(outline.layout.control_piece[outline.control_points(entity)[0]])]
    other = f"{panel}.{IMAGE}.{name.removeprefix(f'{panel}.')}"
    if panel in folds_of(scene) and other not in outline.layout.entities:
        what = f"{name} would be in one half of the panel {panel!r}, which is cut on the fold"
        raise UserError(what, do=f"name it {panel}.{name.rpartition('.')[2]}, so that both halves have it")
    first, _, own = name.partition(".")
    if first != panel or not PART.fullmatch(own):
        what = f"the name {name!r} is none of a part of the panel {panel!r}, in which it would be"
        last = name.rpartition(".")[2]
        raise UserError(what, do=f"name it {panel}.{last if PART.fullmatch(last) else 'new'}")
