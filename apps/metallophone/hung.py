"""Where a plate is hung, in words and for programs, as the command that shows its modes prints it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.modal.hanging import Hanging, HangingPoints, hanging_of
from restshape.outputs.si_numbers import length_unit

if TYPE_CHECKING:
    from restshape.analysis.modal.modal import ModalAnalysis

ROUNDING = 1e-9
"""Of the largest coordinate of both places, below which one is 0."""


def hung(analysis: ModalAnalysis) -> HangingPoints | None:
    """The hanging points of a plate, as its scene asks for them or by default; None of what is held."""
    state = analysis.state
    if state.scene.supports:
        return None
    return hanging_of(state, state.plan.settings("modal").hanging or Hanging())


def hung_words(found: HangingPoints) -> str:
    """The places and what they take from each mode, or why there are none."""
    if not found.found:
        return f"no hanging points: {found.why}"
    largest = float(abs(found.places).max())
    factor, unit = length_unit(largest)
    # The middle of a rim is 0 but for rounding, which is no length.
    seen = np.where(abs(found.places) > ROUNDING * largest, found.places, 0.0)
    places = " and ".join(f"({x:.4g}, {y:.4g}) {unit}" for x, y in factor * seen)
    losses = ", ".join(f"{loss:.2f}" for loss in found.losses)
    return f"hang at {places}; energy of modes 1, 2, ... there over their means: {losses}"


def hung_data(found: HangingPoints) -> dict[str, object]:
    """The same for programs."""
    if not found.found:
        return {"why": found.why}
    return {"places": found.places.tolist(), "losses": found.losses.tolist(), "offset": found.offset}
