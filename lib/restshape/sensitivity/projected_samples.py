"""Samples of a drag on the nodes of a new mesh, or on nodes that flips have moved."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING

import numpy as np

from restshape.mesh.transfer import Transfer
from restshape.outputs.si_numbers import counted

if TYPE_CHECKING:
    from restshape.arrays import Reals
    from restshape.fem.space import Space
    from restshape.sensitivity.samples import DragSamples
    from restshape.shape.script_frame import ScriptFrame

log = logging.getLogger("restshape.replay")

PLANE = ("tri3", "tri6")
"""Types of cells whose nodal fields are projected to other nodes."""
NEARLY = 1e-9
"""Part of the size of a shape up to which corners of a mesh lie on it."""


def nodal(samples: DragSamples, space: Space | None) -> bool:
    """Whether the values of samples are fields at the nodes of a mesh of triangles."""
    return space is not None and space.cell_type in PLANE and samples.shape[:1] == (len(space.X),)


class LeftSamples:
    """Samples whose nodes a frame takes elsewhere, as these lie in the middle of that frame.

    Args:
        samples: of which values are `nodal`.
        space: the mesh before, or its nodes of second order.
        frame: in which others take their place; former: the frame before.
    """

    def __init__(self, samples: DragSamples, space: Space, frame: ScriptFrame, former: ScriptFrame) -> None:
        self.samples, self.space, self.frame = samples, space, frame
        self._interpolations = space.interpolations
        # Where triangles have inverted, the mesh before lies on the shape before.
        self._c = frame.c if _lies_on(space, frame) else former.c

    def projected(self, space: Space, motion: Reals) -> DragSamples:
        """The samples on the nodes of now, by barycentric coordinates in the mesh before.

        Flips leave the nodes, but those of second order at the middles of sides.

        Args:
            space: the nodes of now.
            motion: (2, m, d) displacements of them a unit of each of the hand's coefficients.

        Source: docs/theory/design-derivative.md; 5.1.4 of the thesis.
        """
        log.info("%4d %s projected", self.frame.index, counted(len(self.samples), "sample"))
        shape = len(space.X), *self.samples.shape[1:]
        if space is self.space:
            return self.samples.projected(self._flip, shape)
        back = self._c[0] - self.frame.c[0], self._c[1] - self.frame.c[1]
        points = space.X + back[0] * motion[0] + back[1] * motion[1]
        return self.samples.projected(Transfer(self.space, points).rows, shape)

    def _flip(self, rows: Reals, out: Reals) -> None:
        """Write fields (count, n, f) after flips, of nodes at the middles of sides."""
        for row, to in zip(rows, out):
            to[...] = self.space.interpolate(row, self._interpolations)


def _lies_on(space: Space, frame: ScriptFrame) -> bool:
    """Whether the vertices of a mesh are where those of a frame's outline are."""
    outline, nodes = frame.outline, space.mesh.vertex_node
    if outline is None:
        return True
    places = outline.points[: len(nodes)][nodes >= 0]
    return bool(np.abs(space.X[nodes[nodes >= 0]] - places).max(initial=0.0) < NEARLY * outline.size)
