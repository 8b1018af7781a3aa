"""The equations of a time step of a solid of large deformation."""

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape.algebra.newton import Newton
from restshape.algebra.operator import Operator
from restshape.algebra.stages import Stages
from restshape.analysis.effective import State
from restshape.analysis.equilibrium import Equilibrium
from restshape.physics.elasticity.dynamics import Newmark
from restshape.physics.elasticity.moving_solid import VibratingSolid


class MotionEquations(Equilibrium):
    """M a' + C v' = forces at x', with Newmark's a' and v' of the displacement x' after a step.

    As in the linear case the acceleration before the step is that of equilibrium, M a = forces - C v, so that it need
    not be known itself. Damping is by the stiffness of the body at rest.

    Args:
        body: on a mesh that stays this one.
        newmark: the step.
        operator: on its cells, and on the facets of each pressure.
        stages: takes the time of values.

    Source: docs/theory.md, section 2.
    """

    def __init__(self, body: VibratingSolid, newmark: Newmark, operator: Operator, stages: Stages) -> None:
        super().__init__(body.solid, operator, stages)
        self.body, self.newmark = body, newmark
        self.of_mass = newmark.a0 + newmark.a1 * body.rayleigh.alpha
        self.of_stiffness = newmark.a1 * body.rayleigh.beta
        self.applied, self.before = np.zeros_like(self.rest), self.rest
        self.force_norm = self.load_norm = 0.0

    def begin(self) -> None:
        """Evaluate the dead loads on the mesh as it lies now."""
        self.dead = self.applied
        super().begin()
        self.load_norm = float(np.linalg.norm(self.load()))

    def start(self, state: State, shaking: np.ndarray, next_shaking: np.ndarray) -> None:
        """Begin a step from a state.

        Args:
            state: before the step.
            shaking, next_shaking: (2,) the ground's acceleration [m/s^2] before and after the step.
        """
        step, body, inertia, v = self.newmark, self.body, self.body.inertia, state.v
        self.before = state.y + self.physics.prescribed
        self.dead = self.applied
        self._changes += 1
        # The forces of inertia, M a, before the step.
        forces = -self.whole_residual(self.before) - body.damping(v)
        if shaking.any():
            forces -= inertia.apply(np.zeros_like(v) + shaking)
        forces *= self.free
        pushed = step.a4 * v
        history = step.a3 * forces
        if state.a is not None:
            pushed = pushed + step.a5 * state.a
            history = inertia.apply(step.a3 * state.a)
        shaken = inertia.apply(np.zeros_like(v) + next_shaking) if next_shaking.any() else self.rest
        history += inertia.apply(step.a2 * v) - shaken + body.damping(pushed)
        history *= self.free
        self.force_norm = float(max(np.linalg.norm(forces), np.linalg.norm(shaken)))
        self.dead = self.applied + history

    def assemble(self, x: np.ndarray, out: np.ndarray | None) -> PETSc.Mat:
        """The tangent at x (n, 2) [m] after the step; `out` as in `residual`, in the same pass."""
        inertia, X, moved = self.body.inertia, self.physics.mesh.X, x - self.before
        terms = self.terms(x)
        more = [(0, inertia.element, X, moved, inertia.params, self.of_mass, -self.of_mass)]
        if self.of_stiffness:
            small, params = self.physics.small, self.physics.stiffness_params
            more.append((0, small, X, moved, params, self.of_stiffness, -self.of_stiffness))
        with self.stages("values"):
            if out is not None:
                np.negative(self.dead, out=out)
            return self.operator.assemble([terms[0], *more, *terms[1:]], None if out is None else out.ravel())

    def energy(self, x: np.ndarray) -> float:
        """The energy [J] of which the step finds a stationary point."""
        moved, physics = x - self.before, self.physics
        energy = super().energy(x) + self.of_mass * float(self.body.inertia.energies(moved).sum())
        if self.of_stiffness:
            mesh = physics.mesh
            energies = physics.small.energy(mesh.X, moved, mesh.cells, physics.stiffness_params)
            energy += self.of_stiffness * float(energies.sum())
        return energy

    def whole_energy(self, x: np.ndarray, v: np.ndarray) -> float:
        """Strain and kinetic energy less the work of the dead loads [J]; x (n, 2) [m], v (n, 2) [m/s]."""
        dead, self.dead = self.dead, self.applied
        potential = super().energy(x)
        self.dead = dead
        return potential + float(self.body.inertia.energies(v).sum())

    def _residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None) -> None:
        super()._residual(x, out, subset)
        if self.dead is self.applied:
            return
        inertia, mesh, moved = self.body.inertia, self.physics.mesh, x - self.before
        inertia.element.residual(mesh.X, self.of_mass * moved, mesh.cells, inertia.params, out, subset)
        if self.of_stiffness:
            small, params = self.physics.small, self.physics.stiffness_params
            small.residual(mesh.X, self.of_stiffness * moved, mesh.cells, params, out, subset)
        out *= self.free


class MotionSystem:
    """Equations of time steps on one mesh, their operator, and Newton's method for them.

    Args:
        comm: PETSc communicator.
        body: on the mesh.
        newmark: the step.
        newton: makes Newton's method for the unknowns' shape (n, f) and this rank's rows.
        backend: of the operator.
        stages: takes the time of values.
        symmetric: whether no pressure follows the boundary.
    """

    def __init__(
        self,
        comm: PETSc.Comm,
        body: VibratingSolid,
        newmark: Newmark,
        newton: Callable[[tuple[int, int], slice], Newton],
        backend: str | None,
        stages: Stages,
        symmetric: bool,
    ) -> None:
        mesh = body.mesh
        self.operator = Operator(comm, 2, mesh.node_offsets, backend, symmetric=symmetric)
        facets = [load.facets for load in body.solid.followers]
        self.operator.set_topology([mesh.cells, *facets], body.solid.mask)
        self.rows = self.operator.rows
        self.newton = newton(mesh.X.shape, self.rows)
        self.places = mesh.X[self.rows.start // 2 : self.rows.stop // 2]
        self.stages = stages
        self.bind(body, newmark)

    @property
    def mass(self) -> Operator:
        """An operator on the cells, for other matrices; the tangent is lost."""
        return self.operator

    def bind(self, body: VibratingSolid, newmark: Newmark) -> None:
        """Take a body with other values on the same mesh, and other settings of the step."""
        self.operator.set_constraints(body.solid.mask)
        self.equations = MotionEquations(body, newmark, self.operator, self.stages)
        self.newton.take(self.equations)

    def patch(self, changed: np.ndarray) -> None:
        """Take in the cells (k,) that flips have changed."""
        self.operator.patch(0, changed)
