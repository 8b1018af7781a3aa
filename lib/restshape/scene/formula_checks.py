"""Formulas in a validated scene, each with its key, and what is asked of all of them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import numpy as np
from pydantic import BaseModel

from restshape.scene.expressions import Expression
from restshape.scene.scene_parameters import Parameters
from restshape.scene.source import Source
from restshape.scene.units import UnitError, refuse_impossible


def check_units(model: BaseModel, parameters: Parameters, source: Source, key: tuple[str, ...] = ()) -> None:
    """Refuses formulas of places that give another dimension than is wanted of them.

    Args:
        model: a scene, or a table of one, whose formulas are looked at.
        parameters: of the scene.
        source: for messages.
        key: of the table.

    Raises:
        UserError: the first formula that adds what cannot be added, or gives what is not wanted.
    """
    for place, formula in formulas(model, key):
        try:
            parameters.check_units(formula)
        except UnitError as error:
            raise source.error(place, error.what, error.do) from error


def check_formulas(model: BaseModel, values: Mapping[str, float], source: Source, key: tuple[str, ...] = ()) -> None:
    """Refuses formulas that name what is neither a coordinate nor a parameter, or give what cannot be.

    Args:
        model: a scene, or a table of one, whose formulas are looked at.
        values: of the scene's parameters.
        source: for messages.
        key: of the table.

    Raises:
        UserError: the first such formula.
    """
    for place, formula in formulas(model, key):
        if unknown := formula.unknown(values):
            raise source.error(place, unknown.what, unknown.do)
        if formula.names.isdisjoint(formula.coordinates):
            _refuse_impossible(place, formula, values, source)


def _refuse_impossible(
    place: tuple[str, ...], formula: Expression, values: Mapping[str, float], source: Source
) -> None:
    """Refuses a formula of parameters alone that gives what no quantity of its dimension can be."""
    try:
        with np.errstate(all="ignore"):
            value = float(formula.evaluate(0.0, 0.0, values))
        if not math.isfinite(value):
            raise source.error(place, f"the formula {formula.text!r} gives {value}", "change it, or the parameters")
        refuse_impossible(value, formula.wanted)
    except UnitError as error:
        raise source.error(place, f"{formula.text!r}: {error.what}", error.do) from error


Found = list[tuple[tuple[str, ...], Expression]]
PLAIN = frozenset({str, int, float, bool, type(None)})
"""Types of values in which there is no formula: most are of these, and scenes are looked through with each edit."""


MOST_TABLES = 256
"""Tables of which it is known at a time which formulas they hold."""
_KNOWN: dict[tuple[int, tuple[str, ...]], tuple[object, Found]] = {}
"""Formulas by the identity of a table, which stays as long as it is here, and its key."""


def formulas(model: BaseModel, key: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Expression]]:
    """All formulas of a model, each with its key; tables that were looked through before are not again."""
    for name, table in _within(model):
        if type(table) not in PLAIN:
            yield from _formulas_of_table(table, (*key, name))


def _formulas_of_table(table: object, key: tuple[str, ...]) -> Found:
    known = _KNOWN.pop((id(table), key), None)
    # What is found again is among the last ones to be forgotten.
    _KNOWN[id(table), key] = known = known or (table, [*_formulas_in(table, key)])
    if len(_KNOWN) > MOST_TABLES:
        del _KNOWN[next(iter(_KNOWN))]
    return known[1]


def _formulas_in(value: object, key: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], Expression]]:
    if isinstance(value, Expression):
        yield key, value
        return
    for name, one in _within(value):
        if type(one) not in PLAIN:
            yield from _formulas_in(one, (*key, name))


def _within(value: object) -> Iterator[tuple[str, object]]:
    """What a table, or a list, holds, with the keys."""
    if isinstance(value, BaseModel):
        for name, field in type(value).model_fields.items():
            yield field.alias or name, getattr(value, name)
        yield from (value.model_extra or {}).items()
    elif isinstance(value, Mapping):
        yield from ((str(name), one) for name, one in value.items())
    elif isinstance(value, list | tuple):
        yield from ((str(place), one) for place, one in enumerate(value))
