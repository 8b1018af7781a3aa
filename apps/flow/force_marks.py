"""What a flow shows at the hand: the force of the fluid on each body whose drag or lift the scene asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restshape.live.kept_marks import of_answers
from restshape.live.shape_marks import shape_marks
from restshape.live.shown_marks import Arrows, Mark
from restshape.outputs.si_numbers import si
from restshape.replay.columns import quantity_column

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation

AXES = {"drag": 0, "lift": 1, "drag_coefficient": 0, "lift_coefficient": 1}
"""Kinds of quantities that are forces of the fluid, by their axes."""
NAMES = ("drag", "lift")


@of_answers
def force_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a flow: an arrow on each body, of the components that are asked for.

    Where coefficients are asked for, the arrow has those.
    """
    marks, frame, replay = shape_marks(simulation), simulation.frame, simulation.replay
    if not replay.solver.known:
        return marks
    found: dict[tuple[str, bool], dict[int, float]] = {}
    for name, quantity in replay.session.scene.quantities.items():
        if quantity.kind in AXES and quantity.at is not None:
            pure = quantity.kind.endswith("coefficient")
            value = float(frame.row[quantity_column(name)])
            found.setdefault((quantity.at, pure), {})[AXES[quantity.kind]] = value
    for (on, pure), parts in found.items():
        at = replay.solver.space.X[replay.solver.space.nodes_of(on)].mean(axis=0)
        vector = np.array([[parts.get(0, 0.0), parts.get(1, 0.0)]])
        if np.isfinite(vector).all() and vector.any():
            unit = "" if pure else "N"
            words = ", ".join(f"{NAMES[axis]} {si(value, unit)}" for axis, value in sorted(parts.items()))
            marks.append(Arrows(f"force on {on}", at[None], vector, unit, "force", [words]))
    return marks
