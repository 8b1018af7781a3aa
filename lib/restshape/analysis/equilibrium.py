"""The equations of a solid at rest under dead loads and pressures that follow its boundary."""

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.operator import Operator
from restshape.algebra.stages import Stages
from restshape.physics.elasticity.plane_solid import PlaneSolid


class Equilibrium:
    """Internal less applied forces as a function of the displacement, as `algebra.newton` wants them.

    Args:
        physics: on a mesh whose nodes may move.
        operator: on its cells, and on the facets of each of its followers.
        stages: takes the time of values.

    Source: docs/theory.md, section 2.
    """

    def __init__(self, physics: PlaneSolid, operator: Operator, stages: Stages) -> None:
        self.physics, self.operator, self.stages = physics, operator, stages
        self.potential, self.held = not physics.followers, physics.constrained
        self.dead, self.rest = np.zeros_like(physics.mesh.X), np.zeros_like(physics.mesh.X)
        self.free = np.where(physics.mask.reshape(self.dead.shape), 0.0, 1.0)
        # The part of the pressures that is on: they follow the boundary, so that no dead load takes them away.
        self._pressed, self._changes = 1.0, 0
        self._own: tuple[int, np.ndarray | None] = (-1, None)

    @property
    def version(self) -> tuple[int, int]:
        """Another one whenever forces or tangent may be others at the same displacement."""
        return self._changes, self.operator.version

    @property
    def pressed(self) -> float:
        """The part of the pressures that is on."""
        return self._pressed

    @pressed.setter
    def pressed(self, part: float) -> None:
        self._pressed, self._changes = part, self._changes + 1

    def begin(self) -> None:
        """Evaluate the dead loads on the mesh as it lies now."""
        self._changes += 1
        physics = self.physics
        if physics.tractions or physics.forces or physics.nodal_bodies:
            physics.loads(self.dead)

    def load(self) -> np.ndarray:
        """All loads (n, 2) [N] on the shape at rest."""
        return -self.whole_residual(self.rest)

    def residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set this rank's rows of `out` (n, 2) [N] to the forces out of balance at the displacement x (n, 2) [m]."""
        with self.stages("values"):
            self._residual(x, out, self._own_cells())

    def whole_residual(self, x: np.ndarray) -> np.ndarray:
        """The forces out of balance (n, 2) [N] at all nodes."""
        out = np.empty_like(self.dead)
        self._residual(x, out, None)
        return out

    def assemble(self, x: np.ndarray, out: np.ndarray | None) -> PETSc.Mat:
        """The tangent stiffness at x (n, 2) [m]; `out` as in `residual`, in the same pass."""
        with self.stages("values"):
            if out is not None:
                np.negative(self.dead, out=out)
            return self.operator.assemble(self.terms(x), None if out is None else out.ravel())

    def terms(self, x: np.ndarray) -> list[tuple]:
        """What the operator assembles at x (n, 2) [m]; the residual is added to the right side."""
        physics, X = self.physics, self.physics.mesh.X
        terms = [(0, physics.element, X, x, physics.params, 1.0, -1.0)]
        for block, (_, params) in enumerate(physics.pressures(self.pressed), 1):
            terms.append((block, physics.pressure, X, x, params, 1.0, -1.0))
        return terms

    def energy(self, x: np.ndarray) -> float:
        """Strain energy less the work of the dead loads [J], of the whole body on each rank."""
        physics = self.physics
        cells = physics.element.energy(physics.mesh.X, x, physics.mesh.cells, physics.params)
        return float(cells.sum() - np.vdot(self.dead, x))

    def inverted_cells(self, x: np.ndarray) -> np.ndarray:
        """Cells (k,) that the displacement x (n, 2) [m] turns inside out, wholly or in part."""
        return _kernels.inverted_cells(self.physics.mesh.X, x, self.physics.mesh.cells)

    def _residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None) -> None:
        physics = self.physics
        np.negative(self.dead, out=out)
        physics.element.residual(physics.mesh.X, x, physics.mesh.cells, physics.params, out, subset)
        for facets, params in physics.pressures(self.pressed):
            physics.pressure.residual(physics.mesh.X, x, facets, params, out)
        out *= self.free

    def _own_cells(self) -> np.ndarray | None:
        """The cells around this rank's nodes; None where these are all."""
        if self.operator.comm.size == 1:
            return None
        topology = self.physics.mesh.topology
        if self._own[0] != topology:
            rows = self.operator.rows
            nodes = np.arange(rows.start // 2, rows.stop // 2, dtype=np.int32)
            self._own = (topology, self.physics.cells_around(nodes))
        return self._own[1]
