"""What a scene holds, in words."""

from collections.abc import Mapping

from pydantic import BaseModel

from restshape.outputs.si_numbers import scaled_unit, si
from restshape.scene.expressions import COORDINATES, Expression
from restshape.scene.units import SYMBOLS, in_si
from restshape.scene.values import annotation_of, dimension_of

ROUNDING = 1e-15
"""Share of the largest component that the rounding of the others may have."""


def listing(value: object, parameters: Mapping[str, float] | None = None) -> str:
    """A number, the text of a formula, or several of them in parentheses.

    Args:
        value: of a key.
        parameters: of the scene; with them a formula of parameters alone has its value beside it.
    """
    if isinstance(value, tuple | list) and len(value) == 1 and isinstance(value[0], str):
        return value[0]
    if isinstance(value, tuple | list):
        # A component that is rounding beside the largest is 0.
        largest = max((abs(one) for one in value if isinstance(one, int | float)), default=0.0)
        shown = (0 if isinstance(one, float) and abs(one) < ROUNDING * largest else one for one in value)
        return f"({', '.join(listing(one, parameters) for one in shown)})"
    if isinstance(value, Expression):
        return value.text if parameters is None else f"{value.text}{_value(value, parameters)}"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    text = f"{value:.6g}"
    return "0" if text == "-0" else text


def _value(formula: Expression, parameters: Mapping[str, float]) -> str:
    """The value of a formula in SI units, such as `` = 2000``; empty where it depends on the place."""
    if formula.names.intersection(COORDINATES):
        return ""
    return f" = {but_rounding(formula, float(formula.evaluate(0.0, 0.0, dict(parameters))), parameters):.6g}"


def but_rounding(formula: Expression, value: float, parameters: Mapping[str, float]) -> float:
    """The value of a formula of parameters, or 0 where it is no more than rounding, such as that of R*cos(90 deg)."""
    return 0.0 if abs(value) <= formula.rounding(parameters) else value + 0.0


def with_symbol(value: object, dimension: object, parameters: Mapping[str, float] | None = None) -> str:
    """A value, as in `listing`, with the SI unit of its dimension; numbers with the prefix that suits the largest.

    A formula that has units of its own, or that alone is the value and whose parameters are not given, is without,
    unless its value stands beside it.
    """
    symbol = SYMBOLS.get(dimension, "") if isinstance(dimension, str) else ""
    parts = value if isinstance(value, tuple | list) else (value,)
    formulas = [part.text for part in parts if isinstance(part, Expression)]
    if symbol and isinstance(value, float | int):
        return si(value, symbol, 6)
    if symbol and not isinstance(value, str) and all(isinstance(part, float | int) for part in parts):
        factor, scaled = scaled_unit(max(map(abs, parts), default=0.0), symbol)
        return f"{listing([factor * part for part in parts])} {scaled}"
    shown = listing(value, parameters)
    valued = parameters is not None and shown != listing(value)
    alone = isinstance(value, Expression) and parameters is None
    if not symbol or ((alone or any(in_si(text) != text for text in formulas)) and not valued):
        return shown
    brackets = isinstance(value, Expression) and value.is_sum and not valued
    return f"({shown}) {symbol}" if brackets else f"{shown} {symbol}"


def keys_in_words(
    model: BaseModel, without: tuple[str, ...] = (), parameters: Mapping[str, float] | None = None
) -> str:
    """The keys of a model that have values, with their units, and those inside them.

    Args:
        model: of a scene.
        without: keys that are left out.
        parameters: as in `listing`.
    """
    found = [(key, words) for key, words in _keys(model, "", parameters) if key not in without]
    return ", ".join(key if words == "true" else f"{key} {words}" for key, words in found)


def _keys(model: BaseModel, prefix: str, parameters: Mapping[str, float] | None) -> list[tuple[str, str]]:
    found = []
    for key, info in type(model).model_fields.items():
        value = getattr(model, key)
        if isinstance(value, BaseModel):
            found += _keys(value, f"{prefix}{info.alias or key}.", parameters)
        elif isinstance(value, Mapping):
            tables = [(name, one) for name, one in value.items() if isinstance(one, BaseModel)]
            found += [row for name, one in tables for row in _keys(one, f"{prefix}{key}.{name}.", parameters)]
        elif value is not None:
            found.append(
                (f"{prefix}{info.alias or key}", with_symbol(value, dimension_of(annotation_of(info)), parameters))
            )
    return found
