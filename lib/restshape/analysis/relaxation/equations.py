"""The equations of cloth as SNES wants them, on operators whose pattern and bending stiffness are kept."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.algebra.stages import Stages
from restshape.physics.cloth.sheet import Sheet

HELD_UP = 0.02
"""Inertia of the tangent of descents, over that of a pendulum as long as the cloth, g/L: without any, cloth that lies
loosely has motions that nothing resists."""
WEIGHTLESS = 1.0
"""The same inertia [1/s^2] where there is no weight."""


class Assembly:
    """A matrix of a sheet, anew for each place of it, with the pattern and the constant terms kept.

    Args:
        sheet: whose nodes may move, and whose membrane may be softened.
        comm: PETSc communicator.
        stages: takes the times of patterns and values.
        backend: of the operator.
    """

    def __init__(self, sheet: Sheet, comm: PETSc.Comm, stages: Stages, backend: str | None) -> None:
        self.stages, self.sheet, self.operator = stages, sheet, Operator(comm, 3, sheet.node_offsets, backend)
        self.patterned = False
        self.begin()

    def begin(self) -> None:
        """Take in that nodes, stiffness or supports have changed."""
        self.current = False

    def matrix(self, x: np.ndarray, stabilised: bool, inertia: float) -> PETSc.Mat:
        """The tangent at x (n, 3) [m], with or without its compressed part, plus `inertia` [1/s^2] times the mass."""
        with self.stages("values"):
            if not self.current:
                self._prepare()
            terms = self.sheet.terms(x, stabilised, inertia)
            return self.operator.assemble(terms, None, kept=bool(self.constant))

    def _prepare(self) -> None:
        if self.patterned:
            self.operator.set_constraints(self.sheet.mask)
        else:
            with self.stages("pattern"):
                self.operator.set_topology(self.sheet.blocks, self.sheet.mask)
        self.constant = self.sheet.constant_terms()
        if self.constant:
            self.operator.keep(self.constant)
        self.patterned = self.current = True


class ClothEquations:
    """Forces out of balance of a sheet, as `algebra.newton`, `kinetic_damping` and `descent` want them.

    Args:
        sheet: whose nodes may move, and whose membrane may be softened.
        comm: PETSc communicator.
        stages: takes the times of patterns and values.
        backend: of the operators; by default, on one rank, motion may have one in blocks of nodes.

    Attributes:
        stabilised: whether `tangent` leaves out what is compressed; inertia: times the mass, on its diagonal.
    """

    potential = True

    def __init__(self, sheet: Sheet, comm: PETSc.Comm, stages: Stages, backend: str | None = None) -> None:
        self.sheet, self.stages = sheet, stages
        self.tangents = Assembly(sheet, comm, stages, backend)
        own = comm.size == 1 and backend is None
        self.steps = Assembly(sheet, comm, stages, "bcsr") if own else self.tangents
        self.stabilised, self.inertia, self._changes = True, self.held_up, 0

    @property
    def held_up(self) -> float:
        """Inertia [1/s^2] that is small beside what moves the cloth."""
        size = float(np.ptp(self.sheet.X, axis=0).max())
        return HELD_UP * float(np.linalg.norm(self.sheet.g)) / size or WEIGHTLESS

    @property
    def version(self) -> tuple[int, ...]:
        """Another one whenever forces or the true tangent's matrix may be others at the same positions."""
        contact = self.sheet.contact
        return self._changes, self.tangents.operator.version, contact.version if contact else 0

    @property
    def rows(self) -> slice:
        """This rank's, of all 3 n."""
        return self.tangents.operator.rows

    @property
    def held(self) -> np.ndarray:
        """Unknowns, of all 3 n, that never change."""
        return self.sheet.held

    def begin(self) -> None:
        """Take in that nodes, stiffness or supports have changed."""
        self._changes += 1
        self.tangents.begin()
        self.steps.begin()

    def residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the forces out of balance at positions x (n, 3) [m]."""
        with self.stages("values"):
            self.sheet.residual(x, out)

    def energy(self, x: np.ndarray) -> float:
        """Potential energy [J]."""
        with self.stages("values"):
            return self.sheet.energy(x)

    def assemble(self, x: np.ndarray, out: np.ndarray | None) -> PETSc.Mat:
        """The true tangent at x (n, 3) [m]; `out` as in `residual`."""
        if out is not None:
            self.residual(x, out)
        return self.tangents.matrix(x, False, 0.0)

    def tangent(self, x: np.ndarray) -> PETSc.Mat:
        """The tangent that descents make steps with."""
        return self.tangents.matrix(x, self.stabilised, self.inertia)

    def true_tangent(self, x: np.ndarray, inertia: float) -> PETSc.Mat:
        """The true tangent plus `inertia` [1/s^2] times the mass."""
        return self.tangents.matrix(x, False, inertia)

    def step_matrix(self, x: np.ndarray, inertia: float, blocks: bool) -> PETSc.Mat:
        """The stabilised tangent plus `inertia` [1/s^2] times the mass; with `blocks` it may be of type BAIJ."""
        return (self.steps if blocks else self.tangents).matrix(x, True, inertia)
