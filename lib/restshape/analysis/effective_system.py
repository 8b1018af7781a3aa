"""The linear system of a time step: the effective stiffness and its right sides."""

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.linear_report import true_residual
from restshape.algebra.operator import MatrixTerm, Operator
from restshape.fem.problem import STIFFNESS
from restshape.fem.semidiscrete import SemiDiscrete
from restshape.fem.time_integration import Scheme, TimeState

NO_ACCELERATION = np.empty(0)
"""No acceleration of a base."""


class StepWeights:
    """What a step multiplies the state by, before K and M are applied to it.

    Args:
        scheme: of the step.
        alpha, beta: of the damping C = alpha M + beta K.

    Source: docs/theory/solids.md.
    """

    def __init__(self, scheme: Scheme, alpha: float, beta: float) -> None:
        self.alpha, self.beta, gap = alpha, beta, scheme.a4 - scheme.a3
        self.of_stiffness, self.of_mass = 1.0 + scheme.a1 * beta, scheme.a0 + scheme.a1 * alpha
        self.load = 1.0 + scheme.a3
        self.stiff_y, self.stiff_v, self.stiff_a = self.of_stiffness - self.load, gap * beta, scheme.a5 * beta
        self.inert_y, self.inert_v, self.inert_a = self.of_mass, scheme.a2 + gap * alpha, scheme.a5 * alpha
        stiff = self.stiff_y, self.stiff_v, self.stiff_a
        self._all = (*stiff, self.inert_y, self.inert_v, self.inert_a)

    def apply(self, state: TimeState, stiff: np.ndarray, inert: np.ndarray, base: np.ndarray = NO_ACCELERATION) -> None:
        """Set `stiff` and `inert` (n, f) to what K and M are applied to, less `base` (f,) times M at each node."""
        base = base if len(base) else np.zeros(stiff.shape[1])
        _kernels.weigh_state(state.y, state.v, state.a, self._all, base, stiff, inert)


class EffectiveSystem:
    """A y' = b with A = K + a0 M + a1 C for the unknowns y' after a step.

    The right side is written with M a = f - K y - C v, so that the acceleration is equilibrium's on the present shape:
    b = f' + a3 f + A y - (1 + a3) K y + M (a2 + (a4 - a3) alpha) v + K (a4 - a3) beta v + a5 C a.
    Where the matrix is new, its own element loop gives b; in later steps two products with kept matrices do.

    Args:
        comm: PETSc communicator.
        body: on a mesh that stays this one.
        scheme: of the step.
        backend: of the operators.

    Source: docs/theory/solids.md.
    """

    def __init__(self, comm: PETSc.Comm, body: SemiDiscrete, scheme: Scheme, backend: str | None) -> None:
        space, shape = body.problem.space, body.static.shape
        kind = {"symmetric": body.problem.symmetric, "definite": body.problem.definite}
        self.operator, self._mass = (Operator(comm, shape[1], space.node_offsets, backend, **kind) for _ in "AM")
        # Cells that flips have changed since the mass matrix had a pattern; None: it has none of this mesh.
        self._flipped: list[np.ndarray] | None = None
        self.rows = self.operator.rows
        size = (self.rows.stop - self.rows.start, body.static.size)

        def vector(array: np.ndarray) -> PETSc.Vec:
            return PETSc.Vec().createWithArray(array.ravel()[self.rows], size=size, comm=comm)

        self.right, self.full = np.zeros(shape), np.zeros(body.static.size)
        self.b, self.solution = vector(self.right), vector(self.full)
        self._products = StepProducts(vector, shape, size)
        self.bind(body, scheme)

    def bind(self, body: SemiDiscrete, scheme: Scheme) -> None:
        """Take a body with other values on the same mesh, and other settings of the step."""
        self.body = body
        self.weights = StepWeights(scheme, body.damping_of.alpha, body.damping_of.beta)
        self.operator.set_topology(body.problem.blocks(), body.problem.boundary.mask)
        self._flipped = self._products.version = None

    def patch(self, changed: np.ndarray) -> None:
        """Take in the cells (k,) that flips have changed."""
        self.operator.patch(0, changed)
        if self._flipped is not None:
            self._flipped.append(changed)

    @property
    def mass(self) -> Operator:
        """An operator with the same pattern, for other matrices: made when the first of them is asked for."""
        if self._flipped is None:
            self._mass.set_topology(self.body.problem.blocks(), self.body.problem.boundary.mask)
        elif self._flipped:
            self._mass.patch(0, np.unique(np.concatenate(self._flipped)))
        self._flipped = []
        return self._mass

    def assemble(self, state: TimeState, base_acceleration: np.ndarray) -> None:
        """Make the matrix of the present shape, and the right side of the step from a state.

        Args:
            state: before the step.
            base_acceleration: (f,) the base's a' + a3 a.
        """
        weights, products = self.weights, self._products
        weights.apply(state, products.stiff, products.inert, base_acceleration)
        np.multiply(self.body.static, weights.load, out=self.right)
        stiffness, mass = self.body.problem.integrals(STIFFNESS), self.body.mass.integrals
        terms = [part.term(products.stiff, weights.of_stiffness, -1.0) for part in stiffness]
        terms += [part.term(products.inert, weights.of_mass, -1.0) for part in mass]
        if len(terms) > 2:
            # Terms of a block are summed together where they follow one another.
            terms.sort(key=_block)
        self.mat = self.operator.assemble(terms, self.right.ravel())
        self.b.stateIncrease()
        products.version = None

    def right_side(self, state: TimeState, base_acceleration: np.ndarray) -> None:
        """Make the right side of the step from a state, on the matrix as it is; arguments as in `assemble`."""
        products, weights = self._products, self.weights
        mass = self.mass
        if products.version != mass.version:
            products.assemble(mass, self.body, weights.load)
        weights.apply(state, products.stiff, products.inert)
        products.stiff /= weights.of_stiffness
        products.inert -= weights.of_mass * products.stiff
        products.multiply(self.mat, self.b)
        self.right += products.constant
        if base_acceleration.any():
            self.right -= products.uniform(self.body) * base_acceleration
        self.b.stateIncrease()

    def force(self, out: np.ndarray) -> None:
        """Set `out` to this rank's rows of b - A `full`: the force of the increment that is sought."""
        self._products.force(self.mat, self.solution, self.right.ravel()[self.rows], out)

    def residual(self) -> float:
        """The true residual of the last solve over its right side; as it is where that is 0; collective."""
        return true_residual(self.mat, self.b, self.solution)


