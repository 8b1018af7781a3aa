"""What a scene asks for: one number a frame, by name."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import isfinite
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal, Self, cast

from pydantic import Field, ValidationInfo, WithJsonSchema, field_validator, model_validator

from restshape.declared_paths import declared
from restshape.outputs.si_numbers import si
from restshape.scene.annotations import Definition, extended, optional
from restshape.scene.expressions import Expression, Value
from restshape.scene.key_aliases import OLD_NAMES, by_todays_names
from restshape.scene.units import SYMBOLS, UnitError, article, reads_as_quantity
from restshape.scene.values import Strict, only_one, read_number

ANY = ("max", "min", "mean", "sum", "absmax", "peak")
"""How values may become one."""

TOTAL = ("sum", "peak")
"""How what is one number already may."""


@dataclass(frozen=True)
class QuantityKind:
    """A kind of quantities: a key of ``[quantities.NAME]``.

    Args:
        value: annotation of what the key may hold; `Literal[True]` where there is nothing to choose.
        dimension: of its values, one of `units.DIMENSIONS`.
        reduce: how values become one where the scene does not say.
        whole: it belongs to the whole body, not to a place.
        summary: what it is, for people.
        reductions: how values may become one; empty: in any way, but for totals by sum, which have no parts to choose.
        renamed: its key in version 0.1; empty: the same.
        on: kinds of entities of which one must be named; empty: any may be, or none.
        beside: path ``module:attribute`` of the function of a value and the row of its frame, by column, that gives
            what tables say beside it, such as the note of a frequency; empty: they say nothing.
        takes: other kinds whose key may stand beside it and says of what it is, such as the `mode` of `cents`.
    """

    value: object
    dimension: str
    reduce: str
    whole: bool = False
    summary: str = ""
    reductions: tuple[str, ...] = ()
    renamed: str = ""
    on: tuple[str, ...] = ()
    beside: str = ""
    takes: tuple[str, ...] = ()

    def said(self, value: float | None, row: Mapping[str, object]) -> str:
        """What tables say beside a value of a frame with this row; empty where there is none."""
        if not self.beside or value is None or not isfinite(value):
            return ""
        return str(cast("Callable[..., object]", declared(self.beside, "a kind of quantities"))(value, row))

    @property
    def unit(self) -> str:
        """The SI unit of its values; empty for pure numbers."""
        return SYMBOLS[self.dimension]

    @property
    def reduced_by(self) -> tuple[str, ...]:
        """How values may become one; a total is one number already, of which a frame's time steps may have a peak."""
        return self.reductions or (TOTAL if self.reduce == "sum" else ANY)

    @property
    def meaning(self) -> tuple[str, str, bool]:
        """What it is in all physics that have it: they may differ in what may be chosen."""
        return self.dimension, self.reduce, self.whole


def of_the_end(kinds: Mapping[str, QuantityKind]) -> dict[str, QuantityKind]:
    """Kinds of quantities of which the end of a frame is looked at alone: there is no peak of its time steps."""
    return {
        key: replace(kind, reductions=tuple(how for how in kind.reduced_by if how != "peak"))
        for key, kind in kinds.items()
    }


LIMIT_SCHEMA = {"anyOf": [{"type": "number"}, {"type": "string"}], "description": "in SI units, or such as 180 MPa"}
EXACT_SCHEMA = LIMIT_SCHEMA | {"description": "in SI units, such as 180 MPa, or a formula of the parameters"}


ALL_ERRORS = "error"
"""The key of ``[quantities]`` that asks for the errors of all of them."""


def with_errors(raw: object) -> object:
    """The plain table of quantities in which each says what the key for all of them does.

    Areas have no error, and a quantity that says itself whether its error is wanted keeps that.
    """
    if not isinstance(raw, dict) or not isinstance(raw.get(ALL_ERRORS), bool):
        return raw
    named = {name: one for name, one in raw.items() if name != ALL_ERRORS}
    wanted = {"error": raw[ALL_ERRORS]}
    return {
        name: wanted | one if isinstance(one, dict) and not CORE.keys() & one.keys() else one
        for name, one in named.items()
    }


def in_unit(unit: str, value: float, digits: int = 6) -> str:
    """The value of a quantity with its unit and SI prefix, as reports have it."""
    return si(value, unit, digits) if isfinite(value) else f"{value:g} {unit}".rstrip()


ROUNDED = 1e-6
"""Relative change by which a limit may be rounded."""


def limit_digits(bound: float) -> int:
    """How many digits give a limit as it was written: four turn 363.15 K, which is 90 degC, into 363.1 K."""
    return next((n for n in (4, 5, 6) if abs(float(f"{bound:.{n}g}") - bound) <= ROUNDED * abs(bound)), 8)


def limit_in_unit(unit: str, bound: float) -> str:
    """A limit with its SI unit, in as many digits as give it."""
    return in_unit(unit, bound, limit_digits(bound))


CORE = {
    "area": QuantityKind(
        Literal[True],
        "area",
        "sum",
        reductions=("sum",),
        summary="the area of the shape, or of a part of it, exact",
    )
}
"""The kinds that quantities of all scenes may have."""


