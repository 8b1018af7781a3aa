"""Samples of a drag on the nodes of a new mesh, or on nodes that flips have moved."""

from __future__ import annotations

import logging
from typing import TYPE_CHECKING, Protocol

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


class NodalValues(Protocol):
    """What knows which fields at the nodes of a mesh values and derivatives hold: an `analysis.Predictor`."""

    def nodal_fields(self, rows: Reals, nodes: int) -> Reals | None: ...
    def with_nodal_fields(self, rows: Reals, fields: Reals) -> Reals: ...


def can_be_projected(space: Space | None) -> bool:
    """Whether fields at the nodes of a space can be interpolated at others."""
    return space is not None and space.cell_type in PLANE


class LeftSamples:
    """Samples whose nodes a frame takes elsewhere, as these lie in the middle of that frame.

    Args:
        samples: of fields at the nodes of a mesh of triangles.
        values: knows these fields.
        aligned: values of the solution whose basis all samples have.
        space: the mesh before, or its nodes of second order.
        frame: in which others take their place; former: the frame before.
    """

    def __init__(
        self,
        samples: DragSamples,
        values: NodalValues,
        aligned: Reals,
        space: Space,
        frame: ScriptFrame,
        former: ScriptFrame,
    ) -> None:
        self.samples, self.space, self.frame = samples, space, frame
        self._values, self._aligned, self._nodes = values, aligned, len(space.X)
        self._interpolations = space.interpolations
        # Where triangles have inverted, the mesh before lies on the shape before.
        self._c = frame.c if _lies_on(space, frame) else former.c

    def projected(self, space: Space, motion: Reals) -> tuple[DragSamples, Reals] | None:
        """The samples on the nodes of now, by barycentric coordinates in the mesh before, and `aligned` on these.

        Flips leave the nodes, but those of second order at the middles of sides.

        Args:
            space: the nodes of now.
            motion: (2, m, d) displacements of them a unit of each of the hand's coefficients.

        Returns:
            None where values are of other nodes.

        Source: docs/theory/design-derivative.md; 5.1.4 of the thesis.
        """
        write = self._flip
        if space is not self.space:
            back = self._c[0] - self.frame.c[0], self._c[1] - self.frame.c[1]
            write = Transfer(self.space, space.X + back[0] * motion[0] + back[1] * motion[1]).rows

        def rows_there(rows: Reals) -> Reals | None:
            fields = self._values.nodal_fields(rows, self._nodes)
            if fields is None:
                return None
            there = np.empty((len(fields), len(space.X), fields.shape[2]))
            write(np.ascontiguousarray(fields), there)
            return self._values.with_nodal_fields(rows, there)

        aligned = rows_there(self._aligned[None])
        if aligned is None:
            return None
        log.info("%4d %s projected", self.frame.index, counted(len(self.samples), "sample"))
        return self.samples.projected(rows_there), aligned[0]

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
