"""What of a piece of furniture a hand may take hold of, for the page of a live session."""

from __future__ import annotations

from typing import TYPE_CHECKING, get_args

from restshape_apps.furniture.scene.plank_events import Parameter

from restshape.live.grab_parts import Thing

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation

TRIANGLES = 12
"""That show the box of a plank."""


def plank_things(simulation: Simulation) -> list[Thing]:
    """The planks of the last frame, each with its parameters."""
    boards = simulation.replay.solver.space
    planks = boards.frame.design.piece.planks
    parameters = get_args(Parameter)
    return [
        Thing(plank.name, "plank", ("press",), "shape", (), parameters, (TRIANGLES * number, TRIANGLES))
        for number, plank in enumerate(planks)
    ]
