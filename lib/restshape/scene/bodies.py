"""Bodies that cloth comes to lie on, and where it lies before it falls."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, ClassVar, Self, TypeVar

from pydantic import BaseModel, Field, model_validator

from restshape.scene.descriptions import listing
from restshape.scene.expressions import Expression, Value
from restshape.scene.units import UnitError
from restshape.scene.values import InSI, Length, Strict, Whole, only_one

if TYPE_CHECKING:
    from restshape.scene.model import Support

Size = Annotated[Value, InSI("length", formula=True)]
Ratio = Annotated[Value, InSI("number", formula=True)]
Turn = Annotated[Value, InSI("angle", formula=True)]
Form = TypeVar("Form", bound=Strict)
Place = tuple[Size, Size, Size]
Direction = tuple[Ratio, Ratio, Ratio]
Angles = tuple[Turn, Turn, Turn]
ORIGIN = (0.0, 0.0, 0.0)
POINTS = {"sphere": ("center",), "plane": ("point",), "box": ("center",), "capsule": ("start", "end")}
"""Keys that are places, by kind of body."""


class Sphere(Strict):
    """A ball by centre [m] and radius [m].

    Args:
        center: its centre.
        radius: its radius.
    """

    center: Place
    radius: Size


class Plane(Strict):
    """A half-space behind a plane through a point [m]; the normal points out of it.

    Args:
        point: a point in it.
        normal: towards where cloth may be.
    """

    point: Place
    normal: Direction


class Box(Strict):
    """A box by centre and half sizes [m], turned about x, then y, then z [rad]; edges are rounded within the sizes.

    Args:
        center: its centre.
        half: half its sizes, with the rounding of its edges.
        rotate: angles about x, then y, then z.
        radius: of its rounded edges.
    """

    center: Place
    half: tuple[Size, Size, Size]
    rotate: Angles = ORIGIN
    radius: Size = 0.0


class Capsule(Strict):
    """All within a radius [m] of the line from start to end [m].

    Args:
        start, end: the ends of its axis.
        radius: its radius.
    """

    start: Place
    end: Place
    radius: Size


class Body(Strict):
    """``[bodies.NAME]``: a sphere, plane, box or capsule, which cloth does not enter; ``friction`` is Coulomb's.

    All numbers may be formulas of the parameters.

    Args:
        sphere, plane, box, capsule: its form; one of them.
        friction: Coulomb's coefficient.
    """

    kinds: ClassVar[tuple[str, ...]] = ("sphere", "plane", "box", "capsule")

    sphere: Sphere | None = None
    plane: Plane | None = None
    box: Box | None = None
    capsule: Capsule | None = None
    friction: Ratio = 0.0

    @property
    def kind(self) -> str:
        """Which of sphere, plane, box and capsule this body is."""
        return only_one(self, self.kinds)

    @property
    def form(self) -> Sphere | Plane | Box | Capsule:
        """The keys of its kind."""
        return getattr(self, self.kind)

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        only_one(self, self.kinds)
        return self

    def evaluated(self, parameters: dict[str, float]) -> Self:
        """The body with numbers in place of formulas.

        Raises:
            UnitError: a size is not positive, a normal has no direction, a formula gives no number.
        """
        form = evaluated(self.form, parameters)
        _refuse_flat(self.kind, form)
        friction = number(self.friction, parameters)
        if friction < 0.0:
            raise UnitError(f"the coefficient of friction is {friction:g}", "write at least 0")
        return self.model_copy(update={self.kind: form, "friction": friction})


class Start(Strict):
    """``[start]``: where the flat cloth lies at first: turned about x, then y, then z through ``about``, then moved.

    Supports hold it there. ``scatter`` moves each free node by up to so much along each axis, at random, but by the
    same for the same ``seed``.

    Args:
        move: displacement, after it is turned.
        turn: angles about x, then y, then z.
        about: the point that stays where it is turned.
        scatter: the most that free nodes move at random along each axis.
        seed: of the random numbers.
    """

    move: Place = ORIGIN
    turn: Angles = ORIGIN
    about: Place = ORIGIN
    scatter: Annotated[Length, Field(ge=0)] = 0.0
    seed: Annotated[Whole, Field(ge=0)] = 0


def bodies_of(scene: BaseModel) -> Mapping[str, Body]:
    """The bodies of a scene by name; none where no physics of it has them."""
    return getattr(scene, "bodies", {})


def start_of(scene: BaseModel) -> Start | None:
    """Where the cloth of a scene lies at first; None of a scene without cloth."""
    return (getattr(scene, "start", None) or Start()) if hasattr(scene, "bodies") else None


def pins_of(scene: BaseModel) -> Mapping[str, Support]:
    """The supports of a scene that a hand may take hold of, by name: those of cloth, which is in space."""
    return getattr(scene, "supports", {}) if start_of(scene) is not None else {}


def number(value: Value, parameters: dict[str, float]) -> float:
    """A value as a number.

    Raises:
        UnitError: its formula gives none.
    """
    if not isinstance(value, Expression):
        return value
    found = float(value.evaluate(0.0, 0.0, parameters))
    if not abs(found) < float("inf"):
        raise UnitError(f"the formula {value.text!r} gives {found}", "change it, or the parameters")
    return found


def evaluated(form: Form, parameters: dict[str, float]) -> Form:
    """A copy of a model, of numbers and tuples of numbers, with numbers in place of formulas.

    Raises:
        UnitError: a formula gives no number.
    """
    names = type(form).model_fields
    return form.model_copy(update={name: _number_of(getattr(form, name), parameters) for name in names})


def _number_of(value: Value | tuple[Value, ...], parameters: dict[str, float]) -> float | tuple[float, ...]:
    """A number in place of a formula, and in tuples of them."""
    if isinstance(value, tuple):
        return tuple(number(part, parameters) for part in value)
    return number(value, parameters)


def _refuse_flat(kind: str, form: Sphere | Plane | Box | Capsule) -> None:
    """Refuses a body of numbers without a size or a direction."""
    if isinstance(form, Plane):
        if not any(form.normal):
            raise UnitError("the normal of a plane has no direction", "write one that is not 0 0 0")
        return
    sizes = [number(size, {}) for size in (form.half if isinstance(form, Box) else (form.radius,))]
    if min(sizes) <= 0.0:
        raise UnitError(f"a size of the {kind} is {min(sizes):g} m", "write one greater than 0")
    radius = number(form.radius, {})
    if isinstance(form, Box) and not 0.0 <= radius <= min(sizes):
        most = f"at least 0 and at most the smallest half size, {min(sizes):g} m"
        raise UnitError(f"the radius of the box's edges is {radius:g} m", f"write {most}")


def body_words(body: Body) -> str:
    """Kind, keys and friction of a body, for people."""
    form = body.form
    keys = [f"{key} {listing(getattr(form, key))}" for key in type(form).model_fields]
    return f"{body.kind}, {', '.join(keys)}, friction {listing(body.friction)}"


def start_words(start: Start) -> str:
    """Where cloth starts, for people."""
    moved = f"turned by {listing(start.turn)} rad about {listing(start.about)} m, moved by {listing(start.move)} m"
    return moved + (f", scattered by {start.scatter:g} m with the seed {start.seed}" if start.scatter else "")
