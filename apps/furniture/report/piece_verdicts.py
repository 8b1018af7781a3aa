"""Colours that tell of a frame of furniture whether the piece holds, and whether its quantities do."""

from restshape_apps.furniture.report.guided import VALUE

from restshape.replay.constraints import HOLDS
from restshape.report.style import FAINT, INK, REFUSED

BEYOND = "#8e3b8a"
"""Where the piece holds, but a quantity is beyond the limit that its scene gives it."""


def only_limits(verdict: str, broken: str) -> bool:
    """Whether a frame fails by limits of quantities alone; the piece holds. What is wrong with a piece is told first.

    Args:
        verdict: column of a recording.
        broken: column of a recording, such as ``sag is 3.2 mm, at most 3 mm``.
    """
    first = broken.split("; ")[0]
    match = VALUE.search(first)
    return verdict not in ("", HOLDS) and match is not None and match.start() > 0 and match.end() == len(first)


def verdict_colour(verdict: str, broken: str) -> str:
    """The colour of a frame: ink where all holds, red where the piece does not, another where quantities alone do not.

    Args:
        verdict, broken: columns of a recording; a frame without a verdict is pale.
    """
    if not verdict:
        return FAINT
    return INK if verdict == HOLDS else BEYOND if only_limits(verdict, broken) else REFUSED
