"""Suggestions that make an invalid piece stable and durable again, by combinations of few design modes."""

from __future__ import annotations

from dataclasses import dataclass, replace

from restshape_apps.furniture.guidance.force_space import durability_space, stability_space, whole_space
from restshape_apps.furniture.guidance.searchable_piece import SearchablePiece
from restshape_apps.furniture.physics.furniture import ALL, LOST, OVERLAPPING, UNSTABLE, Furniture
from restshape_apps.furniture.shape.design_modes import DesignModes

from restshape.guidance.combination_search import Combination, Limits, Search

SHOWN = 8


@dataclass(frozen=True)
class Combinations:
    """What a search found.

    Args:
        found: at most `SHOWN`, the most different and widest first.
        tried: combinations tried of each number of modes.
        led: combinations kept that lead into the box.
        tested: combinations tested in full.
        modes: that were combined.
        mended: combinations whose direction was looked for again where the first one had led.
    """

    found: tuple[Combination, ...]
    tried: tuple[int, ...]
    led: int
    tested: int
    modes: DesignModes
    mended: int = 0


def suggest(
    furniture: Furniture,
    most: int = 3,
    shown: int = SHOWN,
    limits: Limits | None = None,
    modes: DesignModes | None = None,
) -> Combinations:
    """Suggestions for a piece that falls or has a weak joint; none for one that is valid.

    Stability comes first: where the piece is weak too and nothing makes it both stable and durable, suggestions that
    make it stable are given, and say so.

    Args:
        furniture: the model of the piece.
        most: modes that are combined at most; `forecast` shows what more of them cost.
        shown: suggestions at most.
        limits: how much the search may do; where a second one follows, it has half of the trials.
        modes: that are combined; None: all that the piece has.
    """
    result, limits = furniture.test(), limits or Limits()
    if modes is None:
        modes = DesignModes.of(furniture.piece, furniture.kernel.freedoms())
    if result.valid or result.flaws & (LOST | OVERLAPPING) or not len(modes):
        return Combinations((), (), 0, 0, modes)
    unstable = bool(result.flaws & UNSTABLE)
    first = SearchablePiece(furniture, modes, stability_space if unstable else durability_space)
    search = Search(first, ALL, limits)
    searches, found = [search], search.run(most, shown)
    if unstable and 2 * len(found) < shown and most > 1:
        # What makes a piece stand may break a joint: both are looked at at once.
        rest = replace(limits, trials=limits.trials // 2, mended=limits.mended - search.vain)
        again = Search(SearchablePiece(furniture, modes, whole_space), ALL, rest, search.alone)
        searches.append(again)
        found = (found + again.run(most, shown, [one.modes for one in found]))[:shown]
    if unstable and not found:
        partly = Search(SearchablePiece(furniture, modes, stability_space), LOST | OVERLAPPING | UNSTABLE, limits)
        searches.append(partly)
        found = [replace(one, valid=False) for one in partly.run(most, shown)]
    furniture.test()
    tried = tuple(map(sum, zip(*(one.tried for one in searches if one.tried))))
    led, tested, mended = (sum(getattr(one, name) for one in searches) for name in ("led", "tested", "mended"))
    return Combinations(tuple(found), tried, led, tested, modes, mended)
