"""Types of single values in scenes and scripts: numbers with units, formulas, points and names."""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from types import UnionType
from typing import Annotated, ClassVar, Union, get_args, get_origin

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    ValidationInfo,
    WithJsonSchema,
    model_validator,
)
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, core_schema

from restshape.bounds import NAME_CHARACTERS
from restshape.scene.annotations import annotated
from restshape.scene.expressions import COORDINATES, PLACES_AND_TIME, Expression, NoFormula, Value
from restshape.scene.key_aliases import OLD_NAMES, by_todays_names
from restshape.scene.key_descriptions import Described
from restshape.scene.units import EXAMPLES, UnitError, quantity, reads_as_quantity

NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_-]*")
PART = re.compile(rf"{NAME.pattern}(?:\.[A-Za-z0-9_-]+)*")
"""Names in a shape, which loops, edits and mesh files make of others: ``window.1``."""
RESERVED = {"all": "everything", "outline": "all edges of the outline"}
"""Names that scenes and scripts give to parts of each shape, and what they stand for."""


class Strict(Described):
    """A model that refuses unknown keys and cannot be changed.

    Attributes:
        renamed: what version 0.1 called keys, by their names today; both are read.
    """

    model_config = ConfigDict(
        defer_build=True, extra="forbid", frozen=True, arbitrary_types_allowed=True, allow_inf_nan=False
    )
    renamed: ClassVar[Mapping[str, str]] = {}

    @classmethod
    def __pydantic_init_subclass__(cls, **_: object) -> None:
        OLD_NAMES.update(cls.renamed)

    @model_validator(mode="before")
    @classmethod
    def _read_old_names(cls, raw: object) -> object:
        return by_todays_names(raw, cls.renamed)


UNIT_SCHEMA = {
    "anyOf": [{"type": "number", "exclusiveMinimum": 0}, {"type": "string"}],
    "description": "metres, or a unit such as mm",
}
"""Of metres in one unit of a file's numbers, as `read_unit` takes them."""


def read_unit(raw: float | str) -> float:
    """Metres in one unit of a file's numbers, given as a number or as the name of a unit.

    Raises:
        UnitError: it is no such length, or not positive.
    """
    found = quantity(f"1 {raw}" if isinstance(raw, str) and raw.strip().isalpha() else raw, "length")
    if found <= 0.0:
        raise UnitError(f"a unit of {found:g} m is none", 'write unit = "mm", or what it is')
    return found


def only_one(model: Strict, keys: Collection[str]) -> str:
    """The one of these keys that the model holds.

    Raises:
        UnitError: none of them, or more than one.
    """
    present = [key for key in keys if getattr(model, key) is not None]
    if len(present) != 1:
        found = " and ".join(present) if present else "none of them"
        do = f"keep one of them: {' or '.join(present)}" if present else "add one of them"
        if len(keys) == 1:
            raise UnitError(f"{', '.join(keys)} is wanted here, too", "add it")
        raise UnitError(f"exactly one of {', '.join(keys)} is wanted here, but there is {found}", do)
    return present[0]


@dataclass(frozen=True)
class Measured:
    """What the annotation of a value says of it.

    Args:
        dimension: one of `units.DIMENSIONS`; None: any.
    """

    dimension: str | None


def read_number(raw: object, dimension: str | None, info: ValidationInfo) -> float:
    """The number in SI units that a user has written: as one, or as a formula of the scene's parameters.

    Args:
        raw: as it is written.
        dimension: as of `units.quantity`.
        info: of the validation, whose context holds the `Parameters` of a scene; elsewhere formulas are refused.

    Raises:
        ValueProblem: it is no such number.
    """
    parameters = (info.context or {}).get("parameters")
    if parameters is None or not isinstance(raw, str) or reads_as_quantity(raw):
        return quantity(raw, dimension)
    try:
        formula = Expression(raw, dimension)
    except NoFormula:
        return quantity(raw, dimension)
    found: float = parameters.number(formula)
    return found


@dataclass(frozen=True)
class InSI(Measured):
    """The annotation of a number with a unit of a dimension, in SI after validation; or of a formula that gives one.

    Numbers in formulas may have units of their own, as in ``3 mm*n``. In scenes a formula of the parameters has its
    value after validation.

    Args:
        formula: it may also name x and y, and stays a formula.
        settled: of these only formulas of x or y stay; those of the parameters alone have their value, as elsewhere.
        timed: formulas may name the time t besides.
    """

    formula: bool = False
    settled: bool = False
    timed: bool = False

    def read(self, raw: Value | str, info: ValidationInfo) -> Value:
        """The value of what a user has written."""
        if self.formula and isinstance(raw, Expression):
            return raw
        if self.formula and isinstance(raw, str) and not reads_as_quantity(raw):
            formula = Expression(raw, self.dimension, PLACES_AND_TIME if self.timed else COORDINATES)
            parameters = (info.context or {}).get("parameters")
            if not self.settled or parameters is None or formula.names_places:
                return formula
        return read_number(raw, self.dimension, info)

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> CoreSchema:
        written = core_schema.plain_serializer_function_ser_schema(written_value) if self.formula else None
        return core_schema.with_info_before_validator_function(self.read, handler(source), serialization=written)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, object]:
        example = EXAMPLES[self.dimension].strip('"') if self.dimension else "12 mm"
        text = f"a number in SI units or text such as {example}"
        if self.formula:
            text += f", or a formula of x, y{', t' * self.timed} and the parameters"
        return {"anyOf": [{"type": "number"}, {"type": "string"}], "description": text}


