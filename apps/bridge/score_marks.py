"""What a bridge shows at the hand: its score, and how near the limit is that keeps it from a better one."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

from restshape.live.kept_marks import of_answers
from restshape.live.shape_marks import shape_marks
from restshape.live.shown_marks import Mark, Words
from restshape.outputs.si_numbers import si
from restshape.replay.columns import quantity_column
from restshape.replay.constraints import limits_of

if TYPE_CHECKING:
    from restshape.interface.simulation import Simulation


@of_answers
def score_marks(simulation: Simulation) -> list[Mark]:
    """The marks of the last frame of a bridge."""
    marks, row = shape_marks(simulation), simulation.frame.row
    quantities = simulation.replay.session.scene.quantities
    values = {name: float(row[quantity_column(name)]) for name in quantities}
    scores = [f"{name} {si(values[name], 'm²', 4)}" for name, one in quantities.items() if one.area]
    uses = {
        name: values[name] / limit.most
        for name, limit in limits_of(quantities).items()
        if isfinite(limit.most) and limit.most > 0.0 and isfinite(values[name])
    }
    nearest = max(uses, key=lambda name: uses[name], default="")
    limit = [f"{nearest} is at {100.0 * uses[nearest]:.0f} % of its limit"] if nearest else []
    if not scores and not limit:
        return marks
    return [*marks, Words("; ".join([*scores, *limit]), None, "limit" if nearest and uses[nearest] > 1.0 else "guide")]
