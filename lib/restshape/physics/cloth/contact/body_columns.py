"""Bodies as columns of a recording's table, named as the scene's keys are: ``bodies.ball.sphere.radius``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np
from pydantic import ValidationError

from restshape.scene.bodies import Body, numbers_of

PREFIX = "bodies"
RECORDED = "of the recording"
"""In place of the file of a body that comes from a recording."""


def body_columns(bodies: Mapping[str, Body]) -> dict[str, Any]:
    """Name to numpy type of the columns that hold the numbers of bodies: a column a number, in SI units.

    Args:
        bodies: of the scene, by name; their formulas count as numbers.
    """
    return {name: np.float64 for name, _ in _numbers(bodies)}


def body_row(bodies: Mapping[str, Body], known: Iterable[str]) -> dict[str, float]:
    """What a frame's row reports of its bodies.

    Args:
        bodies: of the frame, by name, with numbers in place of formulas.
        known: columns that there are: an edit may bring bodies of other kinds.
    """
    there = set(known)
    return {name: value for name, value in _numbers(bodies) if name in there}


def recorded_bodies(table: Mapping[str, np.ndarray], i: int) -> dict[str, Body]:
    """The bodies, by name, that frame i of a recording's table holds; without those of other kinds than at first."""
    found: dict[str, dict[str, Any]] = {}
    for column, values in table.items():
        if column.startswith(f"{PREFIX}."):
            _, name, *keys = column.split(".")
            _put(found.setdefault(name, {}), keys, float(values[i]))
    bodies = {}
    for name, given in found.items():
        if "mesh" in given:
            # Its triangles are in the header.
            given["mesh"]["file"] = RECORDED
        try:
            bodies[name] = Body.model_validate(given)
        except ValidationError:
            continue
    return bodies


def _numbers(bodies: Mapping[str, Body]) -> Iterator[tuple[str, float]]:
    for name, body in bodies.items():
        for key in numbers_of(body.form):
            value = getattr(body.form, key)
            where = f"{PREFIX}.{name}.{body.kind}.{key}"
            if isinstance(value, tuple):
                yield from ((f"{where}.{k}", part) for k, part in enumerate(value))
            else:
                yield where, value
        yield f"{PREFIX}.{name}.friction", body.friction


def _put(given: dict[str, Any], keys: list[str], value: float) -> None:
    """Put a number where the scene has it; the parts of a list follow each other."""
    for key in keys[:-2]:
        given = given.setdefault(key, {})
    if len(keys) > 1 and keys[-1].isdigit():
        given.setdefault(keys[-2], []).append(value)
    elif len(keys) > 1:
        given.setdefault(keys[-2], {})[keys[-1]] = value
    else:
        given[keys[-1]] = value
