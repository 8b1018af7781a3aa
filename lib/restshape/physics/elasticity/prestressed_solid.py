"""Plane solids whose prebuckling stress changes their stiffness, as buckling wants it."""

from collections.abc import Mapping
from functools import cached_property

import numpy as np

from restshape import _kernels
from restshape.fem.elements import GEOMETRIC, GEOMETRIC_DILATATION
from restshape.fem.integral import Integral
from restshape.fem.observer import Observer
from restshape.physics.elasticity.plane_solid import PlaneSolid
from restshape.scene.model import Quantity


# More than 15 attributes: those of a solid, and what its load factors share.
class PrestressedSolid(PlaneSolid):
    """A linear static solid that knows the geometric stiffness of its displacements.

    Arguments as in `PlaneSolid`.

    Source: docs/theory/buckling.md.
    """

    def geometric_stiffness(self, u: np.ndarray, factor: float = 1.0) -> Integral:
        """G of a displacement u (n, 2) [m]: phi . G phi = int sigma(u) : grad(phi)^T grad(phi), linear in u.

        Args:
            u: is read now.
            factor: of G.
        """
        cells = self.space.cells
        nodes = cells.shape[1]
        # Moduli, thickness, u at the nodes of each cell.
        parameters = np.empty((len(cells), 3 + 2 * nodes))
        parameters[:, :3] = self.stiffness_params[..., :3]
        parameters[:, 3:] = u[cells].reshape(len(cells), 2 * nodes)
        return Integral(self._geometric, self.space.X, cells, parameters, factor)

    @cached_property
    def _geometric(self) -> _kernels.Element:
        return (GEOMETRIC_DILATATION if self.averaged else GEOMETRIC)[self.element.shape]

    def observer(self, quantities: Mapping[str, Quantity]) -> Observer:
        """What evaluates those quantities that the displacement gives; load factors are the analysis's to report."""
        return super().observer({name: q for name, q in quantities.items() if q.load_factor is None})
