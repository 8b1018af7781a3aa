"""How far frequencies are from those of a finer space, estimated from the stresses of modes."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from typing import Protocol

import numpy as np

from restshape import _kernels
from restshape.fem.error_estimate import NO_KINDS
from restshape.fem.integral import Integral
from restshape.fem.recovery import NodalFlux
from restshape.fem.space import Space
from restshape.physics.elasticity.free_faces import FreeFaces
from restshape.physics.elasticity.stiffness import plane_strain, plane_stress, stiffness_of
from restshape.physics.elasticity.vibrating_materials import constant_thickness
from restshape.scene.model import Material

COMPONENTS = [0, 1, 5, 2, 3, 4]
"""Rows of Voigt's order for stresses xx, yy, xy, zz, yz, xz."""


class EstimatedBody(Protocol):
    """What an estimate needs of a body that vibrates.

    Attributes:
        space: nodes and cells of the unknowns; plane: the mesh that it is over.
        axes: names of the unknowns of a node.
        materials: of each region of the plane mesh.
        stiffness: integral of the cells.
    """

    space: Space
    plane: Space
    axes: tuple[str, ...]
    materials: Sequence[Material]
    stiffness: Integral


class RecoveryModeEstimate(ABC):
    """The recovery-based estimate of the errors of modes: their squares in the energy norm.

    Args:
        body: what vibrates; kept by reference.

    Source: docs/theory/error-estimates.md.
    """

    def __init__(self, body: EstimatedBody) -> None:
        self.body = body

    @abstractmethod
    def __call__(self, modes: np.ndarray) -> np.ndarray:
        """The estimated errors (k,) of eigenvalues of K phi = lambda M phi, of modes (k, n f) with phi M phi = 1."""

    def _stress(self, mode: np.ndarray, points: np.ndarray | None) -> np.ndarray:
        """Stresses (ne, m, c) [Pa] of the cells at reference points, or (ne, c) at centroids."""
        return self.body.stiffness.stress(np.ascontiguousarray(mode.reshape(-1, len(self.body.axes))), points)


class PlaneModeEstimate(RecoveryModeEstimate):
    """Of a solid in the plane, whose stresses are recovered as at rest.

    Args:
        body: what vibrates; kept by reference.
        stress: plane stress, else plane strain.
    """

    def __init__(self, body: EstimatedBody, stress: bool) -> None:
        super().__init__(body)
        self.recovery = NodalFlux(body.space)
        law = plane_stress if stress else plane_strain
        self._compliance = np.zeros((len(body.materials), 4, 4))
        for row, m in zip(self._compliance, body.materials):
            row[:3, :3] = np.linalg.inv(law(stiffness_of(m))) * constant_thickness(m)
        self._kinds = body.space.cell_region if len(self._compliance) > 1 else NO_KINDS

    def __call__(self, modes: np.ndarray) -> np.ndarray:
        space, recovery, found = self.body.space, self.recovery, []
        rows = recovery.cell_rows()
        for mode in modes:
            stress = self._stress(mode, recovery.points)
            nodal = recovery(stress)
            found.append(
                _kernels.recovery_energies(space.X, space.cells, rows, nodal, stress, self._compliance, self._kinds)[0]
            )
        return np.array(found)


class SolidModeEstimate(RecoveryModeEstimate):
    """Of a body of tetrahedra, on each region by itself."""

    def __init__(self, body: EstimatedBody) -> None:
        super().__init__(body)
        self._faces = FreeFaces(body.space, body.boundary)
        flexible = [np.linalg.inv(stiffness_of(m)) for m in body.materials]
        self._compliance = np.stack([C[np.ix_(COMPONENTS, COMPONENTS)] for C in flexible])
        self._points = _kernels.space_recovery_points() if body.space.cells.shape[1] == 10 else None

    def __call__(self, modes: np.ndarray) -> np.ndarray:
        space, total = self.body.space, np.zeros(len(modes))
        stress = np.stack([self._stress(mode, self._points) for mode in modes])
        region = space.cell_region
        whole = len(self._compliance) == 1
        for kind in [0] if whole else np.unique(region):
            own = slice(None) if whole else np.flatnonzero(region == kind)
            cells, samples = (np.ascontiguousarray(part) for part in (space.cells[own], stress[:, own]))
            nodal = np.empty((len(modes), len(space.X), 6))
            _kernels.recover_space(space.X, cells, samples, nodal)
            self._faces.remove_tractions(nodal)
            C = self._compliance[kind : kind + 1]
            for k in range(len(modes)):
                total[k] += _kernels.recovery_energies(space.X, cells, cells, nodal[k], samples[k], C, NO_KINDS)[0]
        return total
