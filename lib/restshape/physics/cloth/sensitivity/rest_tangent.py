"""The tangent of cloth at rest, friction that agrees with the place included, and solves with it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from petsc4py import PETSc
from scipy.sparse import csr_matrix

from restshape.algebra.factors.gathering import whole_cholesky
from restshape.fem.assembled import Assembled
from restshape.physics.cloth.relaxation.relaxation_equations import ClothEquations
from restshape.physics.cloth.relaxation.state import RelaxationState
from restshape.physics.cloth.sensitivity.agreed_contact import AgreedContact
from restshape.physics.cloth.sensitivity.agreed_layers import AgreedLayers

RESTART, MOST = 60, 600
"""Directions of one cycle of GMRES, and steps at most."""

Apply = Callable[[PETSc.Vec, PETSc.Vec], None]


class RestTangent:
    """K at an equilibrium: membrane, bending, contact with the curvature of bodies, and friction that agrees.

    Systems with K are solved by flexible GMRES on the factor of its symmetric part that the test of stability has left:
    friction whose normal force follows the place is not symmetric.

    Args:
        state: at rest.
        own: the tangent is another one than that of the equilibrium, such as with stiffened bending: it has a factor of
            its own.
    """

    def __init__(self, state: RelaxationState, own: bool = False) -> None:
        self.own, self.state, self.problem, self.x = own, state, state.problem, state.x
        self.free = self.problem.boundary.free.ravel()
        contact = self.problem.contact
        self.contact = (
            AgreedContact(contact, self.problem.corners(self.x), self.problem.corner_number, self.problem.n_nodes)
            if contact
            else None
        )
        own = self.problem.self_contact
        self.layers = (
            AgreedLayers(own, self.problem.corners(self.x), self.problem.corner_number, self.problem.n_nodes)
            if own and own.active and own.rough and len(own.history.offsets)
            else None
        )
        self.rubbing = self.layers.tangent() if self.layers else None
        self.sliding: csr_matrix | None = self.rubbing
        if self.contact and self.contact.acts:
            found = self.contact.tangent()
            self.sliding = found if self.rubbing is None else found + self.rubbing
        self.iterations = 0

    @cached_property
    def gradients(self) -> np.ndarray:
        """Derivatives (corners, 3, 2) of the positions at the corners by places in the material."""
        return self.state.advected.gradients[self.problem.corner_number]

    def product(self, d: np.ndarray) -> np.ndarray:
        """K d (n, 3) by the elements, without the matrix, for d (n, 3); prescribed unknowns count."""
        out = Assembled(self.problem.material_integrals()).tangent_product(self.x, d)
        if self.rubbing is not None:
            out += (self.rubbing @ d.ravel()).reshape(d.shape)
        return out + self.contact.rates(d) if self.contact else out

    def solve(self, right: np.ndarray, tolerance: float) -> np.ndarray:
        """s (k, n, 3) with K s = right (k, n, 3) at free unknowns, 0 at prescribed ones.

        Args:
            right: one after the other.
            tolerance: of the residual, relative to each.
        """
        matrix, precondition, owned = self._symmetric_part()
        ksp, shell = self._krylov(matrix, precondition, tolerance)
        found = np.zeros_like(right)
        b, s = matrix.createVecLeft(), matrix.createVecRight()
        self.iterations = 0
        for one, out in zip(right, found):
            b.getArray()[:] = one.ravel() * self.free
            b.stateIncrease()
            if b.norm() > 0.0:
                ksp.solve(b, s)
                self.iterations += ksp.getIterationNumber()
                out[...] = (s.getArray(readonly=True) * self.free).reshape(out.shape)
        for part in (ksp, b, s, *([shell] if shell is not matrix else []), *owned):
            part.destroy()
        return found

    def _symmetric_part(self) -> tuple[PETSc.Mat, Apply, list]:
        """The tangent of the frozen potential, what applies a factor of it, and what is to be destroyed.

        On one rank the factor is the one at hand. On several each has a whole one of its own, as the test of stability.
        """
        solver, x = self.state.solver, self.x
        if solver.comm.size == 1 and not self.own:
            matrix = solver.newton.tangent(x)
            if not solver.linear.kept.ready:
                solver.newton.definite(x)
                matrix = solver.newton.tangent(x)
            # Every step of the iteration substitutes once for each derivative.
            if not solver.linear.kept.by_panels:
                solver.linear.kept.substitute_by_panels(iterates=solver.linear.takes_guess)
            return matrix, solver.linear.ksp.getPC().apply, []
        equations = ClothEquations(self.problem, solver.comm, solver.stages, None) if self.own else solver.equations
        matrix, pc = whole_cholesky(equations.true_tangent(x, 0.0), solver.comm)
        return matrix, pc.apply, [pc, matrix]

    def _krylov(self, matrix: PETSc.Mat, precondition: Apply, tolerance: float) -> tuple[PETSc.KSP, PETSc.Mat]:
        """The Krylov solver of K, and the matrix that it multiplies with."""
        shell = matrix
        if self.sliding is not None:
            shell = PETSc.Mat().createPython(matrix.getSizes(), _Sum(matrix, self.sliding, self.free), matrix.comm)
            shell.setUp()
        ksp = PETSc.KSP().create(matrix.comm)
        ksp.setOperators(shell)
        # The factor may be rounded to single precision.
        ksp.setType("fgmres")
        ksp.setGMRESRestart(RESTART)
        ksp.getPC().setType("python")
        ksp.getPC().setPythonContext(_Applied(precondition))
        ksp.setNormType(PETSc.KSP.NormType.UNPRECONDITIONED)
        ksp.setTolerances(rtol=tolerance, atol=0.0, divtol=1e30, max_it=MOST)
        return ksp, shell


class _Sum:
    """A matrix plus a part that is not symmetric, at free unknowns.

    Args:
        matrix: the first; part: (3 n, 3 n) the second; free: (3 n,) 1 where an unknown is free, else 0.
    """

    def __init__(self, matrix: PETSc.Mat, part: csr_matrix, free: np.ndarray) -> None:
        self.matrix, self.part, self.free = matrix, part, free

    def mult(self, mat: PETSc.Mat, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Set y to the product with x."""
        self.matrix.mult(x, y)
        y.getArray()[:] += self.free * (self.part @ (self.free * x.getArray(readonly=True)))


class _Applied:
    """A preconditioner that is a function.

    Args:
        function: of a vector, and of that to set.
    """

    def __init__(self, function: Apply) -> None:
        self.function = function

    def apply(self, pc: PETSc.PC, x: PETSc.Vec, y: PETSc.Vec) -> None:
        """Set y to what is applied to x."""
        self.function(x, y)
