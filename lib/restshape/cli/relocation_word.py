"""What becomes of `mesh.relocation = "mvc"`, which once named another map."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from restshape.mesh.regions import loop_polygon
from restshape.scene.model import Scene
from restshape.shape.outline import Outline

TURN = 1e-9
"""Of a whole square on two sides: what a corner may turn back by and count as straight."""


def relocation_word(scene: Scene, outline: Outline) -> Iterator[str]:
    """A line where "mvc" is another map in this shape than it was when it named positive mean value coordinates."""
    if scene.mesh.relocation == "mvc" and not _sees_all(outline):
        yield (
            'mesh.relocation: "mvc" is plain mean value coordinates, which differ from positive ones in a shape that '
            'is not convex or has holes or regions: set "pmvc" for those, which "mvc" meant before'
        )


def _sees_all(outline: Outline) -> bool:
    """Whether each point inside sees all of the boundary: a convex outline, and nothing in it."""
    if len(outline.loops) > 1:
        return False
    corners = loop_polygon(outline, outline.loops[0])
    sides = np.roll(corners, -1, axis=0) - corners
    turned = np.roll(sides, -1, axis=0)
    turns = sides[:, 0] * turned[:, 1] - sides[:, 1] * turned[:, 0]
    return bool((turns >= -TURN * np.hypot(*sides.T) * np.hypot(*turned.T)).all())
