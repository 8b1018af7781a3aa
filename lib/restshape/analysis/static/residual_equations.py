"""The residual of a problem under dead loads and loads that follow, as Newton's method solves it."""

from __future__ import annotations

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.algebra.stages import Stages
from restshape.fem.assembled import Assembled
from restshape.fem.entity_sets import cells_around
from restshape.fem.problem import FOLLOWERS, INTERNAL, SteadyProblem
from restshape.fem.residuals import dead_loads


class ResidualEquations:
    """Internal less applied forces or fluxes as a function of the unknowns; `algebra.equations.Equations`.

    Args:
        problem: on a space whose nodes may move.
        operator: on its blocks.
        stages: takes the time of values.

    Attributes:
        dead: (n, f) dead loads; free: (n, f) 1 at free unknowns, 0 at prescribed ones; rest: (n, f) zeros.

    Source: docs/theory/solids.md.
    """

    def __init__(self, problem: SteadyProblem, operator: Operator, stages: Stages) -> None:
        self.problem, self.operator, self.stages = problem, operator, stages
        self.potential = problem.symmetric and problem.definite
        mask, constrained = problem.boundary.mask, problem.boundary.constrained
        start, stop = operator.rows.start, operator.rows.stop
        self._own_constrained = constrained[(constrained >= start) & (constrained < stop)] - start
        self.dead, self.undeformed = np.zeros(mask.shape), np.zeros(mask.shape)
        self.free = np.where(mask, 0.0, 1.0)
        # The part of the followers that is on: no dead load takes them away.
        self._part, self._changes, self._evaluated = 1.0, 0, 0
        self._own: tuple[int, np.ndarray | None] = (-1, None)
        self._sum: tuple[tuple[int, float, int], Assembled] | None = None

    @property
    def version(self) -> tuple[int, int]:
        """Another one whenever residual or tangent may be others at the same unknowns."""
        return self._changes, self.operator.version

    @property
    def part(self) -> float:
        """The part of the loads that follow which is on."""
        return self._part

    @part.setter
    def part(self, part: float) -> None:
        self._part, self._changes = part, self._changes + 1

    def begin(self) -> None:
        """Evaluate the dead loads on the mesh as it lies now."""
        self._changes += 1
        self._evaluated += self.problem.varies
        if sliding := self.problem.boundary.sliding:
            self.operator.set_sliding(sliding.nodes, sliding.kept)
        elif self.operator.slides:
            self.operator.set_sliding(np.empty(0, dtype=np.int32), np.empty((0, 3)))
        dead_loads(self.problem, self.dead)

    def constrain(self, rows: np.ndarray) -> None:
        """Set to 0 what is constrained of this rank's rows (k,) of a step."""
        rows[self._own_constrained] = 0.0
        if sliding := self.problem.boundary.sliding:
            fields = self.free.shape[1]
            sliding.project(rows.reshape(-1, fields), self.operator.rows.start // fields)

    def load(self) -> np.ndarray:
        """All loads (n, f) where the unknowns are 0, and with them what the body itself brings forth."""
        if self.problem.loaded_inside:
            return -self.full_residual(self.undeformed)
        out = np.negative(self.dead)
        Assembled(self.problem.integrals(FOLLOWERS, self.part)).residual(self.undeformed, out)
        self.problem.boundary.zero(out)
        return np.negative(out, out=out)

    def residual(self, x: np.ndarray, out: np.ndarray) -> None:
        """Set this rank's rows of `out` (n, f) to the residual at the unknowns x (n, f)."""
        with self.stages("values"):
            self._residual(x, out, self._own_cells())

    def full_residual(self, x: np.ndarray) -> np.ndarray:
        """The residual (n, f) at all nodes."""
        out = np.empty_like(self.dead)
        self._residual(x, out, None)
        return out

    def assemble(self, x: np.ndarray, out: np.ndarray | None) -> PETSc.Mat:
        """The tangent at x (n, f); `out` as in `residual`, in the same pass."""
        with self.stages("values"):
            if out is not None:
                np.negative(self.dead, out=out)
            return self._assembled().tangent(x, out)

    def energy(self, x: np.ndarray) -> float:
        """Internal energy less the work of the dead loads, of the whole body on each rank."""
        internal = Assembled(self.problem.integrals(INTERNAL)).energy(x)
        return float(internal - np.vdot(self.dead, x))

    def _assembled(self) -> Assembled:
        """What balances, with the values of the last `begin`."""
        version = self._evaluated, self._part, self.problem.space.topology
        if self._sum is None or self._sum[0] != version:
            integrals = [*self.problem.integrals(INTERNAL), *self.problem.integrals(FOLLOWERS, self._part)]
            self._sum = version, Assembled(integrals, self.operator)
        return self._sum[1]

    def _residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None) -> None:
        np.negative(self.dead, out=out)
        self._assembled().residual(x, out, subset)
        self.problem.boundary.zero(out)

    def _own_cells(self) -> np.ndarray | None:
        """The cells around this rank's nodes; None where these are all."""
        if self.operator.comm.size == 1:
            return None
        space = self.problem.space
        if self._own[0] != space.topology:
            rows, fields = self.operator.rows, self.free.shape[1]
            nodes = np.arange(rows.start // fields, rows.stop // fields, dtype=np.int32)
            self._own = (space.topology, cells_around(space, nodes))
        return self._own[1]
