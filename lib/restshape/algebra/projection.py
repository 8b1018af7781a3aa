"""Guesses made better by the solutions before: the nearest point, in energy, along their differences."""

import numpy as np
from petsc4py import PETSc

RIDGE = 1e-12


class Projection:
    """Adds to a guess what the last increments of the solution can still explain of the right side.

    Args:
        comm: PETSc communicator.
        directions: how many increments are kept.

    Source: P. F. Fischer, Projection techniques for iterative solution of A x = b with successive right-hand sides, 1998;
        here A changes too, so that the products with it are made anew, all in one pass over A.
    """

    def __init__(self, comm: PETSc.Comm, directions: int) -> None:
        self.comm, self.directions = comm, directions
        self.steps: np.ndarray | None = None
        self.last: np.ndarray | None = None
        self.count = 0

    def restart(self) -> None:
        """Forget the solutions: the unknowns are others now."""
        self.last, self.count = None, 0

    def __call__(self, mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Move the guess x to where its error is least in the energy norm of `mat` along the increments."""
        if self.count == 0:
            return
        mat.mult(x, self.residual)
        self.residual.aypx(-1.0, b)
        mat.matMult(self.block, self.products)
        used = min(self.count, self.directions)
        steps = self.steps[:used]
        product = self.products.getDenseArray(readonly=True).T[:used]
        system = np.column_stack([steps @ product.T, steps @ self.residual.getArray(readonly=True)])
        if self.comm.size > 1:
            system = self.comm.tompi4py().allreduce(system)
        gram, right = system[:, :used], system[:, used]
        scale = np.sqrt(np.abs(np.diagonal(gram)))
        if not scale.all():
            return
        gram = gram / np.multiply.outer(scale, scale)
        gram.flat[:: used + 1] += RIDGE
        weights = np.linalg.solve(gram, right / scale) / scale
        if np.isfinite(weights).all():
            x.getArray()[:] += weights @ steps
            x.stateIncrease()

    def keep(self, mat: PETSc.Mat, x: PETSc.Vec) -> None:
        """Remember the solution x of a system with the matrix `mat`."""
        now = x.getArray(readonly=True)
        if self.last is None:
            if self.steps is None or self.steps.shape[1] != len(now):
                self._allocate(mat, x)
            self.steps[:] = 0.0
            self.last = now.copy()
            return
        step = self.steps[self.count % self.directions]
        np.subtract(now, self.last, out=step)
        self.last[:] = now
        moved = step.any()
        if self.comm.size > 1:
            moved = self.comm.tompi4py().allreduce(int(moved)) > 0
        self.count += bool(moved)

    def _allocate(self, mat: PETSc.Mat, x: PETSc.Vec) -> None:
        (rows, whole), m = x.getSizes(), self.directions
        self.steps = np.zeros((m, rows))
        self.residual = x.duplicate()
        own = m if self.comm.rank == 0 else 0
        size = ((rows, whole), (own, m))
        self.block = PETSc.Mat().createDense(size, array=self.steps.ravel(), comm=self.comm)
        self.block.assemble()
        self.products = mat.matMult(self.block)
