"""The order in which suggestions are shown."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from restshape_apps.furniture.guidance.preferences import grows, preserved, way_of_material
from restshape_apps.furniture.guidance.suggested import Suggestion
from restshape_apps.furniture.shape.planks import Piece

FASTENERS = 0.01
"""How far material goes that counts as much as closer or other fasteners, in parts of the piece."""

Rank = tuple[bool, bool, int, int, float]
"""Whether something is still wrong, or doubtful, how much is not kept, how many ends of what is joined stay free, and
how far material goes [m]."""


def ranked(piece: Piece, found: Sequence[tuple[Suggestion, Piece]]) -> list[Suggestion]:
    """Suggestions by what they leave wrong or doubtful, what they keep, and how far material goes; of each kind the
    first comes before the others.

    Args:
        piece: that they are for.
        found: suggestions, each with the piece after it.
    """
    order = sorted(((_rank(piece, one, after), one) for one, after in found), key=lambda pair: pair[0])
    seen: Counter[tuple] = Counter()
    places = []
    for rank, one in order:
        kind = (*rank[:4], one.kind)
        places.append(((*rank[:4], seen[kind]), one))
        seen[kind] += 1
    return [one for _, one in sorted(places, key=lambda pair: pair[0])]


def _rank(piece: Piece, one: Suggestion, after: Piece) -> Rank:
    if one.settings:
        # All boards stay where they are for other fasteners, and none is the same for another thickness.
        fasteners = all(key.startswith("fastener.") for key, _ in one.settings)
        return not one.valid, bool(one.doubt), 0, 0, (FASTENERS if fasteners else 1.0) * piece.size
    lost = preserved(piece, after).count(False) + grows(piece, after)
    return not one.valid, bool(one.doubt), lost, one.free, round(way_of_material(piece, after), 9)
