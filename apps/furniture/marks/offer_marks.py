"""Suggestions as offers that are clicked, and slid along: thesis, figure 6.6."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.shape.changed_planks import changed_planks

from restshape.live.shown_marks import Lines, Offer

if TYPE_CHECKING:
    from collections.abc import Sequence

    from restshape_apps.furniture.guidance.design import Design
    from restshape_apps.furniture.guidance.suggested import Suggestion, SuggestionList
    from restshape_apps.furniture.shape.planks import Piece, Plank

EDGES = np.array([0, 1, 3, 2, 0, 4, 5, 7, 6, 4, 5, 1, 3, 7, 6, 2])
"""Corners of a plank, as `Plank.corners` counts them, along a line that goes over all of its edges."""
SLIDE = {"do": "slide"}


class OfferMarks:
    """Makes the offers of each list of suggestions once, and one that slides along a suggestion that is chosen."""

    def __init__(self) -> None:
        self._of: SuggestionList | None = None
        self._offers: list[Offer] = []

    def __call__(
        self, design: Design, found: SuggestionList, chosen: Suggestion | None, model: Furniture
    ) -> list[Offer]:
        """The offers of a frame; arguments: its design, what was found for it, what is chosen, and a model of it."""
        if found is not self._of:
            self._of, self._offers = found, _offers(design.piece, found.found, model)
        if found.found or chosen is None or not chosen.unit:
            return self._offers
        return [Offer(f"along {chosen.name}", chosen.range_words, (), SLIDE)]


def _offers(piece: Piece, found: Sequence[Suggestion], model: Furniture) -> list[Offer]:
    """An offer for each suggestion, with what it makes of the planks that it changes; none for what worsens."""
    offers = []
    for number, one in enumerate(found, 1):
        after = one.piece or model.moved(one.t * one.direction)
        if not one.valid and _worsens(model, after):
            continue
        changed = [plank for plank, other in zip(after.planks, changed_planks(piece, after)) if other]
        choose = {"do": "choose", "number": number}
        slide = SLIDE if one.unit and one.span[1] > one.span[0] else None
        offers.append(Offer(f"{number}: {one.name}", one.summary, (choose,), slide, "to", plank_lines(changed, number)))
    return offers


def _worsens(model: Furniture, after: Piece) -> bool:
    """Whether a piece has all flaws that the model's has, and its worst joint bears more."""
    old, new = model.test(), Furniture(after, model.compliance).test()
    return not old.flaws & ~new.flaws and max(new.pull, new.shear) > max(old.pull, old.shear)


def plank_lines(planks: Sequence[Plank], number: int) -> tuple[Lines, ...]:
    """The edges of planks that a suggestion changes; nothing where there are none."""
    if not planks:
        return ()
    points = np.concatenate([plank.corners()[EDGES] for plank in planks])
    names = [plank.name for plank in planks]
    return (Lines(f"suggestion {number}", points, range(0, len(points), len(EDGES)), "guide", None, names),)
