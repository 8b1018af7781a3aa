"""Rigid bodies in space, obstacles of what deforms, and where a flat sheet is at first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, fields
from math import dist
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Self

from pydantic import Field, PlainValidator, PrivateAttr, ValidationInfo, WithJsonSchema, model_validator

from restshape.errors import UserError
from restshape.scene.body_sizes import Sizes
from restshape.scene.descriptions import listing, with_symbol
from restshape.scene.space_values import ORIGIN, Angles, Direction, Place, Ratio, Size, evaluated, number
from restshape.scene.units import UnitError
from restshape.scene.values import UNIT_SCHEMA, Length, Strict, Whole, annotation_of, dimension_of, only_one, read_unit

if TYPE_CHECKING:
    from restshape.scene.model import Scene, Support

POINTS = {
    "sphere": ("center",),
    "plane": ("point",),
    "box": ("center",),
    "capsule": ("start", "end"),
    "cylinder": ("start", "end"),
    "mesh": ("move",),
    "mannequin": ("move",),
}
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
        normal: towards where no body is.
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


class Cylinder(Strict):
    """All within a radius [m] of an axis, between flat ends; edges are rounded within both.

    Args:
        start, end: the middles of its ends.
        radius: its radius.
        rounded: the radius of its rounded edges.
    """

    start: Place
    end: Place
    radius: Size
    rounded: Size = 0.0


class SurfaceName(str):
    """The name of a file as a scene writes it, and where it is.

    Attributes:
        path: the file; relative to the scene's folder.
    """

    path: Path

    @classmethod
    def read(cls, raw: object, info: ValidationInfo) -> SurfaceName:
        """The file that a scene names."""
        if not isinstance(raw, str) or not raw.strip():
            raise UnitError(f"{raw!r} is no name of a file", 'write file = "body.obj"')
        found = cls(raw)
        found.path = Path((info.context or {}).get("folder", ".")) / raw
        return found


class MeshBody(Strict):
    """A body of triangles from a file: made larger, turned about x, then y, then z about its file's origin, moved.

    The distance from it is interpolated on an even grid in a band on both sides of its surface.

    Args:
        file: a closed surface: .obj, .stl or .ply.
        unit: of the numbers in the file; left out, guessed from the longest side.
        move: where the file's origin is.
        turn: angles about x, then y, then z.
        scale: by which it is made larger.
        spacing: of the grid, before it is made larger; left out, as the error of the distance asks for.
        band: in which the grid is fine, before it is made larger; left out, 4 spacings and at least 8 mm.
    """

    settings: ClassVar[tuple[str, ...]] = ("file", "unit", "spacing", "band")
    """Keys that no edit moves."""

    file: Annotated[SurfaceName, PlainValidator(SurfaceName.read), WithJsonSchema({"type": "string"})]
    unit: Annotated[float, PlainValidator(read_unit), WithJsonSchema(UNIT_SCHEMA)] | None = None
    move: Place = ORIGIN
    turn: Angles = ORIGIN
    scale: Ratio = 1.0
    spacing: Annotated[Length, Field(gt=0)] | None = None
    band: Annotated[Length, Field(gt=0)] | None = None


class MannequinBody(Strict):
    """A mannequin by its measures, which stands on its origin and faces -y: made larger, turned, and moved.

    Args:
        height: from the floor to the top of the head.
        bust, waist, hip: girths.
        shoulder: width over the roots of both arms.
        neck, upper_arm: girths; left out, by height and bust.
        thigh: its girth; left out, by the hip.
        move: where its origin is.
        turn: angles about x, then y, then z.
        scale: by which it is made larger.
        size: of its triangles; left out, a 93rd of the height.
        spacing, band: as of a mesh.
    """

    settings: ClassVar[tuple[str, ...]] = ("size", "spacing", "band")
    """Keys that no edit moves."""

    height: Size = Sizes.height
    bust: Size = Sizes.bust
    waist: Size = Sizes.waist
    hip: Size = Sizes.hip
    shoulder: Size = Sizes.shoulder
    neck: Size | None = None
    upper_arm: Size | None = None
    thigh: Size | None = None
    move: Place = ORIGIN
    turn: Angles = ORIGIN
    scale: Ratio = 1.0
    size: Annotated[Length, Field(gt=0)] | None = None
    spacing: Annotated[Length, Field(gt=0)] | None = None
    band: Annotated[Length, Field(gt=0)] | None = None

    @property
    def sizes(self) -> Sizes:
        """The measures of a mannequin of numbers."""
        return Sizes(**{key: getattr(self, key) or 0.0 for key in MEASURES})

    def completed(self) -> Self:
        """The mannequin, of numbers, with all of its measures.

        Raises:
            UnitError: no body has these.
        """
        try:
            sizes = self.sizes.completed()
        except UserError as error:
            raise UnitError(error.what, error.do) from error
        return self.model_copy(update=asdict(sizes))


Forms = Sphere | Plane | Box | Capsule | Cylinder | MeshBody | MannequinBody
MEASURES = tuple(one.name for one in fields(Sizes))
"""Keys of a mannequin with which its surface is made again."""


def numbers_of(form: Forms) -> tuple[str, ...]:
    """The keys of a form that are numbers, or tuples of them, by which a body is moved and made larger."""
    fixed = form.settings if isinstance(form, MeshBody | MannequinBody) else ()
    return tuple(key for key in type(form).model_fields if key not in fixed)


class Body(Strict):
    """``[bodies.NAME]``: what nothing that deforms enters; ``friction`` is Coulomb's.

    All numbers may be formulas of the parameters.

    Args:
        sphere, plane, box, capsule, cylinder, mesh, mannequin: its form; one of them.
        friction: Coulomb's coefficient.
    """

    kinds: ClassVar[tuple[str, ...]] = ("sphere", "plane", "box", "capsule", "cylinder", "mesh", "mannequin")

    sphere: Sphere | None = None
    plane: Plane | None = None
    box: Box | None = None
    capsule: Capsule | None = None
    cylinder: Cylinder | None = None
    mesh: MeshBody | None = None
    mannequin: MannequinBody | None = None
    friction: Ratio = 0.0
    # Frames of drags ask for it a hundred times.
    _kind: str = PrivateAttr("")

    @property
    def kind(self) -> str:
        """Which of these kinds this body is."""
        return self._kind

    @property
    def form(self) -> Forms:
        """The keys of its kind."""
        return getattr(self, self.kind)

    @property
    def form_on_grid(self) -> bool:
        """Whether its distance is interpolated on a grid."""
        return isinstance(self.form, MeshBody | MannequinBody)

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        self._kind = only_one(self, self.kinds)
        return self

    def evaluated(self, parameters: dict[str, float]) -> Self:
        """The body with numbers in place of formulas.

        Raises:
            UnitError: a size is not positive, a normal has no direction, a formula gives no number.
        """
        form = evaluated(self.form, parameters)
        _refuse_flat(self.kind, form)
        form = form.completed() if isinstance(form, MannequinBody) else form
        friction = number(self.friction, parameters)
        if friction < 0.0:
            raise UnitError(f"the coefficient of friction is {friction:g}", "write at least 0")
        return self.model_copy(update={self.kind: form, "friction": friction})


class Start(Strict):
    """``[start]``: where the flat sheet is at first: turned about x, then y, then z through ``about``, then moved.

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