def _read_whole(raw: object, info: ValidationInfo) -> object:
    """A whole number that a formula of the parameters gives; all else as it is."""
    if not isinstance(raw, str) or reads_as_quantity(raw):
        return raw
    found = read_number(raw, "number", info)
    if found != round(found):
        raise UnitError(f"{raw!r} is {found:.6g}, but a whole number is wanted")
    return round(found)


def written_value(value: Value) -> float | str:
    """A number or the text of a formula, as a scene would hold them."""
    return value.text if isinstance(value, Expression) else value


def dimension_of(annotation: object) -> object:
    """The dimension of what an annotation may hold; the annotation without its options where it is no number."""
    if get_origin(annotation) is Annotated:
        inner, *said = get_args(annotation)
        measured = next((one for one in said if isinstance(one, Measured)), None)
        return measured.dimension if measured else dimension_of(inner)
    options = [one for one in get_args(annotation) if one is not type(None)]
    if get_origin(annotation) in (Union, UnionType) and len(options) == 1:
        return dimension_of(options[0])
    if get_origin(annotation) in (tuple, list) and options:
        return dimension_of(options[0])
    return annotation


def annotation_of(field: FieldInfo) -> object:
    """The annotation of a key of a model, with all that it says besides its type."""
    return annotated(field.annotation, *field.metadata)


def number_of(dimension: str | None) -> object:
    """The type of a number with a unit of that dimension, in SI after validation."""
    return Annotated[float, InSI(dimension)]


def value_of(dimension: str, settled: bool = False, timed: bool = False) -> object:
    """The type of a number with a unit of that dimension, or of a formula that gives one in SI units.

    Args:
        dimension: one of `units.DIMENSIONS`.
        settled, timed: as of `InSI`.
    """
    return Annotated[float | Expression, InSI(dimension, formula=True, settled=settled, timed=timed)]


def _read_part(raw: object) -> str:
    """The name of an entity of a shape: one name, and what dots add to it."""
    if isinstance(raw, str) and "." in raw and len(raw) <= NAME_CHARACTERS and PART.fullmatch(raw):
        return raw
    return _read_name(raw)


def _read_name(raw: object) -> str:
    """The name, if it may name something."""
    if not isinstance(raw, str):
        raise UnitError(f"a name is wanted here, not {raw!r}")
    if raw in RESERVED:
        raise UnitError(f"{raw!r} is a keyword: it stands for {RESERVED[raw]}", "choose another name")
    if len(raw) > NAME_CHARACTERS:
        raise UnitError(f"a name has more than {NAME_CHARACTERS} characters", "choose a shorter one")
    if not NAME.fullmatch(raw):
        raise UnitError(f"{raw!r} cannot be a name", "use letters, digits, - and _, and start with a letter")
    return raw


def _read_entities(raw: object) -> list[str]:
    """One name or several, as a list."""
    names = [raw] if isinstance(raw, str) else raw
    if not isinstance(names, list) or not names or not all(isinstance(name, str) and name for name in names):
        raise UnitError(f"the name of an entity, or a list of names, is wanted here, not {raw!r}")
    return names


Number = Annotated[float, InSI("number")]
Whole = Annotated[
    int,
    BeforeValidator(_read_whole),
    WithJsonSchema({"anyOf": [{"type": "integer"}, {"type": "string"}]}),
]
"""A whole number, in a scene also by a formula of the parameters."""
Ordinal = Annotated[Whole, Field(ge=1)]
"""1, 2, ..."""
Length = Annotated[float, InSI("length")]
Angle = Annotated[float, InSI("angle")]
Time = Annotated[float, InSI("time")]
Pressure = Annotated[float, InSI("pressure")]
AnyNumber = Annotated[float, InSI(None)]
"""Of whatever dimension."""
Point = tuple[Length, Length]
Name = Annotated[str, BeforeValidator(_read_name)]
PartName = Annotated[str, BeforeValidator(_read_part)]
"""Of an entity of a shape, also of one that a loop, an edit or a mesh file has named: ``window.1``."""
Entities = Annotated[
    list[str],
    BeforeValidator(_read_entities),
    WithJsonSchema({"anyOf": [{"type": "string"}, {"type": "array", "items": {"type": "string"}}]}),
]
