"""Numbers of a scene that formulas of its parameters give: where they stand, and what setting one of them means."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from types import UnionType
from typing import Annotated, NamedTuple, Union, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from restshape.errors import UserError, ValueProblem
from restshape.scene.expressions import Expression
from restshape.scene.key_aliases import OLD_NAMES
from restshape.scene.model import Scene
from restshape.scene.source import split_key
from restshape.scene.units import SYMBOLS, reads_as_quantity
from restshape.scene.values import Measured, annotation_of, dimension_of

Key = tuple[str, ...]


class GivenNumber(NamedTuple):
    """A number that a formula of the parameters alone gives.

    Args:
        key: where it stands.
        formula: that gives it.
        value: in SI units.
        dimension: of it, as the key wants it; None where that is not known.
    """

    key: Key
    formula: Expression
    value: float
    dimension: str | None

    @property
    def symbol(self) -> str:
        """The SI unit of its value; empty where it has none, or that is not known."""
        return SYMBOLS[self.dimension] if self.dimension else ""


def given_numbers(scene: Scene) -> list[GivenNumber]:
    """All numbers of a scene that formulas of its parameters alone give, in the order of the file."""
    return list(_given(scene.raw, scene, (), type(scene), scene.parameters))


def given_number(scene: Scene, key: Key) -> GivenNumber | None:
    """The one that stands at a key; None where none does."""
    raw = value_below(scene.raw, key)
    found = _given(raw, value_below(scene, key), key, None, scene.parameters) if isinstance(raw, str) else ()
    return next(iter(found), None)


def value_at(scene: Scene, key: str) -> object:
    """What a scene holds at a dotted key, in SI units; None where it holds nothing there."""
    return value_below(scene, split_key(key))


def unit_at(model: BaseModel, key: Key) -> str:
    """The SI unit of the number that a scene, or a table of it, holds at a key; empty without one, or if not known."""
    dimension = dimension_of(_annotation_at(model, key))
    return SYMBOLS.get(dimension, "") if isinstance(dimension, str) else ""


def bounds_at(model: BaseModel, key: Key) -> tuple[float | None, float | None]:
    """The least and the largest number that a key of a scene, or of a table of it, takes; None where there is none."""
    low: float | None = None
    high: float | None = None
    for one in _said_of(_annotation_at(model, key)):
        for name in ("ge", "gt"):
            low = getattr(one, name, None) if low is None else low
        for name in ("le", "lt"):
            high = getattr(one, name, None) if high is None else high
    return low, high


def _annotation_at(model: BaseModel, key: Key) -> object:
    """The annotation of what a scene, or a table of it, holds at a key."""
    kind: object = type(model)
    here: object = model
    for part in key:
        kind, here = _inside(kind, here, part), _inner(here, part)
    return kind


def _said_of(kind: object) -> Iterator[object]:
    """What an annotation says of a number, but its type: of a union all that its members say."""
    if isinstance(kind, FieldInfo):
        yield from kind.metadata
    elif get_origin(kind) is Annotated:
        inner, *said = get_args(kind)
        yield from _said_of(inner)
        for one in said:
            yield from _said_of(one) if isinstance(one, FieldInfo) else (one,)
    elif get_origin(kind) in (Union, UnionType):
        for one in get_args(kind):
            yield from _said_of(one)


def value_below(here: object, key: Key) -> object:
    """What models, tables and lists hold at a key; None where they hold nothing there."""
    for part in key:
        here = _inner(here, part)
    return here


def edited_number(scene: Scene, key: str, value: object) -> str:
    """The key whose value changes when one that formulas may give is set to a number.

    It is that of the parameter where the formula is a parameter alone; a text that is a formula replaces it.

    Args:
        scene: where it is set.
        key: dotted.
        value: as it would stand in the file.

    Raises:
        UserError: a formula of several parameters, or of more than its name, gives the value.
    """
    at = split_key(key)
    while given := given_number(scene, at):
        if isinstance(value, str) and not reads_as_quantity(value):
            break
        alone = given.formula.text.strip()
        if alone not in scene.parameters:
            raise _formula_gives(given)
        at = ("parameters", alone)
    raw = value_below(scene.raw, at)
    for given in (
        _given(raw, value_below(scene, at), at, None, scene.parameters) if isinstance(raw, dict | list) else ()
    ):
        written = value_below(value, given.key[len(at) :])
        if not isinstance(written, str) or reads_as_quantity(written):
            raise _formula_gives(given)
    return ".".join(at) if at != split_key(key) else key


def _formula_gives(given: GivenNumber) -> UserError:
    """The error of a number that would replace a formula."""
    names = [f"parameters.{name}" for name in given.formula.parameters]
    what = f"{'.'.join(given.key)} is given by the formula {given.formula.text!r} of {' and '.join(names)}"
    return UserError(what, do=f"set {' or '.join(names)}, or write another formula")


def _given(
    raw: object, value: object, key: Key, kind: object, parameters: Mapping[str, float]
) -> Iterator[GivenNumber]:
    """The given numbers in plain tables, beside what their validation has made of them, and the annotation of that."""
    if isinstance(raw, str):
        formula = _formula(raw, value, parameters)
        if formula is not None:
            dimension = dimension_of(kind)
            known = dimension if isinstance(dimension, str) else None
            yield GivenNumber(key, formula, float(formula.evaluate(0.0, 0.0, parameters)), known)
    elif isinstance(raw, dict | list):
        entries = raw.items() if isinstance(raw, dict) else ((str(place), one) for place, one in enumerate(raw))
        for name, one in entries:
            yield from _given(one, _inner(value, name), (*key, name), _inside(kind, value, name), parameters)


def _inside(kind: object, value: object, part: str) -> object:
    """The annotation of what a model, a table or a list of an annotation holds under a key; None where not known."""
    if isinstance(value, BaseModel):
        field = type(value).model_fields.get(_field(value, part) or "")
        return annotation_of(field) if field else None
    while get_origin(kind) is Annotated:
        kind, *said = get_args(kind)
        if measured := [one for one in said if isinstance(one, Measured)]:
            return Annotated[float, measured[0]]
    if get_origin(kind) in (Union, UnionType):
        found = (_inside(one, value, part) for one in get_args(kind))
        return next((one for one in found if one is not None), None)
    return get_args(kind)[get_origin(kind) is dict] if get_origin(kind) in (dict, list, tuple) else None


def _formula(text: str, value: object, parameters: Mapping[str, float]) -> Expression | None:
    """The formula of parameters alone that a text is; None where it is another text, or depends on places."""
    number = isinstance(value, Expression | int | float) and not isinstance(value, bool)
    if not number or reads_as_quantity(text):
        return None
    try:
        formula = Expression(text)
    except ValueProblem:
        return None
    return formula if formula.parameters and not formula.unknown(parameters, ()) else None


def _inner(here: object, part: str) -> object:
    """What a model, a table or a list holds under a key; None where nothing."""
    if isinstance(here, Mapping):
        return here.get(part)
    if isinstance(here, list | tuple):
        return here[int(part)] if part.isdigit() and int(part) < len(here) else None
    if isinstance(here, BaseModel):
        name = _field(here, part)
        return (here.model_extra or {}).get(part) if name is None else getattr(here, name)
    return None


def _field(model: BaseModel, key: str) -> str | None:
    """The field of a model that has a key; None where none has."""
    today = {old: new for new, old in OLD_NAMES.items()}
    aliases = {field.alias: name for name, field in type(model).model_fields.items() if field.alias}
    found = (name for name in (aliases.get(key, key), today.get(key, key)) if name in type(model).model_fields)
    return next(found, None)
