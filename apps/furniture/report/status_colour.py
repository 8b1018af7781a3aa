"""Colours of a frame of furniture: whether the piece holds, and whether its quantities do."""

from collections.abc import Mapping
from typing import Any

from restshape_apps.furniture.report.guided import doubtful, only_limits

from restshape.replay.constraints import HOLDS
from restshape.report.style import FAINT, INK, REFUSED

BEYOND = "#8e3b8a"
"""Where the piece holds, but a quantity is beyond the limit that its scene gives it."""


DOUBT = "#b87900"
"""Where the piece holds, but something is doubtful."""


def status_colour(row: Mapping[str, Any]) -> str:
    """The colour of a frame: ink where all holds, red where the piece does not, another where quantities alone do not.

    Args:
        row: of a recording; a frame without a constraint status is pale.
    """
    if not row["constraint_status"]:
        return FAINT
    if row["constraint_status"] == HOLDS:
        return INK
    return DOUBT if doubtful(row) else BEYOND if only_limits(row) else REFUSED
