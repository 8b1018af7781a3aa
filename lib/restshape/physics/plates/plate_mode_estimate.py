"""How far the frequencies of plates are from those of a finer space, estimated from the moments of modes."""

import numpy as np

from restshape import _kernels
from restshape.fem.recovery import NodalFlux
from restshape.physics.elasticity.mode_estimate import EstimatedBody, RecoveryModeEstimate
from restshape.physics.elasticity.stiffness import plane_stress, stiffness_of


class PlateModeEstimate(RecoveryModeEstimate):
    """Of a plate, from its moments alone.

    The element does not conform, so that its frequencies come out too low or too high: this reports how much they may
    be wrong, not which way. Shear has little part in it.
    """

    def __init__(self, body: EstimatedBody) -> None:
        super().__init__(body)
        points = _kernels.recovery_points()
        # A node of a plate has its thickness as a third coordinate, which does not count here.
        self._points = np.column_stack([points, np.zeros(len(points))])
        # Of a unit of thickness.
        self._flexible = np.stack([12.0 * np.linalg.inv(plane_stress(stiffness_of(m))) for m in body.materials])

    def __call__(self, modes: np.ndarray) -> np.ndarray:
        space, found = self.body.space, []
        X, recovery = np.ascontiguousarray(space.X[:, :2]), NodalFlux(self.body.plane)
        rows, kinds = recovery.cell_rows(), np.arange(len(space.cells), dtype=np.int32)
        thickness = space.X[space.cells, 2].mean(axis=1)
        compliance = np.zeros((len(kinds), 4, 4))
        compliance[:, :3, :3] = self._flexible[space.cell_region] / thickness[:, None, None] ** 3
        for mode in modes:
            moments = self._stress(mode, self._points)
            nodal = recovery(moments.mean(axis=1))
            found.append(_kernels.recovery_energies(X, space.cells, rows, nodal, moments, compliance, kinds)[0])
        return np.array(found)
