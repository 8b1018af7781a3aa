"""What makes the marks of a simulation, kept from frame to frame, so that only what is new is computed."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, TypeVar, cast
from weakref import WeakKeyDictionary

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation

T = TypeVar("T")
_KEPT: WeakKeyDictionary[Simulation, dict[object, object]] = WeakKeyDictionary()


def kept(simulation: Simulation, make: Callable[[], T]) -> T:
    """What `make` has made at the first frame of a simulation for which it was asked; it goes with the simulation.

    Args:
        simulation: whose marks are shown; make: a class, or a function, of the module that shows them.
    """
    own = _KEPT.setdefault(simulation, {})
    if make not in own:
        own[make] = make()
    return cast("T", own[make])
