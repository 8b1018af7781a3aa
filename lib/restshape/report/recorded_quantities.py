"""What the header of a recording holds of quantities: their tables, units and limits, under the names of today."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np

from restshape.application import applications
from restshape.arrays import Reals
from restshape.outputs.si_numbers import unit_of
from restshape.replay.columns import limit_column
from restshape.scene.application_registry import installed_physics
from restshape.scene.key_aliases import by_todays_names
from restshape.scene.quantity import CORE, Quantity, QuantityKind
from restshape.scene.units import UnitError, quantity

if TYPE_CHECKING:
    from restshape.replay.recording.recording import Recording

LIMITS = ("min", "max")


def quantity_specs(header: Mapping[str, Any]) -> dict[str, dict[str, Any]]:
    """The quantities of the recorded scene by name, as the scene wrote them, but with keys named as they are today."""
    scene = header.get("scene_values")
    given = scene.get("quantities", {}) if isinstance(scene, Mapping) else {}
    return {name: _of_today(spec) for name, spec in given.items() if isinstance(spec, dict)}


def quantity_units(header: Mapping[str, Any]) -> dict[str, str]:
    """Quantity -> unit, as far as the header's scene says."""
    units = kind_units()
    return {
        name: next((units[key] for key in spec if key in units), "") for name, spec in quantity_specs(header).items()
    }


def limits_of(recording: Recording) -> dict[str, dict[str, float]]:
    """The limits `min` and `max` of quantities in SI units, those alone that there are.

    Of recordings of version 0.1, which hold the limits of their scene alone, those that are numbers, or numbers with
    units: parameters of formulas are not recorded.
    """
    given = recording.header.get("limits")
    if not isinstance(given, dict):
        given = quantity_specs(recording.header)
    known = known_kinds()
    found = {}
    for name, one in given.items():
        if isinstance(one, dict):
            dimension = next((known[key].dimension for key in one if key in known), None)
            numbers = {key: _number(one[key], dimension) for key in LIMITS if key in one}
            if numbers := {key: value for key, value in numbers.items() if np.isfinite(value)}:
                found[name] = numbers
    return found


def limit_series(recording: Recording) -> dict[str, dict[str, Reals]]:
    """The limits of each frame (n,), as `limits_of` has those of the first one; parameters may move them."""
    found = {}
    for name, limits in limits_of(recording).items():
        moved = {key: recording.table.get(limit_column(name, key)) for key in limits}
        found[name] = {
            key: np.full(recording.n, limit) if (of := moved[key]) is None else np.asarray(of, dtype=float)
            for key, limit in limits.items()
        }
    return found


def recorded_kinds(header: Mapping[str, Any]) -> dict[str, QuantityKind]:
    """The kind of each quantity of the recorded scene, of those that are known."""
    known = known_kinds()
    found = (
        (name, next((known[key] for key in spec if key in known), None))
        for name, spec in quantity_specs(header).items()
    )
    return {name: kind for name, kind in found if kind}


@cache
def known_kinds() -> dict[str, QuantityKind]:
    """The kinds of quantities that installed applications know."""
    known = [CORE, *(one.quantities for one in installed_physics(applications().values()))]
    return {key: kind for kinds in known for key, kind in kinds.items()}


@cache
def kind_units() -> dict[str, str]:
    """Their units."""
    return {key: unit_of(kind.unit) for key, kind in known_kinds().items()}


@cache
def _renamed() -> dict[str, str]:
    """Old names of keys by those of today."""
    return Quantity.renamed | {key: kind.renamed for key, kind in known_kinds().items() if kind.renamed}


def _of_today(spec: dict[str, Any]) -> dict[str, Any]:
    try:
        named = by_todays_names(spec, _renamed())
    except UnitError:
        return spec
    return named if isinstance(named, dict) else spec


def _number(value: object, dimension: str | None) -> float:
    """In SI units; NaN where it is no number and no number with a unit."""
    try:
        return quantity(value, dimension) if isinstance(value, int | float | str) else np.nan
    except UnitError:
        return np.nan
