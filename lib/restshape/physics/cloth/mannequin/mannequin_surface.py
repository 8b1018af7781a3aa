"""A mannequin: the closed surface of a body with given measures."""

from __future__ import annotations

import numpy as np

from restshape.outputs.kinds import BODY_MARK
from restshape.physics.cloth.mannequin.body_mesh import body_mesh, obj_text
from restshape.physics.cloth.mannequin.body_shape import BodyShape
from restshape.scene.body_sizes import Sizes

ROOM = 2.5
"""Cells of the grid around the body."""
WIDE, DEEP = 0.6, 0.2
"""Half of the box that holds the body, over its height, besides its hip: across and from front to back."""


class Mannequin:
    """The surface of a body, which stands on z = 0 and faces -y.

    Args:
        sizes: all of them, see `Sizes.completed`.
        size: of triangles [m].

    Raises:
        UserError: no body has these sizes.
    """

    def __init__(self, sizes: Sizes, size: float) -> None:
        self.sizes, self.shape = sizes, BodyShape(sizes)
        reach = np.array([WIDE * sizes.height, DEEP * max(sizes.height, sizes.hip, sizes.bust, sizes.waist), 0.0])
        # Half a cell beside the plane of symmetry none of its places is a node of the grid.
        low = -reach - ROOM * size
        high = reach + [0.0, 0.0, sizes.height] + ROOM * size
        self.nodes, self.triangles = body_mesh(self.shape, low, high, size)

    def level(self, name: str) -> float:
        """The height [m] at which a measure holds."""
        return self.shape.level(name)

    def obj_text(self) -> str:
        """The surface as an OBJ file in metres."""
        sizes = ", ".join(f"{name} {100 * getattr(self.sizes, name):.1f} cm" for name in self.sizes.names)
        return obj_text(self.nodes, self.triangles, f"{BODY_MARK}: {sizes}")