def bodies_of(scene: Scene) -> Mapping[str, Body]:
    """The bodies of a scene by name; none where no physics of it has registered a table of them."""
    key = scene.tables.get(Body)
    return getattr(scene, key) if key else {}


def start_of(scene: Scene) -> Start | None:
    """Where the sheet of a scene is at first; None where no physics of it has registered such a table."""
    key = scene.tables.get(Start)
    return (getattr(scene, key) or Start()) if key else None


def pins_of(scene: Scene) -> Mapping[str, Support]:
    """The supports of a scene that a hand may take hold of, by name: those in space, of scenes that have a start."""
    return scene.supports if start_of(scene) is not None else {}


def _refuse_flat(kind: str, form: Forms) -> None:
    """Refuses a body of numbers without a size or a direction."""
    if isinstance(form, Plane):
        if not any(form.normal):
            raise UnitError("the normal of a plane has no direction", "write one that is not 0 0 0")
        return
    if isinstance(form, MeshBody | MannequinBody):
        if number(form.scale, {}) <= 0.0:
            raise UnitError(f"the body is made {number(form.scale, {}):g} times as large", "write a scale above 0")
        return
    sizes = [number(size, {}) for size in (form.half if isinstance(form, Box) else (form.radius,))]
    if min(sizes) <= 0.0:
        raise UnitError(f"a size of the {kind} is {min(sizes):g} m", "write one greater than 0")
    if isinstance(form, Cylinder):
        length = dist(*([number(value, {}) for value in end] for end in (form.start, form.end)))
        if length == 0.0:
            raise UnitError("the ends of the cylinder are one place", "let start and end differ")
        _refuse_sharp(kind, number(form.rounded, {}), min(sizes[0], 0.5 * length), "of radius and half length")
    elif isinstance(form, Box):
        _refuse_sharp(kind, number(form.radius, {}), min(sizes), "half size")


def _refuse_sharp(kind: str, radius: float, most: float, of: str) -> None:
    """Refuses a radius [m] of edges that a body has no room for."""
    if not 0.0 <= radius <= most:
        do = f"write at least 0 and at most the smallest {of}, {most:g} m"
        raise UnitError(f"the radius of the {kind}'s edges is {radius:g} m", do)


def body_words(body: Body) -> str:
    """Kind, keys and friction of a body, for people."""
    form = body.form
    given = [key for key in type(form).model_fields if getattr(form, key) is not None]
    keys = [f"{key} {_in_words(form, key)}" for key in given]
    return f"{body.kind}, {', '.join(keys)}, friction {listing(body.friction)}"


def _in_words(form: Strict, key: str) -> str:
    """A key of a body with its unit."""
    return with_symbol(getattr(form, key), dimension_of(annotation_of(type(form).model_fields[key])))


def start_words(start: Start) -> str:
    """Where the sheet starts, for people."""
    moved = f"turned by {listing(start.turn)} rad about {listing(start.about)} m, moved by {listing(start.move)} m"
    return moved + (f", scattered by {start.scatter:g} m with the seed {start.seed}" if start.scatter else "")
