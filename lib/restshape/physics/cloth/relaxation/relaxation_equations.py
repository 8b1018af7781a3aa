"""The equations of cloth as SNES wants them, on operators whose pattern and bending stiffness are kept."""

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.algebra.stages import Stages
from restshape.fem.assembled import Assembled
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.sheet.membrane import stretching

SUPPORTING = 0.02
"""Inertia of the tangent of descents, over that of a pendulum as long as the cloth, g/L: without any, cloth that lies
loosely has motions that nothing resists."""
WEIGHTLESS = 1e-5
"""The same inertia where there is no weight, over that with which a strip as long as the cloth would swing along itself
by the membrane's stiffness."""


class KeptOperator:
    """Tangents of a problem, with the pattern and the constant terms kept while its stiffness is the same.

    Args:
        problem: whose nodes may move, and whose membrane may be softened.
        comm: PETSc communicator.
        stages: takes the times of patterns and values.
        backend: of the operator.

    Attributes:
        patterned: it has been asked for a tangent.
    """

    def __init__(self, problem: ClothProblem, comm: PETSc.Comm, stages: Stages, backend: str | None) -> None:
        self.stages, self.problem = stages, problem
        # Cloth that each rank has whole has all rows on one.
        offsets = problem.space.node_offsets if comm.size > 1 else np.array([0, problem.n_nodes], dtype=np.int32)
        self.operator = Operator(comm, 3, offsets, backend)
        self.patterned, self._version, self._constant, self._coverings = False, -1, False, 0
        # Elsewhere each rank has the forces on its own nodes alone.
        self.shared = comm.size == 1

    def matrix(
        self,
        x: np.ndarray,
        stabilised: bool,
        inertia: float,
        out: np.ndarray | None = None,
        added: np.ndarray | None = None,
    ) -> PETSc.Mat:
        """The tangent at x (n, 3) [m], with or without its compressed part, plus `inertia` [1/s^2] times the mass.

        `out` (n, 3) [N], where it is given, is set to the residual there, in the same pass as far as both have it.
        The tangent, not the residual, has tensions (ne, 3) [N/m] that are `added` to those at x.
        """
        problem = self.problem
        with self.stages("values"):
            problem.cover(x)
            if self._coverings != problem.coverings:
                self.patterned, self._version = False, -1
            if self._version != problem.stiffness_version:
                self._prepare()
            integrals = problem.tangent_integrals(stabilised, inertia)
            if added is not None:
                integrals.insert(1, problem.membrane.tension_integral(problem.X, added))
            if out is None or not self.shared:
                if out is not None:
                    problem.residual(x, out)
                return Assembled(integrals, self.operator).tangent(x, kept=self._constant)
            out[:] = 0.0
            if self._constant:
                problem.bending_forces(x, out)
            matrix = Assembled(integrals, self.operator).tangent(x, out, kept=self._constant)
            out.ravel()[problem.boundary.constrained] = 0.0
            return matrix

    def _prepare(self) -> None:
        problem = self.problem
        if self.patterned:
            self.operator.set_constraints(problem.boundary.mask)
        else:
            with self.stages("pattern"):
                self.operator.set_topology(problem.blocks(), problem.boundary.mask)
        self._constant, self._coverings = problem.quadratic_bending, problem.coverings
        if self._constant:
            Assembled(problem.bending_integrals(), self.operator).keep(np.zeros((problem.n_nodes, 3)))
        self.patterned, self._version = True, problem.stiffness_version


class ClothEquations:
    """The residual of cloth, as `algebra.newton`, `kinetic_damping` and `descent` want it.

    Args:
        problem: whose nodes may move, and whose membrane may be softened.
        comm: PETSc communicator.
        stages: takes the times of patterns and values.
        backend: of the operators; by default, on one rank, motion may have one in blocks of nodes.

    Attributes:
        stabilised: whether `tangent` leaves out what is compressed; inertia: times the mass, on its diagonal.
    """

    potential = True

    def __init__(self, problem: ClothProblem, comm: PETSc.Comm, stages: Stages, backend: str | None = None) -> None:
        self.problem, self.stages = problem, stages
        self.tangents = KeptOperator(problem, comm, stages, backend)
        own = comm.size == 1 and backend is None
        self.steps = KeptOperator(problem, comm, stages, "bcsr") if own else self.tangents
        self.stabilised, self.inertia = True, self.supporting_inertia

    @property
    def version(self) -> tuple[object, int]:
        """Another one whenever forces or the true tangent's matrix may be others at the same positions."""
        return self.problem.version, self.tangents.operator.version

    @property
    def supporting_inertia(self) -> float:
        """Inertia [1/s^2] that is small beside what moves the cloth."""
        problem = self.problem
        if problem.g.any():
            return SUPPORTING * float(np.linalg.norm(problem.g)) / problem.size
        return WEIGHTLESS / problem.swing_time**2

    @property
    def rows(self) -> slice:
        """This rank's, of all 3 n."""
        return self.tangents.operator.rows

    @property
    def constrained(self) -> np.ndarray:
        """Unknowns, of all 3 n, that are constrained."""
        return self.problem.boundary.constrained

    def constrain(self, rows: np.ndarray) -> None:
        """Set to 0 what is constrained of this rank's rows (k,) of a step."""
        own, constrained = self.rows, self.constrained
        rows[constrained[(constrained >= own.start) & (constrained < own.stop)] - own.start] = 0.0

    @property
    def mass(self) -> np.ndarray:
        """Of the nodes (n,) [kg]."""
        return self.problem.lumped.mass

    def residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set `out` (n, 3) [N] to the residual at positions x (n, 3) [m]."""
        with self.stages("values"):
            self.problem.residual(x, out)

    def energy(self, x: np.ndarray) -> float:
        """Potential energy [J]."""
        with self.stages("values"):
            return self.problem.energy(x)

    def assemble(self, x: np.ndarray, out: np.ndarray | None) -> PETSc.Mat:
        """The true tangent at x (n, 3) [m]; `out` as in `residual`."""
        if out is not None:
            self.residual(x, out)
        return self.tangents.matrix(x, False, 0.0)

    def tangent(self, x: np.ndarray) -> PETSc.Mat:
        """The tangent that descents make steps with."""
        return self.tangents.matrix(x, self.stabilised, self.inertia)

    def mixed_tangent(self, x: np.ndarray, tensions: np.ndarray | None, stabilised: bool) -> PETSc.Mat:
        """The tangent at x (n, 3) [m] with tensions (ne, 3) [N/m] in place of those there; None: with those.

        With `stabilised` it is without compression, and has the supporting inertia.
        """
        added = None
        if tensions is not None:
            there = self.problem.tensions(x)
            added = stretching(tensions) - stretching(there) if stabilised else tensions - there
        return self.tangents.matrix(x, stabilised, self.supporting_inertia if stabilised else 0.0, added=added)

    def true_tangent(self, x: np.ndarray, inertia: float) -> PETSc.Mat:
        """The true tangent plus `inertia` [1/s^2] times the mass."""
        return self.tangents.matrix(x, False, inertia)

    def step_matrix(self, x: np.ndarray, inertia: float, blocks: bool, out: np.ndarray | None = None) -> PETSc.Mat:
        """The stabilised tangent plus `inertia` [1/s^2] times the mass; with `blocks` it may be of type BAIJ.

        Sets `out` (n, 3) [N], where it is given, to the residual.
        """
        return (self.steps if blocks else self.tangents).matrix(x, True, inertia, out)
