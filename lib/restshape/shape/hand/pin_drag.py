"""What the hand takes hold of in space; pins under it: supports that are displaced."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.errors import UserError
from restshape.scene.bodies import bodies_of, pins_of
from restshape.scene.edit_script import SUPPORTS
from restshape.scene.expressions import Expression, Value
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.panels import panels_of
from restshape.scene.plain_values import Table, tables_in
from restshape.shape.hand.panel_drag import begin_panel_drag
from restshape.shape.hand.point_grab import begin_point_grab, is_point
from restshape.shape.hand.rigid_body_drag import begin_body_drag
from restshape.shape.hand.space_grab import Place, SpaceGrab, in_space
from restshape.shape.outline import Outline
from restshape.shape.panels.panel_placement import PatternPlacement

AXES = "xyz"


def pin_named(scene: Scene, outline: Outline, on: str) -> str | None:
    """The support that a press means: ``supports.NAME``, or a name that is no entity's and no body's; None: none."""
    pins, bare = pins_of(scene), on.removeprefix(SUPPORTS)
    taken = on in bodies_of(scene) or on in outline.layout.entities or on in outline.groups
    return bare if bare in pins and (bare != on or not taken) else None


def place_of_pin(scene: Scene, outline: Outline, name: str) -> Place:
    """Where a support holds the sheet [m]: the mean place of its entities, in the directions that it fixes."""
    support, pattern = scene.supports[name], PatternPlacement(scene)
    entities = [outline.entity(on) for on in support.on]
    pieces = np.array([outline.layout.control_piece[outline.control_points(one)[0]] for one in entities])
    centres = np.array([outline.centroid(one) for one in entities])
    if len(set(pieces.tolist())) == 1:
        centres, pieces = centres.mean(axis=0)[None], pieces[:1]
    X = np.mean(pattern.coordinates(centres, pieces), axis=0)
    place = np.mean(pattern.places(centres, pieces), axis=0)
    for axis, value in support.fix.items():
        if axis in AXES:
            moved = value.evaluate(X[0], X[1], scene.parameters) if isinstance(value, Expression) else value
            place[AXES.index(axis)] += float(moved)
    x, y, z = place.tolist()
    return x, y, z


@dataclass(slots=True)
class PinDrag(SpaceGrab):
    """A support that the hand holds; arguments as of `SpaceGrab`, its name without a prefix."""

    def moved(self, scene: Scene, c: Place) -> Scene:
        """The scene whose support is displaced by what it was at the press, plus a way c [m].

        Raises:
            UserError: it is there no more, or free in a direction that c has.
        """
        if self.name not in pins_of(scene):
            raise UserError(f"the support {self.name!r} is there no more")
        support, written = self.before[1].supports[self.name], self._written()
        for axis, way in zip(AXES, c):
            if way == 0.0:
                continue
            if axis not in support.fix:
                fixed = ", ".join(AXES[k] for k in range(3) if AXES[k] in support.fix)
                what = f"the support {self.name!r} fixes no displacement along {axis}"
                raise UserError(what, do=f'drag it along {fixed}, or add "{axis}" to its fix')
            written[axis] = displaced(support.fix[axis], way)
        return revise(scene, f"supports.{self.name}.fix", written)

    def _written(self) -> Table:
        """What the scene at the press says of the directions that are fixed."""
        raw = tables_in(self.before[1].raw, "supports")[self.name].get("fix")
        return dict(raw) if isinstance(raw, dict) else dict.fromkeys(self.before[1].supports[self.name].fix, 0.0)


def displaced(value: Value, way: float) -> float | str:
    """A displacement that is larger by a way [m], as a scene would hold it."""
    return f"({value.text}) + ({way!r})" if isinstance(value, Expression) else value + way


def begin_pin_drag(outline: Outline, scene: Scene, name: str, at: tuple[float, ...] | None) -> PinDrag:
    """A hand that takes hold of a support at a point [m], else at its own place.

    Raises:
        UserError: it is a plane of symmetry.
    """
    if not set(AXES) & set(scene.supports[name].fix):
        raise UserError(f"the support {name!r} is a plane of symmetry, which no hand moves", do="take hold of a pin")
    origin = in_space(at, place_of_pin(scene, outline, name))
    return PinDrag(name, origin, origin, (outline, scene))


def is_in_space(outline: Outline, scene: Scene, on: str) -> bool:
    """Whether a press takes hold of a body, a whole panel or a support in space, and of no part of the shape."""
    named = on in bodies_of(scene) or on in panels_of(scene) or is_point(outline, scene, on)
    return named or pin_named(scene, outline, on) is not None


def begin_space_grab(outline: Outline, scene: Scene, on: str, at: tuple[float, ...] | None) -> SpaceGrab | None:
    """A hand that takes hold of a body or a support in space at a point [m]; None where it means a part of the shape.

    Raises:
        UserError: it cannot be moved.
    """
    if on in bodies_of(scene):
        return begin_body_drag(outline, scene, on, at)
    if on in panels_of(scene):
        return begin_panel_drag(outline, scene, on, at)
    if is_point(outline, scene, on):
        return begin_point_grab(outline, scene, at)
    pin = pin_named(scene, outline, on)
    return None if pin is None else begin_pin_drag(outline, scene, pin, at)
