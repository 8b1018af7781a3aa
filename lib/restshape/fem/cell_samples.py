"""Values of a scene inside of cells, at the quadrature points where elements take them."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from restshape import _kernels
from restshape.fem.entity_sets import cells_on
from restshape.fem.nodal_values import Nodal, varies
from restshape.fem.space import Space
from restshape.mesh.quadratic_basis import quadratic_basis
from restshape.scene.expressions import Value


class Given(NamedTuple):
    """A scalar value of a scene on regions.

    Args:
        where: its key in the scene, for messages.
        on: names of the regions.
        value: number or expression of the place.
    """

    where: str
    on: Sequence[str]
    value: Value


class CellValues:
    """The sum of values on regions at the quadrature points of triangles: the centroid, or three of second order.

    Args:
        space: in the plane; its nodes may move.
        given: what is summed.
        parameters: of the scene, for expressions.

    Attributes:
        points: in a cell; varies: whether a value changes when nodes move.
    """

    def __init__(self, space: Space, given: Sequence[Given], parameters: dict[str, float]) -> None:
        self.space, self.given, self.parameters = space, tuple(given), parameters
        second = space.cells.shape[1] == 6
        self._basis = quadratic_basis(_kernels.recovery_points())[0] if second else np.full((1, 3), 1 / 3)
        self.points = len(self._basis)
        self.varies = any(varies(one.value) for one in self.given)

    def __call__(self) -> np.ndarray:
        """The values (ne, points) where the nodes are now."""
        return self._sum(None)

    def rates(self, dX: np.ndarray) -> np.ndarray:
        """Rates (ne, points) of the values when nodes move with dX (n, 2)."""
        return self._sum(dX)

    def _sum(self, dX: np.ndarray | None) -> np.ndarray:
        out = np.zeros((len(self.space.cells), self.points))
        for where, on, value in self.given:
            cells, nodal = cells_on(self.space, on), Nodal(value, self.parameters, where)
            fields = [self._sampled(field, cells) for field in (self.space.X, dX) if field is not None]
            values = nodal if dX is None else nodal.rate
            out[cells] += np.stack([values(*at) for at in zip(*fields)], axis=1)
        return out

    def _sampled(self, field: np.ndarray, cells: np.ndarray) -> np.ndarray:
        """A field (n, d) at the points (points, k, d) of cells (k,)."""
        return np.einsum("qi,eik->qek", self._basis, field[self.space.cells[cells]])
