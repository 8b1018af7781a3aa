"""How what a press takes hold of follows the hand, as its event says."""

from __future__ import annotations

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.edit_script import Press

KEYS = {"along": "along", "counted": "as", "mirror": "mirror"}
"""What an event says of it, and how a script writes it."""


def map_of(event: Press) -> tuple[Reals | None, Reals | None]:
    """The tensor (2, 2) of the control points, and two points (2, 2) of the line of a mirror [m]; None as usual.

    Source: figure 5.8 of the thesis.
    """
    line = None if event.mirror is None else np.array(event.mirror)
    if event.along is None:
        return None, line
    return np.outer(event.along, event.along if event.counted is None else event.counted), line


def refuse_map(event: Press) -> None:
    """Refuses a map of the hand for what is held in space.

    Raises:
        UserError: there is one.
    """
    given = [word for key, word in KEYS.items() if getattr(event, key) is not None]
    if given:
        what = f"{event.on} is held in space, where all goes as the hand: it takes no {' and no '.join(given)}"
        raise UserError(what, do="leave it out, and drag along that direction")
