"""What a physics says of itself: the keys that scenes may hold for it, its effects, and which equations it makes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import GenericAlias
from typing import TYPE_CHECKING, Literal, cast

from pydantic import BaseModel, Field

from restshape.declared_paths import declared
from restshape.scene.annotations import Definition, optional
from restshape.scene.event_line import EventLine
from restshape.scene.load_kind import LoadKind
from restshape.scene.quantity import QuantityKind
from restshape.scene.values import Name

if TYPE_CHECKING:
    from argparse import Namespace
    from pathlib import Path

    import numpy.typing as npt

    from restshape.arrays import Integers, Reals
    from restshape.scene.effect import DerivedEffect, Effect
    from restshape.scene.model import Material, Scene, Support
    from restshape.scene.plain_values import Table
    from restshape.scene.solver import SolverPlan
    from restshape.scene.source import Source

Rows = list[tuple[str, str]]
"""What is printed for people: what it is, and what it says."""


def imported(path: str) -> Callable[..., object]:
    """The function that a path ``module:attribute`` names, imported now."""
    return cast("Callable[..., object]", declared(path, "a physics"))


@dataclass(frozen=True)
class Section:
    """A table at the top of a scene.

    Args:
        model: of its keys.
        summary: one line for people.
        named: it holds tables of such keys by name, as ``[loads.NAME]`` does.
        required: a scene must have it; without it it has the defaults of its keys, or no names.
        optional: a scene without it has None.
        words: what one of its tables says, for people; None: its keys and values.
        shared: several physics may declare it, each with keys of its own.
        curve: path ``module:attribute`` of the function that gives points (m, 2) [m] of the curve that one of its
            tables stands for, which pictures show; empty: there is none.
    """

    model: type[BaseModel]
    summary: str
    named: bool = False
    required: bool = False
    optional: bool = False
    words: Callable[..., str] | None = None
    shared: bool = False
    curve: str = ""

    @property
    def field(self) -> Definition:
        """Its annotation and its default, for pydantic."""
        kind: object = GenericAlias(dict, (Name, self.model)) if self.named else self.model
        if self.required:
            return kind, Field(description=self.summary)
        if self.optional:
            return optional(kind), Field(None, description=self.summary)
        return kind, Field(default_factory=dict if self.named else self.model, description=self.summary)

    def curve_of(self, table: BaseModel) -> Reals:
        """Points (m, 2) [m] of the curve that a table of this model stands for."""
        return cast("Reals", imported(self.curve)(table))


@dataclass(frozen=True)
class Invariant:
    """What of a scene cannot change during an edit.

    Args:
        of: the value that stays, of a scene and the names of the effects that are on.
        what: what is reported of an edit that changes it.
        do: what to do about it.
    """

    of: Callable[[Scene, frozenset[str]], object]
    what: str
    do: str


@dataclass(frozen=True)
class Inspection:
    """What a physics sees in a scene with an outline, though it stops nothing.

    Args:
        data: for programs.
        rows: the same for people.
        warnings: what makes answers bad, for people.
        singular: quantities without a limit under refinement, with the exponent lambda of stress r^(lambda - 1).
        singular_points: control points of the outline at which they have none, the worst first.
    """

    data: dict[str, object] = field(default_factory=dict)
    rows: Rows = field(default_factory=list)
    warnings: tuple[str, ...] = ()
    singular: dict[str, float] = field(default_factory=dict)
    singular_points: tuple[int, ...] = ()


@dataclass(frozen=True)
class PictureField:
    """A scalar field that pictures of the plane show by colours.

    Args:
        label: for people.
        unit: SI unit of its values.
        from_zero: colours begin at 0; else at the smallest value.
        signed: values of both signs are as usual, and 0 is in the middle of the colours.
        quantity: key and value of the quantities that are taken from it, such as ("stress", "xx").
    """

    label: str
    unit: str
    from_zero: bool = True
    signed: bool = False
    quantity: tuple[str, object] | None = None


@dataclass(frozen=True)
class OwnPictures:
    """How recordings are drawn that are not of a shape in the plane; each a path ``module:attribute`` of a function.

    Args:
        shows: whether a recording is one of these.
        draw: draws a recording, as the options of `restshape report` say, into a still picture, and into an animation
            if that has a path.
        true_scale: why what is drawn cannot be exaggerated; no path.
    """

    shows: str
    draw: str
    true_scale: str

    def of(self, recording: object) -> bool:
        """Whether it draws this recording."""
        return bool(imported(self.shows)(recording))

    def drawn(self, recording: object, options: Namespace, still: Path, moving: Path | None) -> None:
        """Draws this recording."""
        imported(self.draw)(recording, options, still, moving)


# More than 15 attributes: each is a part of the declaration, of which a physics gives those that it has.
@dataclass(frozen=True, eq=False)
class Physics:
    """One physics, as scenes know it.

    Args:
        name: for people.
        summary: one line for people.
        solver: which equations there are and how they are solved, of a scene, the names of the effects that are on, and
            the settings of each effect by name; it gives None where the physics makes none.
        material: model of the keys of ``[material.NAME]``; None: it wants none.
        materials: values that it knows of materials by their names, as a scene would hold them.
        boundary: the dimension of each component that ``fix`` of a support may prescribe.
        support: model of supports with keys of its own besides; None: it has none.
        loads: kinds by name.
        quantities: kinds by name.
        sections: tables by key.
        events: of edit scripts by name, beside those that every session has.
        effects: by name; an application takes all or some.
        derived: parts that follow from a scene without being named, by name.
        invariants: what cannot change during an edit.
        requested: what recordings hold besides where ``recording.fields`` names it: for people, by name.
        none_requested: why there is no such field, for people; where there is one, or nothing to say, empty.
        pictured: fields of recordings that pictures show, by name, the most important first.
        vectors: fields of vectors that pictures show by line segments where asked to, by name.
        value_drags: events of the hand by which values change where it holds no part of a shape, such as a body.
        true_scale: names of effects under which pictures show deformations as they are, not exaggerated.
        pictures: of recordings that are not of a shape in the plane; None: there are none.
        body_surface: path ``module:attribute`` of the function that gives the surface of a body, places (n, 3) [m] and
            triangles (m, 3), of a scene, the body's name, and two corners (3,) [m] of a box around the rest; empty:
            none of its scenes has bodies.
        orders: of elements; the default first.
        order_why: the reason for that default, for people.
        mesh_keys: of ``[mesh]``, besides those that all scenes may have: "layers" of elements over the thickness of
            bodies; "levels" of nested meshes, on the finest of which its fields, of first order, live.
        mesh_jumps: its answers can be compared on two meshes of one shape; not where one shape has several answers.
        overridden: path ``module:attribute`` of the function that gives the plain tables of a scene with overrides, of
            the scene without and of the one with them; None where they are those that it has.
        check: what models alone cannot check in a scene; raises a `UserError` made by `Source.error`.
        check_shape: path ``module:attribute`` of the function that checks a scene with its first outline.
        inspect_shape: path ``module:attribute`` of the function that gives the `Inspection` of a scene with its first
            outline.
        singular_shape: likewise of the one that gives the `singular` and `singular_points` of that alone, for outlines
            of an edit.
        doubt_shape: path ``module:attribute`` of the function that gives, as a list, what a user may have meant
            otherwise in a scene with its first outline.
        check_start: path ``module:attribute`` of the function that checks what only the mesh of the first frame shows,
            of a scene, its plan and its outline, and gives a list of warnings; `restshape check` alone calls it.
        columns: names and types of columns of a replay that only it has, for a scene.
        recorded: path ``module:attribute`` of the function that gives what recordings of a scene hold in their header
            besides.
        summed: of a scene, its plan and the area [m^2] of its shape, what `restshape check` says besides: for programs,
            and as rows for people.
        instead: what to write in place of tables by name that it does not have, such as "loads".
    """

    name: str
    summary: str
    solver: Callable[[Scene, frozenset[str], Mapping[str, object]], SolverPlan | None]
    material: type[Material] | None = None
    materials: Mapping[str, Mapping[str, object]] = field(default_factory=dict)
    boundary: Mapping[str, str] = field(default_factory=dict)
    support: type[Support] | None = None
    loads: Mapping[str, LoadKind] = field(default_factory=dict)
    quantities: Mapping[str, QuantityKind] = field(default_factory=dict)
    sections: Mapping[str, Section] = field(default_factory=dict)
    events: Mapping[str, type[EventLine]] = field(default_factory=dict)
    effects: Mapping[str, Effect] = field(default_factory=dict)
    derived: Mapping[str, DerivedEffect] = field(default_factory=dict)
    invariants: tuple[Invariant, ...] = ()
    requested: Mapping[str, str] = field(default_factory=dict)
    none_requested: str = ""
    pictured: Mapping[str, PictureField] = field(default_factory=dict)
    vectors: Mapping[str, PictureField] = field(default_factory=dict)
    value_drags: tuple[str, ...] = ()
    true_scale: tuple[str, ...] = ()
    pictures: OwnPictures | None = None
    body_surface: str = ""
    orders: tuple[int, ...] = (1,)
    order_why: str = ""
    mesh_keys: tuple[Literal["layers", "levels"], ...] = ()
    mesh_jumps: bool = True
    overridden: str = ""
    check: Callable[[Scene, Source], None] | None = None
    check_shape: str = ""
    inspect_shape: str = ""
    doubt_shape: str = ""
    check_start: str = ""
    singular_shape: str = ""
    columns: Callable[[Scene], dict[str, npt.DTypeLike]] | None = None
    recorded: str = ""
    summed: Callable[..., tuple[dict[str, object], Rows]] | None = None
    instead: Mapping[str, str] = field(default_factory=dict)

    def checked_shape(self, scene: Scene, outline: object) -> None:
        """Makes sure that a scene makes sense on its first outline.

        Raises:
            UserError: it does not.
        """
        if self.check_shape:
            imported(self.check_shape)(scene, outline)

    def inspected(self, scene: Scene, outline: object) -> Inspection:
        """What it sees in a scene with an outline; nothing where it does not look."""
        if not self.inspect_shape:
            return Inspection()
        return cast(Inspection, imported(self.inspect_shape)(scene, outline))

    def doubted(self, scene: Scene, outline: object) -> list[str]:
        """What a user may have meant otherwise in a scene with an outline."""
        return cast("list[str]", imported(self.doubt_shape)(scene, outline)) if self.doubt_shape else []

    def checked_start(self, scene: Scene, effects: object, outline: object) -> list[str]:
        """What there is to warn of where a scene with a plan of its effects and an outline starts.

        Raises:
            UserError: the first frame would be refused.
        """
        return cast("list[str]", imported(self.check_start)(scene, effects, outline)) if self.check_start else []

    def surface_of(self, scene: Scene, body: str, low: Reals, high: Reals) -> tuple[Reals, Integers] | None:
        """The surface of a body of a scene: see `body_surface`; None where it knows none."""
        if not self.body_surface:
            return None
        return cast("tuple[Reals, Integers]", imported(self.body_surface)(scene, body, low, high))

    def singular(self, scene: Scene, outline: object) -> tuple[dict[str, float], tuple[int, ...]]:
        """`singular` and `singular_points` of a scene with an outline; nothing where it does not look."""
        if not self.singular_shape:
            return {}, ()
        found = imported(self.singular_shape)(scene, outline)
        return cast("tuple[dict[str, float], tuple[int, ...]]", found)

    def recorded_header(self, scene: Scene) -> dict[str, object]:
        """What recordings of a scene hold in their header besides."""
        return cast("dict[str, object]", imported(self.recorded)(scene)) if self.recorded else {}

    def followed(self, written: Scene, scene: Scene) -> Table | None:
        """The plain tables of a scene with overrides where they differ from its own: see `overridden`."""
        return cast("Table | None", imported(self.overridden)(written, scene))
