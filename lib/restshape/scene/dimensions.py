"""Dimensions of formulas: what parameters and numbers that have units make of them, as far as they can be derived."""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping
from functools import lru_cache

from restshape.scene.expressions import parsed
from restshape.scene.temperature_scales import check_temperatures
from restshape.scene.units import (
    BASE,
    DIMENSIONS,
    MARKED,
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


def powers_of_formula(text: str, named: Mapping[str, Powers], on_scale: Collection[str] = ()) -> Known:
    """The powers of a formula without that of radians; None where nothing gives them.

    A parameter without a unit, x, y and a decimal number may stand for anything; whole numbers and pi have no
    dimension where they multiply or divide. Radians do not count.

    Args:
        text: the formula.
        named: powers of parameters that have a unit, as `powers_of_number` gives them.
        on_scale: parameters that are temperatures on a scale.

    Raises:
        UnitError: it adds what cannot be added; to be said behind the formula.
    """
    check_temperatures(_tree(text), on_scale)
    return _of(_tree(text, marked=True), named)


def plain_powers(dimension: str) -> Powers:
    """The powers of a dimension without that of radians."""
    return _plain(DIMENSIONS[dimension])


def powers_of_number(value: object) -> Known:
    """The powers of a number that is written with a unit; None without one."""
    match = NUMBER_UNIT.match(value) if isinstance(value, str) else None
    if not (match and match[2]):
        return None
    return _plain((UNITS["K"] if match[2].strip() in ZEROS else unit(match[2]))[1])


def is_on_scale(value: object) -> bool:
    """Whether a number is written on a scale of temperatures."""
    match = NUMBER_UNIT.match(value) if isinstance(value, str) else None
    return bool(match and match[2] and match[2].strip() in ZEROS)


def _plain(powers: Powers) -> Powers:
    """Powers without that of radians: arcs are lengths."""
    return tuple(0 if base == "rad" else power for base, power in zip(BASE, powers))


@lru_cache(maxsize=4096)
def _tree(text: str, marked: bool = False) -> ast.expr:
    return parsed(text, marked)


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
        case ast.BinOp(op=ast.MatMult(), right=ast.Name(id=mark)):
            return _plain(MARKED.get(mark, DIMENSIONS["temperature"]))
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
