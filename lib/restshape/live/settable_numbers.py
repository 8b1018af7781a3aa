"""The numbers of a scene that can be set during an edit, with their units and bounds: sliders of a page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isfinite
from typing import TYPE_CHECKING

from restshape.errors import UserError, ValueProblem
from restshape.scene.dimensions import powers_of_number
from restshape.scene.given_numbers import Key, bounds_at, unit_at, value_below
from restshape.scene.units import SYMBOLS, in_units, quantity, reads_as_quantity, spelled
from restshape.shape.script_session import FIXED

if TYPE_CHECKING:
    from restshape.scene.model import Scene

PARAMETERS = "parameters"
MOST = 400
"""Numbers that a page gets at most."""


@dataclass(frozen=True)
class SceneNumber:
    """A number of a scene.

    Args:
        key: dotted, as `set` takes it.
        value: in SI units; text: as it is written.
        unit: SI; empty where it has none, or that is not known.
        low, high: what it may be, in SI units; None: no bound is known.
        parameter: it is one of ``[parameters]``.
        whole: it is a whole number, such as one of modes.
    """

    key: str
    value: float
    text: str
    unit: str
    low: float | None
    high: float | None
    parameter: bool
    whole: bool = False

    def said(self) -> dict[str, object]:
        """What the page gets."""
        return {key: value for key, value in vars(self).items() if value is not None}


class SceneNumbers:
    """The numbers of the scenes of a session; units and bounds are looked up once."""

    def __init__(self) -> None:
        self._known: dict[Key, tuple[str, float | None, float | None]] = {}

    def __call__(self, scene: Scene) -> list[SceneNumber]:
        """Those of a scene: its parameters first, then the others in the order of the file, without formulas."""
        raw = {key: table for key, table in scene.raw.items() if key not in FIXED}
        found = [*self._below(raw.pop(PARAMETERS, {}), scene, (PARAMETERS,))]
        for key, table in raw.items():
            if isinstance(table, dict | list):
                found += self._below(table, scene, (key,))
        return found[:MOST]

    def _below(self, here: object, scene: Scene, key: Key) -> Iterator[SceneNumber]:
        if isinstance(here, Mapping):
            for name, one in here.items():
                yield from self._below(one, scene, (*key, str(name)))
        elif isinstance(here, list):
            for place, one in enumerate(here):
                yield from self._below(one, scene, (*key, str(place)))
        elif (value := _value(here, scene, key)) is not None and all("." not in part for part in key):
            if key not in self._known:
                self._known[key] = _unit(here, scene, key), *bounds_at(scene, key)
            parameter = key[0] == PARAMETERS
            whole = not parameter and isinstance(value_below(scene, key), int)
            yield SceneNumber(".".join(key), value, str(here), *self._known[key], parameter, whole)


def _value(written: object, scene: Scene, key: Key) -> float | None:
    """A number in SI units; None of what is none, or is a formula."""
    if isinstance(written, bool) or not isinstance(written, int | float | str):
        return None
    if isinstance(written, str) and not reads_as_quantity(written):
        return None
    known = value_below(scene, key)
    if isinstance(known, int | float) and not isinstance(known, bool):
        return float(known) if isfinite(known) else None
    try:
        found = quantity(written, None)
    except (ValueProblem, UserError):
        return None
    return found if isfinite(found) else None


def _unit(written: object, scene: Scene, key: Key) -> str:
    """The SI unit of a number: by its key, else by the unit that it is written with."""
    if found := unit_at(scene, key):
        return found
    try:
        powers = powers_of_number(written) if isinstance(written, str) else None
    except (ValueProblem, UserError):
        return ""
    return SYMBOLS.get(spelled(powers)) or in_units(powers) if powers and any(powers) else ""
