"""Planks that edits have changed, drawn otherwise by their scene: what the edits have added stays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from restshape_apps.furniture.shape.planks import Plank

from restshape.errors import UserError

SAME = 1e-12
"""Change of a number of a drawing that is none [m]."""


def kept_edits(plank: Plank, drawings: tuple[Plank, Plank], drawn: Plank, set_itself: bool) -> Plank:
    """An edited plank whose drawing changes: it differs from the new one by what edits had added to the old one.

    Moves count along the plank's own axes where these turn. What the drawing does not change stays as it is.

    Args:
        plank: as edits have left it.
        drawings: before and after.
        drawn: the first drawing with its ends closed, from which edits began.
        set_itself: a key of this plank was set: what changes is as the new drawing has it, whatever edits had added.

    Raises:
        UserError: edits have made the plank shorter than it is now.
    """
    before, after = drawings
    turned = not np.array_equal(before.axes, after.axes)
    moved = np.abs(after.centre - before.centre) > SAME
    grown = np.abs(after.size - before.size) > SAME
    more, way = plank.size - drawn.size, plank.centre - drawn.centre
    if turned:
        way = after.axes @ (before.axes.T @ way)
    size = after.size + np.where(set_itself & grown, 0.0, more)
    size[2] = after.size[2] if grown[2] else plank.size[2]
    if not size[:2].min() > 0.0:
        axis = "xy"[int(np.argmin(size[:2]))]
        what = f"{plank.name} would have no length along its {axis} left: edits have made it shorter"
        raise UserError(what, do=f"make it longer by an edit, or set keys of planks.{plank.name}")
    axes = after.axes
    if not turned:
        axes = plank.axes
    elif not set_itself and not np.array_equal(plank.axes, drawn.axes):
        axes = after.axes @ (drawn.axes.T @ plank.axes)
    return replace(plank, centre=after.centre + np.where(set_itself & moved, 0.0, way), axes=axes, size=size)
