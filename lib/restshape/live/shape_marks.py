"""What all shapes in the plane show at the hand: supports and loads, extremes, limits, singular places, goals."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restshape.live.condition_marks import ConditionMarks
from restshape.live.extreme_marks import ExtremeMarks
from restshape.live.kept_marks import kept, of_answers, same_objects
from restshape.live.recorded_marks import singular_marks
from restshape.live.seen_frame import SeenFrame
from restshape.live.shown_marks import NOWHERE, Lines, Mark
from restshape.replay.recorded_places import SINGULAR_PLACES
from restshape.report.goal_curves import goals_in

ROUNDED = 1e-5
"""How far a place in a text may be from its node, in parts of the largest coordinate."""

if TYPE_CHECKING:
    from restshape.arrays import Indices, Reals
    from restshape.interface.simulation import Simulation
    from restshape.scene.model import Scene


def marks_of_answer(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a simulation of a shape in the plane, which was not refused."""
    return kept(simulation, ShapeMarks)(SeenFrame.of(simulation))


@of_answers
def shape_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a simulation of a shape in the plane."""
    return marks_of_answer(simulation)


class ShapeMarks:
    """Makes the marks of each frame of a shape; what has not changed is not made again."""

    def __init__(self) -> None:
        self.conditions, self.extremes = ConditionMarks(), ExtremeMarks()
        self._text: object = ""
        self._places: tuple[list[str], Lines | None] = ([], None)
        self._at: tuple[object, ...] = ()
        self._nodes: Indices | None = None
        self._drawn = Lines("", NOWHERE)
        self._goals: tuple[Scene | None, list[Mark]] = (None, [])

    def __call__(self, seen: SeenFrame) -> list[Mark]:
        """The marks of a frame."""
        goals = self._goals[1] if self._goals[0] is seen.scene else self._goal_curves(seen.scene)
        return [*self.conditions(seen), *goals, *self._singular(seen), *self.extremes(seen)]

    def _goal_curves(self, scene: Scene) -> list[Mark]:
        """The curves that the deformed shape should reach."""
        found = [Lines(f"goal {name}", curve, meaning="goal") for name, curve in goals_in(scene)]
        self._goals = scene, [*found]
        return self._goals[1]

    def _singular(self, seen: SeenFrame) -> list[Mark]:
        """Where quantities have no limit under refinement."""
        # Exponents, which differ from frame to frame, are not said: names alone stand in quotes.
        text = seen.frame.row.get(SINGULAR_PLACES, "")
        if text is not self._text:
            self._text = text
            found, _, places = str(text).partition("}")
            said = [places, *found.split('"')[1::2]]
            if said != self._places[0]:
                self._places = said, next(iter(singular_marks(seen.frame.row)), None)
        mark = self._places[1]
        if mark is None:
            return []
        at = mark, seen.space, seen.space.facets
        if not same_objects(at, self._at):
            self._at, self._nodes = at, _nodes_at(mark.points, seen.space.X)
            self._drawn = mark
            if self._nodes is not None and seen.all_nodes_drawn:
                self._drawn = mark.at_nodes(self._nodes[:, None])
        if self._nodes is None or self._drawn.nodes is not None:
            return [self._drawn]
        moved = seen.moved(self._nodes)
        return [mark if moved is None else mark.gone(moved)]


def _nodes_at(points: Reals, X: Reals) -> Indices | None:
    """The nodes (k,) at places (k, 2), which their text has to six digits; None where one has none."""
    apart = np.abs(X[None] - points[:, None]).max(axis=2)
    nodes = apart.argmin(axis=1)
    near = apart[np.arange(len(nodes)), nodes] <= ROUNDED * np.abs(X).max()
    return nodes if near.all() else None
