"""Dimensions of formulas: what parameters and numbers that have units make of them, as far as they can be derived."""

from __future__ import annotations

import ast
from collections.abc import Collection, Mapping
from functools import lru_cache
from typing import NamedTuple

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
PLACES = {"x": DIMENSIONS["length"], "y": DIMENSIONS["length"], "t": DIMENSIONS["time"]}
"""Powers of coordinates where something with a unit is added to them; elsewhere they may be their numbers alone."""


class _Part(NamedTuple):
    """What is known of a part of a formula.

    Args:
        powers: that it may have, the likeliest first; None: any.
        bare: nothing in it has a unit, so that it may be of the kind of what it is added to.
    """

    powers: tuple[Powers, ...] | None
    bare: bool = False


ANY = _Part(None, bare=True)
A_NUMBER = _Part((NONE,), bare=True)


def powers_of_formula(
    text: str,
    named: Mapping[str, Powers],
    on_scale: Collection[str] = (),
    places: Collection[str] = (),
    wanted: Known = None,
) -> Known:
    """The powers of a formula without that of radians; None where nothing gives them.

    A parameter without a unit and a decimal number may stand for anything; whole numbers and pi have no dimension where
    they multiply or divide. A coordinate may be its number there, and has its own dimension where something with a unit
    is added to it. Radians do not count.

    Args:
        text: the formula.
        named: powers of parameters that have a unit, as `powers_of_number` gives them.
        on_scale: parameters that are temperatures on a scale.
        places: the names in it that are coordinates or the time.
        wanted: these are given where the formula may have them.

    Raises:
        UnitError: it adds what cannot be added; to be said behind the formula.
    """
    check_temperatures(_tree(text), on_scale)
    found = _Dimensions(named, places).of(_tree(text, marked=True)).powers
    return wanted if found is None or wanted in found else found[0]


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


class _Dimensions:
    """What is known of the parts of formulas.

    Args:
        named: powers of names that have a unit.
        places: names of coordinates.
    """

    def __init__(self, named: Mapping[str, Powers], places: Collection[str]) -> None:
        self.named, self.places = named, places

    def of(self, node: ast.expr) -> _Part:
        """What is known of a part.

        Raises:
            UnitError: it adds what cannot be added, or takes a function of what is no number.
        """
        match node:
            case ast.Name(id="pi") | ast.Constant(value=int()):
                return A_NUMBER
            case ast.Name(id=name) if name in self.named:
                return _Part((self.named[name],))
            case ast.Name(id=name) if name in self.places:
                return _Part((PLACES[name], NONE), bare=True)
            case ast.UnaryOp(operand=operand):
                return self.of(operand)
            case ast.BinOp(op=ast.MatMult(), right=ast.Name(id=mark)):
                return _Part((_plain(MARKED.get(mark, DIMENSIONS["temperature"])),))
            case ast.BinOp(left=left, op=ast.Add() | ast.Sub(), right=right):
                return self._of_terms([left, right])
            case ast.BinOp(left=left, op=ast.Mult() | ast.Div() as op, right=right):
                return _product(self.of(left), self.of(right), -1 if isinstance(op, ast.Div) else 1)
            case ast.BinOp(left=left, op=ast.Pow(), right=right):
                return self._of_power(left, right)
            case ast.Call(func=ast.Name(id=name), args=arguments):
                return self._of_function(name, arguments)
        return ANY

    def _of_power(self, base: ast.expr, exponent: ast.expr) -> _Part:
        powers, bare = self.of(base)
        if isinstance(exponent, ast.Constant) and isinstance(exponent.value, int):
            by = exponent.value
            return _Part(None if powers is None else tuple(tuple(by * p for p in one) for one in powers), bare)
        self._refuse_measured(exponent, "has {} as an exponent", "divide it by another {}")
        return _Part(None, bare)

    def _of_function(self, name: str, arguments: list[ast.expr]) -> _Part:
        if name in ("abs", "min", "max", "atan2"):
            terms = self._of_terms(arguments)
            return ANY if name == "atan2" else terms
        if name == "sqrt":
            powers, bare = self.of(arguments[0])
            known = powers is not None and not any(p % 2 for one in powers for p in one)
            return _Part(tuple(tuple(p // 2 for p in one) for one in powers or ()) if known else None, bare)
        self._refuse_measured(arguments[0], f"takes {name} of {{}}, and it is that of a number", "divide by another {}")
        return ANY

    def _refuse_measured(self, node: ast.expr, what: str, do: str) -> None:
        """Refuses what has a dimension where a number is wanted."""
        powers, bare = self.of(node)
        if not bare and powers is not None and NONE not in powers:
            raise UnitError(what.format(article(spelled(powers[0]))), do.format(spelled(powers[0])))

    def _of_terms(self, terms: list[ast.expr]) -> _Part:
        """What is known of terms that are added or compared: one without a unit is of the kind of the others.

        Raises:
            UnitError: they are not of one kind.
        """
        parts = [(term, self.of(term)) for term in map(_unsigned, terms)]
        measured = [part.powers for _, part in parts if not part.bare and part.powers is not None]
        if not measured:
            return _Part(None, bare=all(part.bare for _, part in parts))
        found = measured[0]
        for own in measured[1:]:
            both = tuple(one for one in found if one in own)
            if not both:
                raise UnitError(f"adds {article(spelled(found[0]))} and {article(spelled(own[0]))}")
            found = both
        for term, _ in parts:
            if isinstance(term, ast.Name) and term.id in self.places and PLACES[term.id] not in found:
                what = f"adds {article(spelled(found[0]))} and {term.id}, which is {article(spelled(PLACES[term.id]))}"
                raise UnitError(what, f'write "1*{term.id}" where its number in SI units is meant')
        return _Part(found)


def _product(one: _Part, other: _Part, sign: int) -> _Part:
    """What is known of two parts that are multiplied, or divided with the sign -1."""
    bare = one.bare and other.bare
    if one.powers is None or other.powers is None:
        return _Part(None, bare)
    both = (tuple(p + sign * q for p, q in zip(a, b)) for a in one.powers for b in other.powers)
    return _Part(tuple(dict.fromkeys(both)), bare)


def _unsigned(node: ast.expr) -> ast.expr:
    """A term without its sign."""
    while isinstance(node, ast.UnaryOp):
        node = node.operand
    return node
