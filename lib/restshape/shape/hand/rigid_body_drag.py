"""Bodies under the hand: moved in space, turned about the vertical, made larger."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.bodies import POINTS, bodies_of, numbers_of
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.plain_values import table_in, tables_in
from restshape.shape.hand.space_grab import Place, SpaceGrab, in_space

if TYPE_CHECKING:
    from restshape.shape.outline import Outline

SIZES = {
    "sphere": ("radius",),
    "plane": (),
    "box": ("half", "radius"),
    "capsule": ("radius",),
    "cylinder": ("radius", "rounded"),
    "mesh": ("scale",),
    "mannequin": ("scale",),
}
"""Keys that are sizes, by kind of body."""
TURNS = {"box": "rotate", "mesh": "turn", "mannequin": "turn"}
"""Keys that are angles about x, y and z, by kind of body."""

ANY = 1.0
"""An angle [rad] that brings no body back to where it was, unless it is round."""
ROUNDING = 1e-12
"""Change of numbers below which they are the same, over the largest."""

Form = dict[str, Reals]
Change = Callable[[str, Form, float, "tuple[float, float] | None"], Form]
"""Gives a form of a kind changed by an amount, about a point [m]."""


def form_of(scene: Scene, name: str) -> tuple[str, Form]:
    """The kind of a body and the numbers of its keys, of formulas what they give."""
    body = bodies_of(scene)[name]
    numbers = body.evaluated(scene.parameters).form
    return body.kind, {key: np.array(getattr(numbers, key)) for key in numbers_of(numbers)}


def with_form(scene: Scene, name: str, kind: str, form: Form) -> Scene:
    """The scene whose body has these numbers; a formula whose number stays is kept.

    Raises:
        UserError: they make no body.
    """
    written, (_, before) = table_in(tables_in(scene.raw, "bodies")[name], kind), form_of(scene, name)
    # What is left out stays so where it stays: measures of mannequins follow others then.
    changed = {key: one for key, one in form.items() if key in written or not np.array_equal(one, before[key])}
    found = {key: _kept(written.get(key), before[key], value) for key, value in changed.items()}
    found = {key: value for key, value in written.items() if key not in found} | found
    return revise(scene, f"bodies.{name}.{kind}", found)


def _kept(written: object, before: Reals, value: Reals) -> object:
    """Numbers, and in place of each that is what it was before what is written for it."""
    if value.ndim == 0:
        return written if written is not None and value == before else value.item()
    parts = written if isinstance(written, (list, tuple)) else [None] * len(value)
    return [_kept(part, old, new) for part, old, new in zip(parts, before, value)]


def place_of(scene: Scene, name: str) -> Place:
    """Where a body is [m]: the mean of its places."""
    x, y, z = _centre(*form_of(scene, name)).tolist()
    return x, y, z


def turned(kind: str, form: Form, angle: float, about: tuple[float, float] | None) -> Form:
    """The form turned by an angle [rad] about the vertical through a point [m], else its own place.

    Raises:
        UserError: it is round about that, so that nothing would change: it has no sides that would take cloth along.
    """
    axis = _axis(kind, form, about)
    if kind not in TURNS and _alike(form, _turned(kind, form, ANY, axis)):
        do = "turn it about a point beside it, give it the form of a box, or leave it"
        raise UserError(f"a {kind} that turns about its own vertical axis stays as it is", do=do)
    form = _turned(kind, form, angle, axis)
    # The last of its turns is that about z.
    key = TURNS.get(kind)
    return form | {key: form[key] + (0.0, 0.0, angle)} if key else form


def _turned(kind: str, form: Form, angle: float, axis: Reals) -> Form:
    """The form with its places, and a normal, turned by an angle [rad] about the vertical through a point (3,) [m]."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    form = form | {key: axis + R @ (form[key] - axis) for key in POINTS[kind]}
    return form | {"normal": R @ form["normal"]} if kind == "plane" else form


def scaled(kind: str, form: Form, factor: float, about: tuple[float, float] | None) -> Form:
    """The form made larger about a point of the plane [m], else its own place, at its height.

    Raises:
        UserError: it has no size.
    """
    if not SIZES[kind]:
        raise UserError(f"a {kind} has no size", do="move it, or turn it")
    axis = _axis(kind, form, about)
    points = {key: axis + factor * (form[key] - axis) for key in POINTS[kind]}
    return form | points | {key: factor * form[key] for key in SIZES[kind]}


def _alike(before: Form, after: Form) -> bool:
    """Whether two forms are the same but for rounding, over the largest of their numbers."""
    size = max(float(np.abs(one).max()) for one in before.values())
    return all(np.abs(after[key] - before[key]).max() <= ROUNDING * size for key in before)


def _centre(kind: str, form: Form) -> Reals:
    return np.mean([form[key] for key in POINTS[kind]], axis=0)


def _axis(kind: str, form: Form, about: tuple[float, float] | None) -> Reals:
    """The point (3,) about which a form turns or grows, at its own height."""
    centre = _centre(kind, form)
    return centre if about is None else np.array([*about, centre[2]])


@dataclass(slots=True)
class RigidBodyDrag(SpaceGrab):
    """A body that the hand holds.

    Args:
        name, origin, cursor, before, c: as of `SpaceGrab`.
        kind, form: of it at the press.
    """

    kind: str = ""
    form: Form = field(default_factory=dict)

    def moved(self, scene: Scene, c: Place) -> Scene:
        """The scene with the body where it was at the press, plus a way c [m]; its sizes stay as they are now.

        Raises:
            UserError: the body is there no more.
        """
        if self.name not in bodies_of(scene) or bodies_of(scene)[self.name].kind != self.kind:
            raise UserError(f"the body {self.name!r} is there no more")
        points: Form = {key: self.form[key] + c for key in POINTS[self.kind]}
        return with_form(scene, self.name, self.kind, form_of(scene, self.name)[1] | points)


def begin_body_drag(outline: Outline, scene: Scene, name: str, at: tuple[float, ...] | None) -> RigidBodyDrag:
    """A hand that takes hold of a body at a point [m], else at its own place."""
    kind, form = form_of(scene, name)
    origin = in_space(at, place_of(scene, name))
    return RigidBodyDrag(name, origin, origin, (outline, scene), kind=kind, form=form)
