"""Formulas in a validated scene, each with its key, and what is asked of all of them."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from pydantic import BaseModel

from restshape.scene.expressions import Expression
from restshape.scene.scene_parameters import Parameters
from restshape.scene.source import Source
from restshape.scene.units import UnitError


def check_units(scene: BaseModel, parameters: Parameters, source: Source) -> None:
    """Refuses formulas of places that give another dimension than is wanted of them.

    Args:
        scene: whose formulas are looked at.
        parameters: of the scene.
        source: for messages.

    Raises:
        UserError: the first formula that adds what cannot be added, or gives what is not wanted.
    """
    for key, formula in formulas(scene):
        try:
            parameters.check_units(formula)
        except UnitError as error:
            raise source.error(key, error.what, error.do) from error


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
