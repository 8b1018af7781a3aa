"""How far the frequencies of plates are from those of a finer space, estimated from the moments of modes."""

from typing import Protocol

import numpy as np

from restshape import _kernels
from restshape.fem.assembled import Assembled
from restshape.fem.integral import Integral
from restshape.fem.recovery import NodalFlux
from restshape.mesh.plate import PlateMesh
from restshape.mesh.quality import areas
from restshape.physics.elasticity.mode_estimate import EstimatedBody, RecoveryModeEstimate
from restshape.physics.elasticity.stiffness import plane_stress, stiffness_of


class EstimatedPlate(EstimatedBody, Protocol):
    """What an estimate needs of a plate beside: the integral of its mass."""

    space: PlateMesh
    mass: Integral


class PlateModeEstimate(RecoveryModeEstimate):
    """Of a plate, from its moments, and from a thickness by formula that is linear over each triangle.

    The element does not conform, so that its frequencies come out too low or too high: this reports how much they may
    be wrong, not which way. Shear has little part in it.
    """

    body: EstimatedPlate

    def __init__(self, body: EstimatedPlate) -> None:
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
        return np.array(found) + self._by_thickness(modes)

    def _by_thickness(self, modes: np.ndarray) -> np.ndarray:
        """What the difference between the thickness and its interpolation does to eigenvalues (k,), to first order."""
        space = self.body.space
        if not space.thickness.varies:
            return np.zeros(len(modes))
        velocity, found = space.thickness_motion(thickness_defect(space)), []
        stiffness, mass = Assembled([self.body.stiffness]), Assembled([self.body.mass])
        for mode in modes:
            x = np.ascontiguousarray(mode.reshape(-1, len(self.body.axes)))
            value = float((x * stiffness.residual(x)).sum())
            rate = stiffness.design_product(x, velocity) - value * mass.design_product(x, velocity)
            found.append(abs(float((x * rate).sum())))
        return np.array(found)


def thickness_defect(space: PlateMesh) -> np.ndarray:
    """How much thicker (n,) [m] a plate is around each node than the triangles there, on average over these.

    The mean over a triangle by the middles of its sides, which is exact for a quadratic.
    """
    corners = space.X[space.cells, :2]
    middles = 0.5 * (corners + np.roll(corners, -1, axis=1))
    there = space.thickness.at(middles.reshape(-1, 2)).reshape(-1, 3).mean(axis=1)
    defect = there - space.thickness.at(space.X[:, :2])[space.cells].mean(axis=1)
    size = areas(np.ascontiguousarray(space.X[:, :2]), space.cells)
    share = [np.bincount(space.cells.ravel(), np.repeat(own, 3), len(space.X)) for own in (size * defect, size)]
    return np.asarray(share[0] / share[1])
