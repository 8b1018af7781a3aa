"""Numbers without a unit that are probably meant in another one than SI."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, get_args, get_origin

from pydantic import BaseModel

from restshape.application import application_of
from restshape.scene.model import Scene
from restshape.scene.values import annotation_of, dimension_of

FULL_TURN = 2.0 * math.pi
COLD = 150.0
"""Temperature [K] below which a number without a unit is rather one in degrees Celsius."""
SHAPES = ("shape", "bodies", "start")
"""Tables whose lengths make the size that others are measured by, or lie anywhere."""
PLACES = ("at", "move", "about")
"""Keys of panels that say where these lie, which is anywhere as well."""


def bare_numbers(scene: Scene, size: float) -> list[str]:
    """What is odd about numbers of a scene without a unit, a line each: angles, temperatures, lengths.

    Args:
        scene: with its tables as they were written.
        size: of its shape [m].
    """
    app = application_of(scene)
    found = [*_of(scene, scene.raw, "", size)]
    for name, keys in scene.raw.get("effects", {}).items():
        if name in app.effects and isinstance(keys, Mapping):
            found += _of_model(app.effects[name].model, None, keys, f"effects.{name}", size)
    dimensions = {axis: dimension for one in app.physics for axis, dimension in one.boundary.items()}
    for name, support in scene.raw.get("supports", {}).items():
        fix = support.get("fix") if isinstance(support, Mapping) else None
        for axis, value in fix.items() if isinstance(fix, Mapping) else ():
            found += _doubt(f"supports.{name}.fix.{axis}", dimensions.get(axis), value, size)
    return found


def _of(model: object, raw: Any, key: str, size: float) -> Iterator[str]:
    """Of a model, or of models by name, and its table."""
    if isinstance(model, Mapping) and isinstance(raw, Mapping):
        for name, one in model.items():
            yield from _of(one, raw.get(name), f"{key}.{name}" if key else str(name), size)
    elif isinstance(model, BaseModel) and isinstance(raw, Mapping):
        yield from _of_model(type(model), model, raw, key, size)


def _of_model(
    kind: type[BaseModel], model: BaseModel | None, raw: Mapping[str, Any], key: str, size: float
) -> Iterator[str]:
    """Of the keys of a model that a table holds."""
    for name, field in kind.model_fields.items():
        word = field.alias or name
        if word not in raw:
            continue
        here, annotation = f"{key}.{word}" if key else word, annotation_of(field)
        dimension = dimension_of(annotation)
        if isinstance(dimension, str):
            yield from _doubt(here, dimension, raw[word], size)
        elif get_origin(dimension) is dict and isinstance(of_values := dimension_of(get_args(dimension)[1]), str):
            for entry, value in raw[word].items() if isinstance(raw[word], Mapping) else ():
                yield from _doubt(f"{here}.{entry}", of_values, value, size)
        elif model is not None:
            yield from _of(getattr(model, name), raw[word], here, size)


def _doubt(key: str, dimension: str | None, written: Any, size: float) -> Iterator[str]:
    """What is odd about a value, or a list of values, of a key."""
    for value in written if isinstance(written, list | tuple) else [written]:
        if isinstance(value, bool) or not isinstance(value, int | float):
            continue
        if dimension == "angle" and abs(value) > FULL_TURN:
            choice = f'"{value:g} deg" or "{value:g} rad"'
            yield f"{key}: an angle without a unit is in radians, and {value:g} is more than a turn: {choice}?"
        elif dimension == "temperature" and 0.0 < value < COLD:
            choice = f'"{value:g} degC" or "{value:g} K"'
            celsius = f"{value - 273.15:.4g} degC"
            yield f"{key}: a temperature without a unit is in K, and {value:g} K is {celsius}: {choice}?"
        elif dimension == "length" and abs(value) > size and _is_measured(key):
            choice = f'"{value:g} mm" or "{value:g} m"'
            yield (
                f"{key}: a length without a unit is in metres, and {value:g} m is more than the {size:.3g} m of the "
                f"whole shape: {choice}?"
            )


def _is_measured(key: str) -> bool:
    """Whether a length of the scene is one that the size of the shape bounds."""
    table, _, rest = key.partition(".")
    return table not in (*SHAPES, "material") and not (table == "panels" and rest.rpartition(".")[2] in PLACES)
