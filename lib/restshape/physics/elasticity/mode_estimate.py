"""How far frequencies are from those of a finer mesh, estimated from the stresses of modes."""

from abc import ABC, abstractmethod

import numpy as np

from restshape import _kernels
from restshape.physics.elasticity.stiffness import plane_strain, plane_stress, stiffness_of
from restshape.fem.error_estimate import NO_KINDS
from restshape.physics.elasticity.vibrating_body import Oscillator, PlaneOscillator, PlateOscillator, SolidOscillator, plain_thickness
from restshape.fem.recovery import NodalFlux

COMPONENTS = [0, 1, 5, 2, 3, 4]
"""Rows of Voigt's order for stresses xx, yy, xy, zz, yz, xz."""


class ModeEstimate(ABC):
    """The recovery-based estimate of the errors of modes: their squares in the energy norm.

    Args:
        body: what vibrates; its mesh is kept by reference.

    Source: docs/theory.md, section 9.
    """

    def __init__(self, body: Oscillator) -> None:
        self.body = body

    @abstractmethod
    def __call__(self, modes: np.ndarray) -> np.ndarray:
        """The estimated errors (k,) of eigenvalues of K phi = lambda M phi, of modes (k, n f) with phi M phi = 1."""

    def _stress(self, mode: np.ndarray, points: np.ndarray | None) -> np.ndarray:
        """Stresses (ne, m, c) [Pa] of the cells at reference points, or (ne, c) at centroids."""
        body, cells = self.body, self.body.mesh.cells
        phi, components = np.ascontiguousarray(mode.reshape(-1, body.fields)), body.stiffness.stress_components
        out = np.empty((len(cells), components) if points is None else (len(cells), len(points), components))
        body.stiffness.stress(body.mesh.X, phi, cells, body.stiffness_params, out, points)
        return out


class PlaneModeEstimate(ModeEstimate):
    """Of a solid in the plane, whose stresses are recovered as at rest."""

    def __init__(self, body: PlaneOscillator) -> None:
        super().__init__(body)
        self.recovery = NodalFlux(body.mesh)
        law = plane_stress if body.stress else plane_strain
        self._compliance = np.zeros((len(body.materials), 4, 4))
        for row, m in zip(self._compliance, body.materials):
            row[:3, :3] = np.linalg.inv(law(stiffness_of(m))) * plain_thickness(m)
        self._kinds = body.mesh.cell_region if len(self._compliance) > 1 else NO_KINDS

    def __call__(self, modes: np.ndarray) -> np.ndarray:
        mesh, recovery, found = self.body.mesh, self.recovery, []
        rows = recovery.cell_rows()
        for mode in modes:
            stress = self._stress(mode, recovery.points)
            nodal = recovery(stress)
            found.append(
                _kernels.recovery_energies(mesh.X, mesh.cells, rows, nodal, stress, self._compliance, self._kinds)[0]
            )
        return np.array(found)


class SolidModeEstimate(ModeEstimate):
    """Of a body of tetrahedra, on each region by itself."""

    def __init__(self, body: SolidOscillator) -> None:
        super().__init__(body)
        flexible = [np.linalg.inv(stiffness_of(m)) for m in body.materials]
        self._compliance = np.stack([C[np.ix_(COMPONENTS, COMPONENTS)] for C in flexible])
        self._points = _kernels.space_recovery_points() if body.mesh.cells.shape[1] == 10 else None

    def __call__(self, modes: np.ndarray) -> np.ndarray:
        mesh, total = self.body.mesh, np.zeros(len(modes))
        stress = np.stack([self._stress(mode, self._points) for mode in modes])
        region = mesh.cell_region
        for kind in np.unique(region):
            own = slice(None) if len(self._compliance) == 1 else np.flatnonzero(region == kind)
            cells, samples = (np.ascontiguousarray(part) for part in (mesh.cells[own], stress[:, own]))
            nodal = np.empty((len(modes), len(mesh.X), 6))
            _kernels.recover_space(mesh.X, cells, samples, nodal)
            C = self._compliance[kind : kind + 1]
            for k in range(len(modes)):
                total[k] += _kernels.recovery_energies(mesh.X, cells, cells, nodal[k], samples[k], C, NO_KINDS)[0]
        return total


class PlateModeEstimate(ModeEstimate):
    """Of a plate, from its moments alone.

    The element does not conform, so that its frequencies come out too low or too high: this tells how much they may be
    wrong, not which way. Shear has little part in it.
    """

    def __init__(self, body: PlateOscillator) -> None:
        super().__init__(body)
        points = _kernels.recovery_points()
        # A node of a plate has its thickness as a third coordinate, which does not count here.
        self._points = np.column_stack([points, np.zeros(len(points))])
        # Of a unit of thickness.
        self._flexible = np.stack([12.0 * np.linalg.inv(plane_stress(stiffness_of(m))) for m in body.materials])

    def __call__(self, modes: np.ndarray) -> np.ndarray:
        mesh, found = self.body.mesh, []
        X, recovery = np.ascontiguousarray(mesh.X[:, :2]), NodalFlux(self.body.plane)
        rows, kinds = recovery.cell_rows(), np.arange(len(mesh.cells), dtype=np.int32)
        thickness = mesh.X[mesh.cells, 2].mean(axis=1)
        compliance = np.zeros((len(kinds), 4, 4))
        compliance[:, :3, :3] = self._flexible[mesh.cell_region] / thickness[:, None, None] ** 3
        for mode in modes:
            moments = self._stress(mode, self._points)
            nodal = recovery(moments.mean(axis=1))
            found.append(_kernels.recovery_energies(X, mesh.cells, rows, nodal, moments, compliance, kinds)[0])
        return np.array(found)


def estimate_of(body: Oscillator) -> ModeEstimate:
    """The estimate that suits a body."""
    made = {PlateOscillator: PlateModeEstimate, SolidOscillator: SolidModeEstimate, PlaneOscillator: PlaneModeEstimate}
    return made[type(body)](body)
