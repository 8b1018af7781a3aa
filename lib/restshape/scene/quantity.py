"""What a scene asks for: one number a frame, by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, ValidationInfo, WithJsonSchema, create_model, field_validator, model_validator

from restshape.scene.expressions import Expression, Value
from restshape.scene.units import UnitError, quantity, reads_as_quantity
from restshape.scene.values import Strict, only_one


@dataclass(frozen=True)
class QuantityKind:
    """A kind of quantities: a key of ``[quantities.NAME]``.

    Args:
        value: annotation of what the key may hold; `Literal[True]` where there is nothing to choose.
        dimension: of its values, one of `units.DIMENSIONS`.
        take: how values become one where the scene does not say.
        whole: it belongs to the whole body, not to a place.
    """

    value: Any
    dimension: str
    take: str
    whole: bool = False


LIMIT_SCHEMA = {"anyOf": [{"type": "number"}, {"type": "string"}], "description": "in SI units, or such as 180 MPa"}
EXACT_SCHEMA = LIMIT_SCHEMA | {"description": "in SI units, such as 180 MPa, or a formula of the parameters"}

LIMIT_UNITS = {
    "length": "m",
    "force": "N",
    "pressure": "Pa",
    "moment": "J",
    "area": "m^2",
    "frequency": "Hz",
    "mass": "kg",
}
"""SI units of dimensions; what is not here has none."""


def with_unit(dimension: str, value: float, digits: int = 6) -> str:
    """The value of a quantity of a dimension with its unit, lengths below a metre in millimetres."""
    return in_unit(LIMIT_UNITS.get(dimension, ""), value, digits)


def in_unit(unit: str, value: float, digits: int = 6) -> str:
    """The value of a quantity with its SI unit, lengths below a metre in millimetres."""
    factor, unit = (1e3, "mm") if unit == "m" and 0.0 < abs(value) < 1.0 else (1.0, unit)
    return f"{factor * value:.{digits}g} {unit}".rstrip()


class CoreKeys(Strict):
    """The kinds that quantities have in every application."""

    displacement: Literal["x", "y", "z", "magnitude"] | None = None
    reaction: Literal["x", "y", "z"] | None = None
    stress: Literal["von_mises", "xx", "yy", "xy", "max_principal", "min_principal"] | None = None
    energy: Literal["strain", "kinetic", "total", "edit", "remesh", "membrane", "bending", "potential"] | None = None
    area: Literal[True] | None = None
    distance: str | None = None
    frequency: Annotated[int, Field(ge=1)] | None = None
    mode: Annotated[int, Field(ge=1)] | None = None
    load_factor: Annotated[int, Field(ge=1)] | None = None


def _core(key: str, dimension: str, take: str, whole: bool = False) -> tuple[str, QuantityKind]:
    return key, QuantityKind(CoreKeys.model_fields[key].annotation, dimension, take, whole)


CORE: dict[str, QuantityKind] = dict(
    (
        _core("displacement", "length", "mean"),
        _core("reaction", "force", "sum"),
        _core("stress", "pressure", "max"),
        _core("energy", "moment", "sum"),
        _core("area", "area", "sum"),
        _core("distance", "length", "mean"),
        _core("frequency", "frequency", "sum", True),
        _core("mode", "frequency", "sum", True),
        _core("load_factor", "number", "sum", True),
    )
)


class Options(Strict):
    """What a quantity of any kind may say."""

    kinds: ClassVar[Mapping[str, QuantityKind]] = {}

    at: str | None = None
    take: Literal["max", "min", "mean", "sum", "absmax", "peak"] | None = None
    limit: Annotated[float, WithJsonSchema(LIMIT_SCHEMA)] | None = None
    at_least: Annotated[float, WithJsonSchema(LIMIT_SCHEMA)] | None = None
    exact: Annotated[float | Expression, WithJsonSchema(EXACT_SCHEMA)] | None = None

    @field_validator("limit", "at_least", mode="before")
    @classmethod
    def _read_limit(cls, raw: Any, info: ValidationInfo) -> float:
        """The largest or smallest value of a quantity that holds, in the unit of its kind."""
        kind = next((kind for kind in cls.kinds if info.data.get(kind) is not None), None)
        return quantity(raw, cls.kinds[kind].dimension if kind else None)

    @field_validator("exact", mode="before")
    @classmethod
    def _read_exact(cls, raw: Any, info: ValidationInfo) -> Value:
        """The value of a quantity by a closed form, a formula or a number in the unit of its kind."""
        if isinstance(raw, Expression) or (isinstance(raw, str) and not reads_as_quantity(raw)):
            return raw if isinstance(raw, Expression) else Expression(raw)
        return cls._read_limit(raw, info)

    @property
    def kind(self) -> str:
        """Which of displacement, reaction, stress, energy, area, distance and the rest this quantity is."""
        return only_one(self, self.kinds)

    @property
    def dimension(self) -> str:
        """The dimension of its value."""
        return self.kinds[self.kind].dimension

    @model_validator(mode="before")
    @classmethod
    def _take_the_usual(cls, raw: Any) -> Any:
        if isinstance(raw, dict) and "take" not in raw:
            kind = next((kind for kind in cls.kinds if kind in raw), None)
            return raw | {"take": cls.kinds[kind].take} if kind else raw
        return raw

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        only_one(self, self.kinds)
        return self


class Quantity(Options, CoreKeys):
    """``[quantities.NAME]``: one number a frame; ``take`` says how many values become one.

    ``distance = "NAME"`` is the distance between a goal and the deformed edges, counted from both: "mean" is half the
    mean along the edges of their distance from the goal plus half the mean along the goal of its distance from them.
    ``frequency = 2`` is the second lowest frequency, ``mode = 2`` that of the mode that was the second one at the
    start, wherever it has gone since.
    ``load_factor = 1`` is the lowest multiple of all loads at which the body buckles; infinite where there is none.
    With a ``limit`` the quantity gives a verdict: it holds as long as its value is not above; with ``at_least``, as
    long as it is not below. ``exact`` is its value on the first shape by a closed form, a number or a formula of the
    parameters, which studies of accuracy count errors from.

    "absmax" is the largest size at the frame's end, "peak" that over all time steps of the frame.
    Energies: "strain", "kinetic" (relative to the ground), "total" of both, "edit" (work of all edits so far) and
    "remesh" (what carrying the motion to new meshes has added so far); all but the first are for what moves. Those of
    cloth: "membrane", "bending", "strain" (both) and "potential" (with weight and contact).
    """

    kinds: ClassVar[Mapping[str, QuantityKind]] = CORE

    @model_validator(mode="after")
    def _is_mean_or_max_of_a_distance(self) -> Self:
        if self.distance is not None and self.take not in ("mean", "max"):
            raise UnitError(f'a distance is taken as "mean" or "max", not as {self.take!r}')
        return self


def quantity_type(kinds: Mapping[str, QuantityKind]) -> type[Quantity]:
    """The model of quantities that may be of these kinds too."""
    # Fields of the last base come first: a limit is read by the kind that has been read before it.
    keys = create_model("Keys", __base__=Strict, **{key: (kind.value | None, None) for key, kind in kinds.items()})
    made = create_model("Quantity", __base__=(Quantity, keys), __doc__=Quantity.__doc__)
    made.kinds = {**CORE, **kinds}
    return made