def _block(term: MatrixTerm) -> int:
    block = term[0]
    return block if isinstance(block, int) else block.block


class StepProducts:
    """Vectors and the mass matrix that give right sides without an element loop.

    Args:
        vector: makes PETSc's vector of this rank's rows of an array (n, f).
        shape: (n, f) of the unknowns; size: local and global size of vectors.

    Attributes:
        stiff, inert: (n, f) what K and M are applied to.
        constant: (n, f) load of each step.
        version: of the operator that the matrix was assembled with; None: there is none for the present shape.
    """

    def __init__(
        self, vector: Callable[[np.ndarray], PETSc.Vec], shape: tuple[int, ...], size: tuple[int, int]
    ) -> None:
        self.stiff, self.inert = np.zeros(shape), np.zeros(shape)
        self._stiff, self._inert = vector(self.stiff), vector(self.inert)
        self._own_force = np.zeros(size[0])
        self._force = PETSc.Vec().createWithArray(self._own_force, size=size, comm=self._stiff.comm)
        self.constant = self.stiff
        self._uniform: np.ndarray | None = None
        self.version: object = None

    def assemble(self, operator: Operator, body: SemiDiscrete, load: float) -> None:
        """Assemble the mass matrix, and the load of each step."""
        zero = np.zeros_like(body.static)
        self._mass = operator.assemble([part.term(zero) for part in body.mass.integrals], None)
        self.constant, self._uniform = body.static * load, None
        self.version = operator.version

    def multiply(self, mat: PETSc.Mat, b: PETSc.Vec) -> None:
        """Set b to mat `stiff` + M `inert`."""
        for vector in (self._stiff, self._inert, b):
            vector.stateIncrease()
        mat.mult(self._stiff, b)
        self._mass.multAdd(self._inert, b, b)

    def uniform(self, body: SemiDiscrete) -> np.ndarray:
        """The inertia (n, f) of a body that moves as a whole: only base excitation asks for it."""
        if self._uniform is None:
            self._uniform = body.mass.apply(np.ones_like(body.static))
            self._uniform[body.constrained] = 0.0
        return self._uniform

    def force(self, mat: PETSc.Mat, solution: PETSc.Vec, own_b: np.ndarray, out: np.ndarray) -> None:
        """Set `out` to own_b - mat solution, of this rank's rows."""
        mat.mult(solution, self._force)
        np.subtract(own_b, self._own_force, out=out)
