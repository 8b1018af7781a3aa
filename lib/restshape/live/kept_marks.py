"""What makes the marks of a simulation, kept from frame to frame, so that only what is new is computed."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import wraps
from operator import is_
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation
    from restshape.live.shown_marks import Mark

T = TypeVar("T")


def kept(simulation: Simulation, make: Callable[[], T]) -> T:
    """What `make` has made at the first frame of a simulation for which it was asked; it goes with the simulation.

    Args:
        simulation: whose marks are shown; make: a class, or a function, of the module that shows them.
    """
    own: dict[Any, Any] = simulation.shown
    found: T | None = own.get(make)
    if found is None:
        found = own[make] = make()
    return found


def same_objects(these: Sequence[object], those: Sequence[object]) -> bool:
    """Whether what something was made from is what it was: the same objects, which nobody changes."""
    return len(these) == len(those) and all(map(is_, these, those))


Marks = Callable[["Simulation"], "list[Mark]"]
"""Gives the marks of the last frame of a simulation."""


def of_answers(marks: Marks) -> Marks:
    """The same function, which gives the last marks again after a frame that was refused: it has no answer of its own.

    Args:
        marks: it is called where the last frame was not refused.
    """

    @wraps(marks)
    def found(simulation: Simulation) -> list[Mark]:
        last = kept(simulation, _LastMarks)
        if not simulation.frame.row["refused"]:
            now = last.marks[marks] = marks(simulation)
            return now
        return last.marks.get(marks, [])

    return found


class _LastMarks:
    """The last marks that each function has given of a simulation."""

    def __init__(self) -> None:
        self.marks: dict[Marks, list[Mark]] = {}
