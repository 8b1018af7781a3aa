"""Guesses made better by the solutions before: the nearest point, in energy, along their last increments."""

from collections.abc import Callable

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.arrays import Reals

RIDGE = 1e-12


class Projection:
    """Adds to a guess what the last increments of the solution can still explain of the right side.

    Args:
        comm: PETSc communicator.
        directions: how many increments are kept.

    Attributes:
        pays: what it saves is more than what it costs; callers say so.

    Source: P. F. Fischer, Projection techniques for iterative solution of A x = b with successive right-hand sides,
        1998; here A changes too, so that the products with it are rebuilt.
    """

    def __init__(self, comm: PETSc.Comm, directions: int) -> None:
        self.comm, self.directions, self.pays = comm, directions, False
        self.last: Reals | None = None
        self.count = 0
        self.vectors: list[PETSc.Vec] = []

    def restart(self) -> None:
        """Forget the solutions: the unknowns are others now."""
        self.last, self.count = None, 0

    def __call__(self, mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec) -> None:
        """Move the guess x to where its error is least in the energy norm of `mat` along the increments."""
        used = min(self.count, self.directions)
        if used == 0:
            return
        steps = self.steps[:used]
        gram, right = self._energies(mat, b, x, steps)
        scale = np.sqrt(np.abs(np.diagonal(gram)))
        if not scale.all():
            return
        gram = gram / np.multiply.outer(scale, scale)
        gram.flat[:: used + 1] += RIDGE
        weights = np.linalg.solve(gram, right / scale) / scale
        if np.isfinite(weights).all():
            now = x.getArray()
            _kernels.weighted_sum([*weights, 1.0], [*steps, now], now)
            x.stateIncrease()

    def _energies(self, mat: PETSc.Mat, b: PETSc.Vec, x: PETSc.Vec, steps: Reals) -> tuple[Reals, Reals]:
        """The products steps . A steps (m, m), and those of steps (m, n) with the residual (m,)."""
        used = len(steps)
        gram, right = np.empty((used, used)), np.empty(used)
        now, force = x.getArray(readonly=True), b.getArray(readonly=True)
        if self.comm.size == 1 and _kernels.energy_products(mat.handle, now, force, steps, gram, right):
            return gram, right
        mat.mult(x, self.residual)
        self.residual.aypx(-1.0, b)
        for step, product in zip(self.step_vectors[:used], self.product_vectors):
            mat.mult(step, product)
        gram, right = steps @ self.products[:used].T, steps @ self.residual.getArray(readonly=True)
        if self.comm.size > 1:
            whole = self.comm.tompi4py().allreduce(np.column_stack([gram, right]))
            gram, right = whole[:, :used], whole[:, used]
        return gram, right

    def keep(self, x: PETSc.Vec) -> None:
        """Remember the solution x."""
        now = x.getArray(readonly=True)
        if self.last is None:
            self._allocate(x)
            self.last = now.copy()
            return
        place = self.count % self.directions
        moved = _kernels.take_increment(now, self.last, self.steps[place])
        self.step_vectors[place].stateIncrease()
        # Where nothing has moved, the place serves the next increment.
        self.count += moved if self.comm.size == 1 else any(self.comm.tompi4py().allgather(moved))

    def interpolate(self, interpolate: Callable[[Reals], Reals]) -> None:
        """Take solutions where their nodes are now, by a function of rows (n f,); several ranks forget them."""
        if self.comm.size > 1 or self.last is None:
            self.restart()
            return
        for row, vector in zip((self.last, *self.steps), (None, *self.step_vectors)):
            row[:] = interpolate(row)
            if vector:
                vector.stateIncrease()

    def _allocate(self, x: PETSc.Vec) -> None:
        for vector in self.vectors:
            vector.destroy()
        size, m = x.getSizes(), self.directions
        self.steps, self.products = np.zeros((m, size[0])), np.zeros((m, size[0]))
        self.step_vectors, self.product_vectors = (
            [PETSc.Vec().createWithArray(row, size=size, comm=self.comm) for row in rows]
            for rows in (self.steps, self.products)
        )
        self.residual = x.duplicate()
        self.vectors = [*self.step_vectors, *self.product_vectors, self.residual]
