"""How far a solid's displacement is from that of a finer mesh, estimated from its stresses."""

import numpy as np

from restshape import _kernels
from restshape.fem.recovery import NodalStress
from restshape.physics.elasticity.plane_solid import PlaneSolid

CARRIED = 1e-10
"""Strains below this share of the displacement over the body's size are rounding: where supports only carry it."""

NO_KINDS = np.empty(0, dtype=np.int32)


class SolidEstimate:
    """The recovery-based estimate of a plane solid, of small or large strains, order 1 or 2, one material or several.

    Stresses are recovered at nodes, on each region by itself, interpolated, and compared with those of the cells in the
    complementary energy of the small strain law. Of large strains they are those of Piola and Kirchhoff of the second
    kind, so that the norm is that of Green's strain in the law's own energy.

    Args:
        physics: the solid; its mesh is kept by reference: nodes may move, edges may flip inside regions.

    Source: docs/theory.md, section 9; Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 24 (1987) 337.
    """

    def __init__(self, physics: PlaneSolid) -> None:
        self.physics, self.mesh = physics, physics.mesh
        self.recovery = NodalStress(self.mesh)
        # Stresses of first order are constant in a cell.
        second = self.recovery.points is not None
        self._points = _kernels.estimate_points(self.mesh.cells.shape[1]) if second else None
        lame, shear, thickness, _ = physics.materials.T
        self._compliance = plane_compliance(lame, shear, thickness)
        self._kinds = self.mesh.cell_region if len(self._compliance) > 1 else NO_KINDS

    def relative(self, x: np.ndarray) -> float:
        """The estimated error of a displacement x (n, 2) [m] over its size, both in the energy norm.

        Not a number where there is no stress.
        """
        sampled = self._stress(x, self.recovery.points)
        stress = sampled if self._points is None else self._stress(x, self._points)
        error, size = self._energies(self.recovery.cell_rows(), self.recovery(sampled), stress)
        return self._ratio(error, size, x)

    def distance(self, x: np.ndarray, reference: np.ndarray) -> float:
        """The distance of two displacements (n, 2) [m] over the size of the second, in the same norm."""
        stress = self._stress(reference, self._points)
        size, error = self._norm(stress), self._norm(self._stress(x, self._points) - stress)
        return self._ratio(error, size, reference)

    def _ratio(self, error: float, size: float, x: np.ndarray) -> float:
        rounding = self.physics.stiffest * (CARRIED * float(np.abs(x).max(initial=0.0))) ** 2
        return float(np.sqrt(error / size)) if size > rounding else float("nan")

    def _norm(self, stress: np.ndarray) -> float:
        """Twice the complementary energy [J] of stresses of the cells."""
        return self._energies(np.zeros_like(self.mesh.cells), np.zeros((1, 4)), stress)[1]

    def _energies(self, rows: np.ndarray, nodal: np.ndarray, stress: np.ndarray) -> tuple[float, float]:
        mesh = self.mesh
        return _kernels.recovery_energies(mesh.X, mesh.cells, rows, nodal, stress, self._compliance, self._kinds)

    def _stress(self, x: np.ndarray, points: np.ndarray | None) -> np.ndarray:
        """Stresses (ne, m, 4) [Pa] as the norm takes them, or (ne, 4) at centroids; zz is not looked at."""
        physics, mesh = self.physics, self.mesh
        shape = (len(mesh.cells), 4) if points is None else (len(mesh.cells), len(points), 4)
        out, x = np.empty(shape), np.ascontiguousarray(x)
        physics.element.stress(mesh.X, x, mesh.cells, physics.stiffness_params, out, points)
        if physics.law == "stvk":
            _kernels.pull_back(mesh.X, x, mesh.cells, np.full((1, 2), 1 / 3) if points is None else points, out)
        return out


def plane_compliance(lame: np.ndarray, shear: np.ndarray, thickness: np.ndarray) -> np.ndarray:
    """Compliances (k, 4, 4) [m^3/N] of stresses xx, yy, xy, zz integrated over the thickness, from plane moduli (k,).

    The stress along the normal has no part in it: it follows from the others, or does no work.

    Args:
        lame: lambda [Pa], that of plane stress where that is meant; shear: mu [Pa].
        thickness: [m].
    """
    out = np.zeros((len(lame), 4, 4))
    out[:, 0, 0] = out[:, 1, 1] = (lame + 2.0 * shear) / (4.0 * shear * (lame + shear))
    out[:, 0, 1] = out[:, 1, 0] = -lame / (4.0 * shear * (lame + shear))
    out[:, 2, 2] = 1.0 / shear
    return out * thickness[:, None, None]
