"""What of a piece of furniture a hand may take hold of, for the page of a live session."""

from __future__ import annotations

from typing import TYPE_CHECKING, get_args

from restshape_apps.furniture.scene.plank_events import Parameter

from restshape.live.grab_parts import Thing

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation

FACES = 6
"""Of the box of a plank, each of two triangles: all first ones come before all second ones (`ShownTriangles.parts`)."""


def plank_things(simulation: Simulation) -> list[Thing]:
    """The planks of the last frame, each with its parameters."""
    boards = simulation.replay.solver.space
    planks = boards.frame.design.piece.planks
    parameters = get_args(Parameter)
    starts = [(FACES * number, FACES * (len(planks) + number)) for number in range(len(planks))]
    return [
        Thing(plank.name, "plank", ("press",), "shape", (), parameters, [(start, FACES) for start in runs])
        for plank, runs in zip(planks, starts)
    ]
