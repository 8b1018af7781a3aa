"""Quantities of interest: numbers that a scene asks for, evaluated by functions that a physics gives."""

from collections.abc import Callable, Iterable, Mapping
from typing import cast

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.fem.averages import mean_over, plain_mean
from restshape.fem.space import PlaneSpace, Space
from restshape.mesh.entity_area import entity_area, signed_loops
from restshape.scene.model import Quantity

Function = Callable[..., float]
"""Of a state, in whatever form its analysis hands it on."""


def largest_size(values: np.ndarray) -> float:
    """The largest size among values."""
    return np.abs(values).max()


NOWHERE = np.empty(0, dtype=np.int32)

# Of a single solution the peak over a frame's time steps is its largest size.
REDUCTIONS: dict[str, Callable[[np.ndarray], float]] = {
    # Methods, which numpy's functions find in as long as they take.
    "max": np.ndarray.max,
    "min": np.ndarray.min,
    "mean": np.ndarray.mean,
    "sum": np.ndarray.sum,
    "absmax": largest_size,
    "peak": largest_size,
}

AT_ONE = (np.ndarray.max, np.ndarray.min, np.ndarray.sum, plain_mean)
"""Reductions that give back a single value."""


def reduction(space: PlaneSpace, quantity: Quantity, nodes: np.ndarray | slice) -> Callable[[np.ndarray], float]:
    """What makes one number of values (k,) at nodes (k,): a mean counts lengths and areas, not nodes."""
    # Where the scene says nothing of it, it is reduced as is usual for its kind.
    how = cast(str, quantity.reduce)
    return mean_over(space, quantity.at, nodes) if how == "mean" else REDUCTIONS[how]


def column_reduced(reduce: Callable[[np.ndarray], float], nodes: np.ndarray | slice, column: int) -> Function:
    """The number that `reduce`, of `reduction`, makes of a column of unknowns (n, f) at nodes (k,)."""
    if isinstance(nodes, slice) or len(nodes) != 1 or (reduce not in AT_ONE and reduce is not largest_size):
        return lambda x, *_: reduce(x[nodes, column])
    # Of a single node it is the value there, or its size; arrays of one number take ten times as long.
    node = int(nodes[0])
    return (lambda x, *_: abs(x[node, column])) if reduce is largest_size else lambda x, *_: x[node, column]


def area(space: Space, cells: np.ndarray | slice = slice(None)) -> float:
    """The area [m^2] of cells of a space in the plane, at rest."""
    return _kernels.total_area(space.X, space.cells[cells])


def areas(space: Space, quantities: Mapping[str, Quantity]) -> dict[str, float]:
    """The quantities that the shape alone gives, which are areas, by name; not a number for all others."""
    return {name: entity_area(space.outline, q.at) if q.area else np.nan for name, q in quantities.items()}


def cells_at(space: Space, name: str, quantity: Quantity) -> np.ndarray | slice:
    """The cells (k,) that a quantity of this name is taken over; all of them where it names no place.

    Raises:
        UserError: there is no cell there.
    """
    if quantity.at is None:
        return slice(None)
    cells = space.cells_of(quantity.at)
    if len(cells) == 0:
        raise UserError(f"{quantity.at!r} holds no cell of the mesh", f"quantities.{name}.at", "name a region")
    return cells


def area_at(space: Space, name: str, quantity: Quantity) -> Function:
    """The area [m^2] of what a quantity of this name is taken over, whatever the state: that of the shape, exact.

    Raises:
        UserError: there is no cell there.
    """
    cells_at(space, name, quantity)
    signed = signed_loops(space.outline, quantity.at)
    return lambda *_: space.outline.swept_area(signed)


class Observer:
    """Evaluates the quantities of a scene, and their peaks over the time steps of a frame.

    Args:
        functions: by name.
        peaks: names of those of which the largest size over the time steps counts.
    """

    def __init__(self, functions: Mapping[str, Function], peaks: Iterable[str] = ()) -> None:
        self.functions = dict(functions)
        self.watched = tuple(peaks)
        self._peaks: dict[str, float] = {}

    def __call__(self, *state: object) -> dict[str, float]:
        """All quantities at a state."""
        return {name: self._value(name, function, state) for name, function in self.functions.items()}

    @property
    def reads(self) -> np.ndarray | None:
        """Nodes (k,), ascending, whose unknowns alone the quantities hang on; None: some may hang on all."""
        found = [getattr(function, "reads", None) for function in self.functions.values()]
        known = [nodes for nodes in found if nodes is not None]
        return np.unique(np.concatenate([NOWHERE, *known])) if len(known) == len(found) else None

    def begin(self) -> None:
        """Forget the peaks: a new frame begins."""
        self._peaks.clear()

    def step(self, *state: object) -> None:
        """Take in the state after a time step."""
        for name in self.watched:
            self._peaks[name] = max(self._peaks.get(name, 0.0), abs(float(self.functions[name](*state))))

    def _value(self, name: str, function: Function, state: tuple[object, ...]) -> float:
        if name not in self.watched:
            return float(function(*state))
        if name not in self._peaks:
            self._peaks[name] = abs(float(function(*state)))
        return self._peaks[name]
