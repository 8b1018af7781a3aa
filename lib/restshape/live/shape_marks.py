"""What all shapes in the plane show at the hand: supports and loads, extremes, limits, singular places, goals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape.live.condition_marks import ConditionMarks
from restshape.live.extreme_marks import ExtremeMarks
from restshape.live.kept_marks import kept, of_answers
from restshape.live.recorded_marks import singular_marks
from restshape.live.seen_frame import SeenFrame
from restshape.live.shown_marks import Lines, Mark
from restshape.replay.recorded_places import SINGULAR_PLACES
from restshape.report.goal_curves import goals_in

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation
    from restshape.scene.model import Scene


@of_answers
def shape_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a simulation of a shape in the plane."""
    return kept(simulation, ShapeMarks)(SeenFrame.of(simulation))


class ShapeMarks:
    """Makes the marks of each frame of a shape; what has not changed is not made again."""

    def __init__(self) -> None:
        self.conditions, self.extremes = ConditionMarks(), ExtremeMarks()
        self._places: tuple[str, list[Mark]] = ("", [])
        self._goals: tuple[Scene | None, list[Mark]] = (None, [])

    def __call__(self, seen: SeenFrame) -> list[Mark]:
        """The marks of a frame."""
        return [*self.conditions(seen), *self._goal_curves(seen), *self._singular(seen), *self.extremes(seen)]

    def _goal_curves(self, seen: SeenFrame) -> list[Mark]:
        """The curves that the deformed shape should reach."""
        if self._goals[0] is not seen.scene:
            found = [Lines(f"goal {name}", curve, meaning="goal") for name, curve in goals_in(seen.scene)]
            self._goals = seen.scene, [*found]
        return self._goals[1]

    def _singular(self, seen: SeenFrame) -> list[Mark]:
        """Where quantities have no limit under refinement."""
        text = str(seen.frame.row.get(SINGULAR_PLACES, ""))
        if text != self._places[0]:
            self._places = text, singular_marks(seen.frame.row)
        return self._places[1]
