"""Guesses of the next step of a motion from the steps before."""

import numpy as np
from petsc4py import PETSc

from restshape import _kernels
from restshape.algebra.row_products import combined, row_products

KEPT = 3
RIDGE = 1e-10


class IncrementProjection:
    """The combination of the last increments whose forces come closest to the force of the next.

    An increment d is what the system A d = g of a step is solved for. Where A stays, this is the projection of Fischer
    (Comput. Methods Appl. Mech. Engrg. 163, 1998); where it changes a little, the kept forces are still nearly A d.

    Args:
        size: unknowns of an increment.
        rows: how many of them this rank has the forces of.
        comm: PETSc communicator.

    Attributes:
        next_force: (rows,) where the force of the next increment is put.
    """

    def __init__(self, size: int, rows: int, comm: PETSc.Comm) -> None:
        self.world = comm.tompi4py() if comm.size > 1 else None
        self.steps, self.forces = np.zeros((KEPT, size)), np.zeros((KEPT + 1, rows))
        self.gram, self._weights = np.zeros((KEPT, KEPT)), np.zeros((1, KEPT))
        self.products = np.zeros(KEPT + 1)
        self.next_force: np.ndarray = self.forces[KEPT]
        self.count = 0

    def add_to(self, guess: np.ndarray) -> None:
        """Add to `guess` (size,) what is foreseen for this rank's rows of `next_force`; collective."""
        if self.world is None:
            _kernels.guess_step(self.forces, self.gram, RIDGE, self.steps, self.products, guess)
            return
        self.products[:] = self.world.allreduce(row_products(self.forces, self.forces[KEPT:])[:, 0])
        _kernels.ridge_weights(self.gram, self.products, RIDGE, self._weights)
        guess += combined(self._weights, self.steps)[0]

    def keep(self, now: np.ndarray, before: np.ndarray) -> None:
        """Remember the increment, from `before` to `now` (n, f), that the last force led to."""
        place = self.count % KEPT
        _kernels.keep_step(now, before, self.products, place, self.steps, self.forces, self.gram)
        self.count += 1
