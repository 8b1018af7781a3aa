"""Dimensions of formulas: what parameters that have units make of them, as far as they can be derived."""

from __future__ import annotations

import ast
from collections.abc import Iterator, Mapping
from functools import lru_cache

from pydantic import BaseModel

from restshape.scene.expressions import Expression, parsed
from restshape.scene.source import Source
from restshape.scene.temperature_scales import check_temperatures
from restshape.scene.units import (
    BASE,
    DIMENSIONS,
    EXAMPLES,
    NONE,
    NUMBER_UNIT,
    UNITS,
    ZEROS,
    Powers,
    UnitError,
    article,
    spelled,
    unit,
)

Known = Powers | None
"""Powers of a value; None where nothing gives them, and any will do."""


def check_units(scene: BaseModel, written: Mapping[str, object], source: Source) -> None:
    """Refuses formulas that give another dimension than is wanted of them, by the units of the parameters in them.

    A parameter without a unit, x, y and a decimal number may stand for anything; whole numbers and pi have no
    dimension where they multiply or divide. Radians do not count.

    Args:
        scene: whose formulas are looked at.
        written: the parameters as they stand in the file.
        source: for messages.

    Raises:
        UserError: the first formula that adds what cannot be added, or gives what is not wanted.
    """
    named = {name: powers for name, value in written.items() if (powers := _powers(value)) is not None}
    if not named:
        return
    on_scale = {name for name, value in written.items() if isinstance(value, str) and _scale(value)}
    for key, formula in formulas(scene):
        if not formula.names.intersection(named):
            continue
        example = EXAMPLES.get(formula.wanted or "", '"12 mm"')
        try:
            check_temperatures(_tree(formula.text), on_scale)
        except UnitError as error:
            raise source.error(key, f"{formula.text!r} {error.what}", error.do) from error
        try:
            found = _of(_tree(formula.text), named)
        except UnitError as error:
            raise source.error(key, f"{formula.text!r} {error.what}", "give the parameters units that fit") from error
        if found is None or formula.wanted is None:
            continue
        if found != _plain(DIMENSIONS[formula.wanted]):
            units = ", ".join(f"{name} = {written[name]!r}" for name in sorted(formula.names.intersection(named)))
            what = f"{formula.text!r} is {article(spelled(found))} ({units}), but {article(formula.wanted)} is wanted"
            raise source.error(key, what, f"give the parameter another unit, as in {example}")


def _powers(value: object) -> Known:
    """The powers of a parameter that is written with a unit."""
    match = NUMBER_UNIT.match(value) if isinstance(value, str) else None
    if not (match and match[2]):
        return None
    return _plain((UNITS["K"] if match[2].strip() in ZEROS else unit(match[2]))[1])


def _scale(text: str) -> bool:
    """Whether a number is written on a scale of temperatures."""
    match = NUMBER_UNIT.match(text)
    return bool(match and match[2] and match[2].strip() in ZEROS)


def _plain(powers: Powers) -> Powers:
    """Powers without that of radians: arcs are lengths."""
    return tuple(0 if base == "rad" else power for base, power in zip(BASE, powers))


def formulas(value: object, key: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Expression]]:
    """All formulas of a model, each with its key."""
    if isinstance(value, Expression):
        yield key, value
    elif isinstance(value, BaseModel):
        for name, field in type(value).model_fields.items():
            yield from formulas(getattr(value, name), (*key, field.alias or name))
        for name, extra in (value.model_extra or {}).items():
            yield from formulas(extra, (*key, name))
    elif isinstance(value, Mapping):
        for name, one in value.items():
            yield from formulas(one, (*key, str(name)))
    elif isinstance(value, list | tuple):
        for one in value:
            yield from formulas(one, key)


@lru_cache(maxsize=4096)
def _tree(text: str) -> ast.expr:
    return parsed(text)


def _of(node: ast.expr, named: Mapping[str, Powers]) -> Known:
    """The powers of a part of a formula."""
    match node:
        case ast.Name(id="pi"):
            return NONE
        case ast.Name(id=name):
            return named.get(name)
        case ast.Constant(value=int()):
            return NONE
        case ast.UnaryOp(operand=operand):
            return _of(operand, named)
        case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right):
            return _same(_of_term(left, named), _of_term(right, named))
        case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
            one, other, sign = _of(left, named), _of(right, named), -1 if isinstance(op, ast.Div) else 1
            return None if one is None or other is None else _sum(one, other, sign)
        case ast.BinOp(left=left, op=ast.Pow(), right=ast.Constant(value=int() as power)):
            powers = _of(left, named)
            return None if powers is None else tuple(power * p for p in powers)
        case ast.Call(func=ast.Name(id="abs" | "min" | "max"), args=arguments):
            found: Known = None
            for argument in arguments:
                found = _same(found, _of_term(argument, named))
            return found
    return None


def _of_term(node: ast.expr, named: Mapping[str, Powers]) -> Known:
    """The powers of what is added: a number alone is of the kind of the others."""
    while isinstance(node, ast.UnaryOp):
        node = node.operand
    return None if isinstance(node, ast.Constant) else _of(node, named)


def _sum(one: Powers, other: Powers, sign: int) -> Powers:
    return tuple(p + sign * q for p, q in zip(one, other))


def _same(one: Known, other: Known) -> Known:
    """What two terms are that are added or compared.

    Raises:
        UnitError: they are not of one kind.
    """
    if one is not None and other is not None and one != other:
        raise UnitError(f"adds {article(spelled(one))} and {article(spelled(other))}")
    return one if other is None else other
