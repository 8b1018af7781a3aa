"""Which numbers are rounding alone: far below the size that a quantity has in a replay, or that its kind has there."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

import numpy as np

from restshape.arrays import Reals
from restshape.scene.expressions import COORDINATES, Expression
from restshape.scene.units import SYMBOLS

if TYPE_CHECKING:
    from restshape.scene.model import Scene

ROUNDING = 1e-9
"""Share of a quantity's scale below which a number is rounding: far above that of floats, as cancelling and solves to a
tolerance leave more, and far below what anybody asks for."""


def load_scales(scene: Scene) -> dict[str, float]:
    """The largest size of the loads of a scene by SI unit, such as that of forces [N]; formulas of places left out."""
    found: dict[str, float] = {}
    for load in scene.loads.values():
        value, unit = getattr(load, load.kind), SYMBOLS.get(str(load.kinds[load.kind].meaning), "")
        sizes = [_size(one, scene) for one in (value if isinstance(value, list | tuple) else [value])]
        found[unit] = max(found.get(unit, 0.0), *sizes, 0.0)
    return {unit: size for unit, size in found.items() if unit and size}


def _size(value: object, scene: Scene) -> float:
    """The size of a number, or of a formula of parameters; 0 of what is neither."""
    if isinstance(value, Expression) and not value.names.intersection(COORDINATES):
        value = float(value.evaluate(0.0, 0.0, scene.parameters))
    return abs(value) if isinstance(value, int | float) and np.isfinite(value) else 0.0


def scales(
    series: Mapping[str, Reals], units: Mapping[str, str], loads: Mapping[str, float] | None = None
) -> dict[str, float]:
    """What counts as the size of each quantity: the largest one of all with its unit, and of loads with it.

    A quantity whose unit is not known has its own largest size; so has a pure number, but 1 at most: a load factor
    tends to infinity where the load goes.

    Args:
        series: (n,) values of a quantity by name, not numbers where it has none.
        units: SI unit by quantity.
        loads: by unit, as `load_scales` gives them.
    """
    own = {name: largest(values) for name, values in series.items()}
    shared: dict[str, float] = dict(loads or {})
    for name, size in own.items():
        if unit := units.get(name, ""):
            shared[unit] = max(shared.get(unit, 0.0), size)
    own |= {name: min(size, 1.0) for name, size in own.items() if units.get(name) == ""}
    return {name: shared.get(units.get(name, ""), size) for name, size in own.items()}


def largest(values: Reals | Iterable[float]) -> float:
    """The largest size among values that are numbers; 0 without any."""
    found = np.asarray(values, dtype=float)
    return float(np.abs(found[np.isfinite(found)]).max(initial=0.0))


def without_rounding(values: Reals, scale: float) -> Reals:
    """Values with 0 for those that are rounding alone."""
    return np.where(np.abs(values) < ROUNDING * scale, 0.0, values)


def cleared(value: float, scale: float) -> float:
    """A value, or 0 where it is rounding alone."""
    return 0.0 if abs(value) < ROUNDING * abs(scale) else value
