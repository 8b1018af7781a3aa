"""What a scene asks for: one number a frame, by name."""

from __future__ import annotations

from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, model_validator

from restshape.scene.expressions import Expression, Value
from restshape.scene.units import UnitError, quantity, reads_as_quantity
from restshape.scene.values import Strict, only_one


def _read_exact(raw: Any, info: ValidationInfo) -> Value:
    """The value of a quantity by a closed form, a formula or a number in the unit of its kind."""
    if isinstance(raw, Expression) or (isinstance(raw, str) and not reads_as_quantity(raw)):
        return raw if isinstance(raw, Expression) else Expression(raw)
    return _read_limit(raw, info)


def _read_limit(raw: Any, info: ValidationInfo) -> float:
    """The largest or smallest value of a quantity that holds, in the unit of its kind."""
    kind = next((kind for kind in LIMIT_DIMENSIONS if info.data.get(kind) is not None), None)
    return quantity(raw, LIMIT_DIMENSIONS[kind] if kind else None)


LIMIT_SCHEMA = {"anyOf": [{"type": "number"}, {"type": "string"}], "description": "in SI units, or such as 180 MPa"}
EXACT_SCHEMA = LIMIT_SCHEMA | {"description": "in SI units, such as 180 MPa, or a formula of the parameters"}
LIMIT_DIMENSIONS = {
    "displacement": "length",
    "reaction": "force",
    "stress": "pressure",
    "energy": "moment",
    "area": "area",
    "distance": "length",
    "frequency": "frequency",
    "mode": "frequency",
    "load_factor": "number",
    "use": "number",
    "sag": "length",
    "margin": "number",
    "mass": "mass",
    "length": "length",
}


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


def with_unit(kind: str, value: float, digits: int = 6) -> str:
    """The value of a quantity of a kind with its unit, lengths below a metre in millimetres."""
    unit = LIMIT_UNITS.get(LIMIT_DIMENSIONS[kind], "")
    factor, unit = (1e3, "mm") if unit == "m" and 0.0 < abs(value) < 1.0 else (1.0, unit)
    return f"{factor * value:.{digits}g} {unit}".rstrip()


class Quantity(Strict):
    """``[quantities.NAME]``: one number a frame; ``take`` says how many values become one.

    ``distance = "NAME"`` is the distance between a goal and the deformed edges, counted from both: "mean" is half the
    mean along the edges of their distance from the goal plus half the mean along the goal of its distance from them.
    ``frequency = 2`` is the second lowest frequency, ``mode = 2`` that of the mode that was the second one at the
    start, wherever it has gone since.
    ``load_factor = 1`` is the lowest multiple of all loads at which the body buckles; infinite where there is none.
    Of furniture there are ``use`` (of the strength of joints), ``reaction`` (of feet), ``sag``, ``margin`` (of what
    holds the piece down), ``mass`` and ``length`` (along an axis of a plank's own).
    With a ``limit`` the quantity gives a verdict: it holds as long as its value is not above; with ``at_least``, as
    long as it is not below. ``exact`` is its value on the first shape by a closed form, a number or a formula of the
    parameters, which studies of accuracy count errors from.

    "absmax" is the largest size at the frame's end, "peak" that over all time steps of the frame.
    Energies: "strain", "kinetic" (relative to the ground), "total" of both, "edit" (work of all edits so far) and
    "remesh" (what carrying the motion to new meshes has added so far); all but the first are for what moves. Those of
    cloth: "membrane", "bending", "strain" (both) and "potential" (with weight and contact).
    """

    kinds: ClassVar[tuple[str, ...]] = (
        "displacement",
        "reaction",
        "stress",
        "energy",
        "area",
        "distance",
        "frequency",
        "mode",
        "load_factor",
        "use",
        "sag",
        "margin",
        "mass",
        "length",
    )
    usual: ClassVar[dict[str, str]] = {
        "displacement": "mean",
        "reaction": "sum",
        "stress": "max",
        "energy": "sum",
        "area": "sum",
        "distance": "mean",
        "frequency": "sum",
        "mode": "sum",
        "load_factor": "sum",
        "use": "max",
        "sag": "max",
        "margin": "min",
        "mass": "sum",
        "length": "sum",
    }

    displacement: Literal["x", "y", "z", "magnitude"] | None = None
    reaction: Literal["x", "y", "z"] | None = None
    stress: Literal["von_mises", "xx", "yy", "xy", "max_principal", "min_principal"] | None = None
    energy: Literal["strain", "kinetic", "total", "edit", "remesh", "membrane", "bending", "potential"] | None = None
    area: Literal[True] | None = None
    distance: str | None = None
    frequency: Annotated[int, Field(ge=1)] | None = None
    mode: Annotated[int, Field(ge=1)] | None = None
    load_factor: Annotated[int, Field(ge=1)] | None = None
    use: Literal["pull", "shear", "largest"] | None = None
    sag: Literal[True] | None = None
    margin: Literal[True] | None = None
    mass: Literal[True] | None = None
    length: Literal["x", "y", "z"] | None = None
    at: str | None = None
    take: Literal["max", "min", "mean", "sum", "absmax", "peak"] | None = None
    limit: Annotated[float, BeforeValidator(_read_limit), WithJsonSchema(LIMIT_SCHEMA)] | None = None
    at_least: Annotated[float, BeforeValidator(_read_limit), WithJsonSchema(LIMIT_SCHEMA)] | None = None
    exact: Annotated[float | Expression, BeforeValidator(_read_exact), WithJsonSchema(EXACT_SCHEMA)] | None = None

    @property
    def kind(self) -> str:
        """Which of displacement, reaction, stress, energy, area, distance and the rest this quantity is."""
        return only_one(self, self.kinds)

    @model_validator(mode="before")
    @classmethod
    def _take_the_usual(cls, raw: Any) -> Any:
        if isinstance(raw, dict) and "take" not in raw:
            kind = next((kind for kind in cls.kinds if kind in raw), None)
            return raw | {"take": cls.usual[kind]} if kind else raw
        return raw

    @model_validator(mode="after")
    def _is_one_kind(self) -> Self:
        only_one(self, self.kinds)
        if self.distance is not None and self.take not in ("mean", "max"):
            raise UnitError(f'a distance is taken as "mean" or "max", not as {self.take!r}')
        return self
