"""What conducting bodies and warm fluids show at the hand: isotherms, besides what all shapes show."""

from __future__ import annotations

from typing import TYPE_CHECKING

from restshape.live.isolines import isolines
from restshape.live.kept_marks import of_answers
from restshape.live.shape_marks import shape_marks
from restshape.live.shown_marks import Mark

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation


@of_answers
def isotherm_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a scene of heat."""
    marks, solver = shape_marks(simulation), simulation.replay.solver
    field = simulation.frame.fields.get("temperature")
    if field is None or not solver.known:
        return marks
    return [*marks, *isolines("isotherms", solver.space.X, solver.space.cells, field, "K")]