class Quantity(Strict):
    """``[quantities.NAME]``: one number a frame; ``reduce`` says how many values become one.

    With ``max`` the quantity is a constraint: it holds as long as its value is not above; with ``min``, as long as it
    is not below. ``reference`` is its value on the first shape by a closed form, a number or a formula of the
    parameters, which studies of accuracy count errors from.
    "absmax" is the largest size at the frame's end, "peak" that over all time steps of the frame.
    ``error`` asks for an estimate of its error in each frame; with a limit there is one where it can be had.

    Args:
        at: the entity where it is taken; left out, all.
        reduce: how the values there become one.
        max: the limit that it must not be above.
        min: the limit that it must not be below.
        reference: its value on the first shape by a closed form.
        error: whether its error is estimated; left out, where it has a limit.
    """

    kinds: ClassVar[Mapping[str, QuantityKind]] = {}
    renamed: ClassVar[Mapping[str, str]] = {"max": "limit", "min": "at_least", "reduce": "take", "reference": "exact"}

    at: str | None = None
    reduce: Literal["max", "min", "mean", "sum", "absmax", "peak"] | None = None
    max: Annotated[float, WithJsonSchema(LIMIT_SCHEMA)] | None = None
    min: Annotated[float, WithJsonSchema(LIMIT_SCHEMA)] | None = None
    reference: Annotated[float | Expression, WithJsonSchema(EXACT_SCHEMA)] | None = None
    error: bool | None = None

    if TYPE_CHECKING:

        def __getattr__(self, key: str) -> object:
            """Of a kind that a physics has declared: its value, or None."""

    @field_validator("max", "min", mode="before")
    @classmethod
    def _read_limit(cls, raw: float | str, info: ValidationInfo) -> float:
        """The largest or smallest value of a quantity that holds, in the unit of its kind."""
        kind = next((kind for kind in cls.kinds if info.data.get(kind) is not None), None)
        return read_number(raw, cls.kinds[kind].dimension if kind else None, info)

    @field_validator("reference", mode="before")
    @classmethod
    def _read_reference(cls, raw: Expression | float | str, info: ValidationInfo) -> Value:
        """The value of a quantity by a closed form, a formula or a number in the unit of its kind."""
        if isinstance(raw, Expression) or (isinstance(raw, str) and not reads_as_quantity(raw)):
            return raw if isinstance(raw, Expression) else Expression(raw)
        return cls._read_limit(raw, info)

    @property
    def kind(self) -> str:
        """Which of the kinds this quantity is: not one that another takes beside it.

        Raises:
            UnitError: it is none of them, or more than one.
        """
        present = [key for key in self.kinds if getattr(self, key) is not None]
        taken = {other for key in present for other in self.kinds[key].takes}
        return only_one(self, [key for key in self.kinds if key not in taken])

    @property
    def dimension(self) -> str:
        """The dimension of its value."""
        return self.kinds[self.kind].dimension

    @property
    def unit(self) -> str:
        """The SI unit of its value; empty for pure numbers."""
        return self.kinds[self.kind].unit

    def number(self, kind: str) -> int | None:
        """The number that a kind which counts has, such as ``mode = 3``; None where it is of another kind."""
        found = getattr(self, kind, None)
        return found if isinstance(found, int) and not isinstance(found, bool) else None

    @property
    def wants_error(self) -> bool:
        """Whether its error is to be estimated: where the scene asks for it, or gives a limit."""
        limited = self.max is not None or self.min is not None
        return self.kind not in CORE and (limited if self.error is None else self.error)

    @model_validator(mode="before")
    @classmethod
    def _reduce_as_usual(cls, raw: object) -> object:
        raw = by_todays_names(raw, cls.renamed)
        if isinstance(raw, dict) and "reduce" not in raw:
            kind = next((kind for kind in cls.kinds if kind in raw), None)
            return raw | {"reduce": cls.kinds[kind].reduce} if kind else raw
        return raw

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        kind = self.kind
        if self.error and kind in CORE:
            raise UnitError(f"{article(kind)} has no error estimate", "leave error = true out")
        if self.max is not None and self.min is not None and self.min > self.max:
            least, most = (limit_in_unit(self.unit, one) for one in (self.min, self.max))
            raise UnitError(f"no value can be at least {least} and at most {most}", "exchange min and max, or mend one")
        reductions = self.kinds[kind].reduced_by
        if self.reduce not in reductions:
            raise UnitError(
                f"{article(kind)} is reduced by {' or '.join(map(json.dumps, reductions))}, not by {self.reduce!r}",
                f"leave reduce out, which is {json.dumps(self.kinds[kind].reduce)}",
            )
        return self


def quantity_type(kinds: Mapping[str, QuantityKind]) -> type[Quantity]:
    """The model of quantities that may be of these kinds, and of those that all scenes have."""
    kinds = {**kinds, **CORE}
    # Fields of the last base come first: a limit is read by the kind that has been read before it.
    fields: dict[str, Definition] = {
        key: (optional(kind.value), Field(None, description=kind.summary or None)) for key, kind in kinds.items()
    }
    made = extended(Quantity, {}, extended(Strict, fields, name="Keys"))
    made.kinds = kinds
    made.renamed = {**Quantity.renamed, **{key: kind.renamed for key, kind in kinds.items() if kind.renamed}}
    OLD_NAMES.update(made.renamed)
    return made
