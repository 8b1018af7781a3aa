"""The linear system of a time step: the effective stiffness and its right sides."""

from typing import NamedTuple

import numpy as np
from petsc4py import PETSc

from restshape.algebra.operator import Operator
from restshape.physics.elasticity.dynamics import Newmark
from restshape.physics.elasticity.moving_solid import VibratingSolid


class State(NamedTuple):
    """A motion at one time; its arrays are never changed in place.

    Args:
        y, v: (n, 2) displacement less the prescribed one [m], velocity [m/s], relative to the ground.
        a: (n, 2) acceleration [m/s^2]; None where the method does without.
        time: [s].
    """

    y: np.ndarray
    v: np.ndarray
    a: np.ndarray | None
    time: float


class EffectiveSystem:
    """A y' = b with A = K + a0 M + a1 C for the displacements y' after a step.

    The right side is written with M a = f - K y - C v, so that the acceleration is equilibrium's on the present shape:
    b = f' + a3 f + A y - (1 + a3) K y + M (a2 + (a4 - a3) alpha) v + K (a4 - a3) beta v + a5 C a.
    Where the matrix is new, its own element loop gives b; in later steps two products with kept matrices do.

    Args:
        comm: PETSc communicator.
        body: on a mesh that stays this one.
        newmark: the step.
        backend: of the operators.

    Source: docs/theory.md, section 2.
    """

    def __init__(self, comm: PETSc.Comm, body: VibratingSolid, newmark: Newmark, backend: str | None) -> None:
        self.comm, mesh = comm, body.mesh
        self.operator, self.mass = (Operator(comm, 2, mesh.node_offsets, backend) for _ in "AM")
        self.rows = self.operator.rows
        shape, n = mesh.X.shape, mesh.X.size
        size = (self.rows.stop - self.rows.start, n)

        def vector(array: np.ndarray) -> PETSc.Vec:
            return PETSc.Vec().createWithArray(array.ravel()[self.rows], size=size, comm=comm)

        self.rhs, self.full, self.stiff, self.inert = np.zeros(shape), np.zeros(n), np.zeros(shape), np.zeros(shape)
        self.b, self.solution = vector(self.rhs), vector(self.full)
        self._stiff, self._inert = vector(self.stiff), vector(self.inert)
        self.own_b, self.own_force = self.rhs.ravel()[self.rows], np.zeros(size[0])
        self._force = PETSc.Vec().createWithArray(self.own_force, size=size, comm=comm)
        self.bind(body, newmark)

    def bind(self, body: VibratingSolid, newmark: Newmark) -> None:
        """Take a body with other values on the same mesh, and other settings of the step."""
        self.body, self.newmark = body, newmark
        alpha, beta = body.rayleigh.alpha, body.rayleigh.beta
        step, lag = newmark, newmark.a4 - newmark.a3
        self.of_stiffness, self.of_mass = 1.0 + step.a1 * beta, step.a0 + step.a1 * alpha
        self.load = 1.0 + step.a3
        self.stiff_y, self.stiff_v, self.stiff_a = self.of_stiffness - self.load, lag * beta, step.a5 * beta
        self.inert_y, self.inert_v, self.inert_a = self.of_mass, step.a2 + lag * alpha, step.a5 * alpha
        for operator in (self.operator, self.mass):
            operator.set_topology([body.mesh.cells], body.solid.mask)
        self.products_current, self._inertia_of_ones = False, None

    def patch(self, changed: np.ndarray) -> None:
        """Take in the cells (k,) that flips have changed."""
        for operator in (self.operator, self.mass):
            operator.patch(0, changed)

    def assemble(self, state: State, shaking: np.ndarray) -> None:
        """Make the matrix of the present shape, and the right side of the step from a state.

        Args:
            state: before the step.
            shaking: (2,) the ground's a' + a3 a [m/s^2].
        """
        solid, inertia, X = self.body.solid, self.body.inertia, self.body.mesh.X
        self._weigh(state)
        self.inert -= shaking
        np.multiply(self.body.static, self.load, out=self.rhs)
        self.mat = self.operator.assemble(
            [
                (0, solid.element, X, self.stiff, solid.stiffness_params, self.of_stiffness, -1.0),
                (0, inertia.element, X, self.inert, inertia.params, self.of_mass, -1.0),
            ],
            self.rhs.ravel(),
        )
        self.b.stateIncrease()
        self.products_current = False

    def right_side(self, state: State, shaking: np.ndarray) -> None:
        """Make the right side of the step from a state, on the matrix as it is; arguments as in `assemble`."""
        if not self.products_current:
            self._make_products()
        self._weigh(state)
        self.stiff /= self.of_stiffness
        self.inert -= self.of_mass * self.stiff
        for vector in (self._stiff, self._inert, self.b):
            vector.stateIncrease()
        self.mat.mult(self._stiff, self.b)
        self.mass_matrix.multAdd(self._inert, self.b, self.b)
        self.rhs += self.constant
        if shaking.any():
            self.rhs -= self._uniform() * shaking
        self.b.stateIncrease()

    def force(self) -> np.ndarray:
        """This rank's rows of b - A `full`: the force of the increment that is sought; valid until the next call."""
        self.mat.mult(self.solution, self._force)
        return np.subtract(self.own_b, self.own_force, out=self.own_force)

    def _weigh(self, state: State) -> None:
        """Combine the state to what K and M are applied to."""
        np.multiply(state.y, self.stiff_y, out=self.stiff)
        np.multiply(state.y, self.inert_y, out=self.inert)
        self.inert += self.inert_v * state.v
        if self.stiff_v:
            self.stiff += self.stiff_v * state.v
        if state.a is not None:
            self.stiff += self.stiff_a * state.a
            self.inert += self.inert_a * state.a

    def _uniform(self) -> np.ndarray:
        """The inertia (n, 2) [kg] of a body that moves as a whole: only shaking ground asks for it."""
        if self._inertia_of_ones is None:
            self._inertia_of_ones = self.body.inertia.apply(np.ones_like(self.body.mesh.X))
            self._inertia_of_ones[self.body.held] = 0.0
        return self._inertia_of_ones

    def _make_products(self) -> None:
        """Assemble what `right_side` multiplies by and adds."""
        body, inertia = self.body, self.body.inertia
        zero = np.zeros_like(body.mesh.X)
        self.mass_matrix = self.mass.assemble([(0, inertia.element, body.mesh.X, zero, inertia.params, 1.0)], None)
        self._inertia_of_ones = None
        self.constant = body.static * self.load
        self.products_current = True
