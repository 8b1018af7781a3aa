"""How far the strains of cloth are from those of a finer mesh, estimated from its tensions and curvatures."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from restshape import _kernels
from restshape.fem.recovery import NodalFlux
from restshape.mesh.mesh import Mesh
from restshape.mesh.morley import MorleySpace
from restshape.physics.cloth.sheet.fabric import Fabric
from restshape.physics.cloth.sheet.patch_curvature import PatchCurvature

NO_KINDS = np.empty(0, dtype=np.int32)
ROUNDING = 1e-10
"""Strain below which cloth is not strained but by rounding."""


class EstimatedCloth(Protocol):
    """What an estimate needs of cloth.

    Attributes:
        mesh: of its corners; morley: the space of Morley's triangles, None where there are none.
        fabric: stiffness and mass.
        bending: None where nothing resists it.
    """

    mesh: Mesh
    morley: MorleySpace | None
    fabric: Fabric
    bending: object | None

    def corners(self, x: np.ndarray) -> np.ndarray:
        """Positions (corners, 3) [m] of the mesh's nodes."""

    def tensions(self, x: np.ndarray) -> np.ndarray:
        """Second Piola-Kirchhoff tensions (ne, 3) xx, yy, xy [N/m] of the triangles at x (n, 3)."""

    def membrane_energy(self, x: np.ndarray) -> float:
        """Energy [J] of stretching at x (n, 3)."""

    def bending_energy(self, x: np.ndarray) -> float:
        """Energy [J] of bending at x (n, 3)."""

    def bending_energies(self, x: np.ndarray) -> np.ndarray:
        """Energy (ne,) [J] of bending of each triangle at x (n, 3)."""


class ClothEstimate:
    """The recovery-based estimate of cloth: tensions and moments against smoother ones, in the energy norm.

    Hinges have no curvatures: theirs are those of surfaces fitted to the nodes around each triangle. They are also too
    stiff or too soft by what the mesh makes of them, which no smoothness shows; but the energies of hinges and of these
    curvatures differ by that, and where loads decide on the moments curvatures are off by as much.

    Args:
        problem: the cloth; its mesh is kept by reference: nodes may move, after `update`.

    Source: docs/theory/error-estimates.md; Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 24 (1987) 337.
    """

    def __init__(self, problem: EstimatedCloth) -> None:
        self.problem = problem
        self.recovery, self._geometry = NodalFlux(problem.mesh), -1
        self.update()

    def update(self) -> None:
        """Take in where the nodes of the mesh are now, if they have moved."""
        mesh = self.problem.mesh
        if self._geometry == mesh.geometry:
            return
        self._geometry = mesh.geometry
        a, b, c = mesh.X[mesh.cells].swapaxes(0, 1)
        u, v = b - a, c - a
        self.area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        hinged = self.problem.bending is not None and self.problem.morley is None
        self._patches = PatchCurvature(mesh.X, mesh.cells) if hinged else None

    def curvatures(self, x: np.ndarray) -> np.ndarray:
        """Second derivatives (ne, 3, 3) xx, yy and twice xy of each coordinate at x (n, 3); 0 of what does not bend."""
        if self._patches:
            return self._patches(self.problem.corners(x))
        morley = self.problem.morley
        return morley.curvatures(x) if morley else np.zeros((len(self.area), 3, 3))

    def relative(self, x: np.ndarray) -> float:
        """The estimated error over the strain energy's norm at x (n, 3); not a number where nothing is strained."""
        problem, fabric = self.problem, self.problem.fabric
        energy = problem.membrane_energy(x) + problem.bending_energy(x)
        if not energy > fabric.membrane.max() * self.area.sum() * ROUNDING**2:
            return float("nan")
        wrong = self._distance(problem.tensions(x), fabric.membrane)
        if problem.bending:
            D = np.broadcast_to(fabric.bending, (len(self.area), 3, 3))
            curvatures = self.curvatures(x)
            for moments in np.einsum("eij,eaj->aei", D, curvatures):
                wrong += self._distance(moments, fabric.bending)
            if self._patches:
                wrong += self._off(0.5 * self.area * np.einsum("eai,eij,eaj->e", curvatures, D, curvatures), x)
        return float(np.sqrt(wrong / (2.0 * energy)))

    def _distance(self, tensions: np.ndarray, stiffness: np.ndarray) -> float:
        """Twice the energy [J] of recovered tensions, or moments, less those of the triangles (ne, 3)."""
        mesh, recovery = self.problem.mesh, self.recovery
        kinds, compliance = NO_KINDS, np.zeros((1, 4, 4))
        if stiffness.ndim == 3:
            # The cells of a region are of one material, with one grain in each panel.
            pieces = mesh.cell_piece
            places = mesh.cell_region * (pieces.max() + 1) + pieces
            _, first, kinds = np.unique(places, return_index=True, return_inverse=True)
            kinds, stiffness = kinds.astype(np.int32), stiffness[first]
            compliance = np.zeros((len(first), 4, 4))
        # What does not resist bending has no moments.
        compliance[:, :3, :3] = np.linalg.pinv(stiffness, hermitian=True)
        # A fourth component, the stress normal to the plane, is none.
        sampled = np.zeros((len(tensions), 4))
        sampled[:, :3] = tensions
        nodal, rows = recovery(sampled), recovery.cell_rows()
        return _kernels.recovery_energies(mesh.X, mesh.cells, rows, nodal, sampled, compliance, kinds)[0]

    def _off(self, smooth: np.ndarray, x: np.ndarray) -> float:
        """Twice the energy [J] that hinges have wrong by their stiffness, of curvatures of energies `smooth` (ne,)."""
        around, hinged = (self._patches.sums(energy) for energy in (smooth, self.problem.bending_energies(x)))
        # No more than all of it: where hinges hardly bend, their stiffness cannot be determined.
        off = np.minimum(np.abs(around - hinged), hinged)
        share = np.divide(off, hinged, out=np.zeros_like(off), where=hinged > 0.0)
        return float(2.0 * smooth @ share**2)
