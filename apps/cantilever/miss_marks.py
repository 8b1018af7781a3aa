"""What a cantilever shows at the hand: how far it is from its goal, and where it is farthest from it."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from restshape.live.kept_marks import kept, of_answers
from restshape.live.shape_marks import shape_marks
from restshape.live.shown_marks import Lines, Mark, Words
from restshape.outputs.si_numbers import si
from restshape.physics.elasticity.target_curves import CurveDistances
from restshape.replay.columns import quantity_column

if TYPE_CHECKING:
    from collections.abc import Mapping

    from restshape.arrays import Reals
    from restshape.fem.space import PlaneSpace
    from restshape.interface.simulation import Simulation
    from restshape.physics.elasticity.goal import Goal
    from restshape.scene.model import Scene


@of_answers
def miss_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a beam that has a goal."""
    return [*shape_marks(simulation), *kept(simulation, MissMarks)(simulation)]


class MissMarks:
    """Makes the marks of each frame; how the edges and goals lie to each other is set up once a mesh."""

    def __init__(self) -> None:
        self._bound: tuple[Scene | None, PlaneSpace | None, int] = (None, None, -1)
        self._distances: dict[str, CurveDistances] = {}

    def __call__(self, simulation: Simulation) -> list[Mark]:
        """The distances of the last frame in words, and a line from where each is largest to the goal."""
        frame, scene, space = simulation.frame, simulation.replay.session.scene, simulation.replay.solver.space
        if not simulation.replay.solver.known:
            return []
        if (scene, space, space.topology) != self._bound:
            self._bound, self._distances = (scene, space, space.topology), _distances(scene, space)
        found = [(name, one) for name, one in scene.quantities.items() if one.kind == "distance"]
        parts = [f"{name} {si(float(frame.row[quantity_column(name)]), 'm')}" for name, _ in found]
        marks: list[Mark] = [Words("; ".join(parts))] if parts else []
        u = frame.fields["displacement"]
        for goal, one in self._distances.items():
            places = space.X[one.nodes] + u[one.nodes]
            node = int(one.nodes[one(places)[0].argmax()])
            here = space.X[node] + u[node]
            there = nearest_on(one.curve, here)
            points, moved = np.array([space.X[node], there]), np.array([u[node], np.zeros(2)])
            far = si(float(np.hypot(*(there - here))), "m")
            marks.append(Lines(f"farthest from {goal}", points, (0,), "goal", moved, [far]))
        return marks


def nearest_on(curve: Reals, place: Reals) -> Reals:
    """The place (2,) on a curve of straight pieces between points (m, 2) that is nearest to another one (2,)."""
    starts, ways = curve[:-1], np.diff(curve, axis=0)
    shares = ((place - starts) * ways).sum(axis=1) / np.maximum((ways**2).sum(axis=1), 1e-300)
    places = starts + np.clip(shares, 0.0, 1.0)[:, None] * ways
    found: Reals = places[((places - place) ** 2).sum(axis=1).argmin()]
    return found


def _distances(scene: Scene, space: PlaneSpace) -> dict[str, CurveDistances]:
    """What measures the edges' distances from each goal that a quantity asks for."""
    goals = cast("Mapping[str, Goal]", scene.sections.get("goal", {}))
    asked = {str(one.distance): one.at for one in scene.quantities.values() if one.kind == "distance"}
    return {
        name: CurveDistances(goals[name], space.facets if at is None else space.facets[space.facets_of(at)])
        for name, at in asked.items()
        if name in goals
    }
