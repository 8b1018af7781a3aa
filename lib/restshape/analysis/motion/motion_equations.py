"""The equations of a time step of a nonlinear problem."""

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape.algebra.nonlinear.newton import Newton
from restshape.algebra.operator import Operator
from restshape.algebra.stages import Stages
from restshape.analysis.static.residual_equations import ResidualEquations
from restshape.fem.assembled import Assembled
from restshape.fem.problem import FOLLOWERS, INTERNAL, REFERENCE
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.time_integration import Scheme, TimeState


# More than 15 attributes: those of the static equations, and what a time step adds.
class MotionEquations(ResidualEquations):
    """M a' + C v' = forces at x', with the scheme's a' and v' of the unknowns x' after a step.

    As in the linear case the acceleration before the step is that of equilibrium, M a = forces - C v, so that it need
    not be known itself. Damping is by the stiffness where all unknowns are 0. In first order M v' = forces likewise.

    Args:
        body: on a mesh that stays this one.
        scheme: of the step.
        operator: on its blocks.
        stages: takes the time of values.

    Attributes:
        force_norm, load_norm: of the forces of inertia before the step, and of the load.
        before: (n, f) unknowns before the step.

    Source: docs/theory/solids.md.
    """

    def __init__(self, body: SemiDiscrete, scheme: Scheme, operator: Operator, stages: Stages) -> None:
        super().__init__(body.problem, operator, stages)
        self.body, self.scheme = body, scheme
        self.of_mass = scheme.a0 + scheme.a1 * body.damping_of.alpha
        self.of_stiffness = scheme.a1 * body.damping_of.beta
        self.applied, self.before = np.zeros_like(self.undeformed), self.undeformed
        self.force_norm = self.load_norm = 0.0

    def begin(self) -> None:
        """Evaluate the dead loads on the mesh as it lies now."""
        self.dead = self.applied
        super().begin()
        self.load_norm = float(np.linalg.norm(self.load()))

    def start(self, state: TimeState, base_acceleration: np.ndarray, next_base_acceleration: np.ndarray) -> None:
        """Begin a step from a state.

        Args:
            state: before the step.
            base_acceleration, next_base_acceleration: (f,) the base's acceleration before and after the step.
        """
        step, body, mass, v = self.scheme, self.body, self.body.mass, state.v
        self.before = body.unknowns(state.y)
        self.dead = self.applied
        self._changes += 1
        # The forces of inertia, M a, before the step.
        forces = -self.full_residual(self.before) - body.damping(v)
        if base_acceleration.any():
            forces -= mass.apply(np.zeros_like(v) + base_acceleration)
        forces *= self.free
        pushed = step.a4 * v
        history = step.a3 * forces
        if state.a is not None:
            pushed = pushed + step.a5 * state.a
            history = mass.apply(step.a3 * state.a)
        base_force = (
            mass.apply(np.zeros_like(v) + next_base_acceleration) if next_base_acceleration.any() else self.undeformed
        )
        history += mass.apply(step.a2 * v) - base_force + body.damping(pushed)
        history *= self.free
        self.force_norm = float(max(np.linalg.norm(forces), np.linalg.norm(base_force)))
        self.dead = self.applied + history

    def assemble(self, x: np.ndarray, out: np.ndarray | None) -> PETSc.Mat:
        """The tangent at x (n, f) after the step; `out` as in `residual`, in the same pass."""
        problem, moved = self.problem, x - self.before
        terms = [part.term(x, 1.0, -1.0) for part in problem.integrals(INTERNAL)]
        terms += [part.term(moved, self.of_mass, -self.of_mass) for part in self.body.mass.integrals]
        if self.of_stiffness:
            reference = problem.integrals(REFERENCE)
            terms += [part.term(moved, self.of_stiffness, -self.of_stiffness) for part in reference]
        terms += [part.term(x, 1.0, -1.0) for part in problem.integrals(FOLLOWERS, self.part)]
        with self.stages("values"):
            if out is not None:
                np.negative(self.dead, out=out)
            return self.operator.assemble(terms, None if out is None else out.ravel())

    def energy(self, x: np.ndarray) -> float:
        """The energy [J] of which the step finds a stationary point."""
        moved = x - self.before
        energy = super().energy(x) + self.of_mass * float(self.body.mass.energies(moved).sum())
        if self.of_stiffness:
            energy += self.of_stiffness * Assembled(self.problem.integrals(REFERENCE)).energy(moved)
        return energy

    def total_energy(self, x: np.ndarray, v: np.ndarray) -> float:
        """Internal and kinetic energy less the work of the dead loads [J]; x, v (n, f)."""
        dead, self.dead = self.dead, self.applied
        potential = super().energy(x)
        self.dead = dead
        return potential + float(self.body.mass.energies(v).sum())

    def _residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None) -> None:
        super()._residual(x, out, subset)
        if self.dead is self.applied:
            return
        moved = x - self.before
        Assembled(self.body.mass.integrals).residual(self.of_mass * moved, out, subset)
        if self.of_stiffness:
            Assembled(self.problem.integrals(REFERENCE)).residual(self.of_stiffness * moved, out, subset)
        out *= self.free


class MotionSystem:
    """Equations of time steps on one mesh, their operator, and Newton's method for them.

    Args:
        comm: PETSc communicator.
        body: on the mesh.
        scheme: of the step.
        newton: makes Newton's method for the unknowns' shape (n, f) and this rank's rows.
        backend: of the operator.
        stages: takes the time of values.
        symmetric: whether every tangent is symmetric.
    """

    def __init__(
        self,
        comm: PETSc.Comm,
        body: SemiDiscrete,
        scheme: Scheme,
        newton: Callable[[tuple[int, ...], slice], Newton],
        backend: str | None,
        stages: Stages,
        symmetric: bool,
    ) -> None:
        space, mask = body.problem.space, body.problem.boundary.mask
        fields = mask.shape[1]
        self.operator = Operator(comm, fields, space.node_offsets, backend, symmetric, body.problem.definite)
        self.operator.set_topology(body.problem.blocks(), mask)
        self.rows = self.operator.rows
        self.newton = newton(mask.shape, self.rows)
        self.places = space.dof_X[self.rows.start // fields : self.rows.stop // fields]
        self.stages = stages
        self.bind(body, scheme)

    @property
    def mass(self) -> Operator:
        """An operator on the cells, for other matrices; the tangent is lost."""
        return self.operator

    def bind(self, body: SemiDiscrete, scheme: Scheme) -> None:
        """Take a body with other values on the same mesh, and other settings of the step."""
        self.operator.set_constraints(body.problem.boundary.mask)
        self.equations = MotionEquations(body, scheme, self.operator, self.stages)
        self.newton.set_equations(self.equations)

    def patch(self, changed: np.ndarray) -> None:
        """Take in the cells (k,) that flips have changed."""
        self.operator.patch(0, changed)
