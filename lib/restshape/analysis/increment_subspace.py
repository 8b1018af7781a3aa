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
    """

    def __init__(self, size: int, rows: int, comm: PETSc.Comm) -> None:
        self.world = comm.tompi4py() if comm.size > 1 else None
        self.steps, self.forces = np.zeros((KEPT, size)), np.zeros((KEPT + 1, rows))
        self.gram, self._weights = np.zeros((KEPT, KEPT)), np.zeros((1, KEPT))
        self.count = 0

    def __call__(self, force: np.ndarray) -> np.ndarray:
        """The guess (size,) for this rank's rows of a force g; collective."""
        self.forces[KEPT] = force
        products = row_products(self.forces, self.forces[KEPT:])[:, 0]
        self.products = products if self.world is None else self.world.allreduce(products)
        _kernels.ridge_weights(self.gram, self.products, RIDGE, self._weights)
        return combined(self._weights, self.steps)[0]

    def keep(self, step: np.ndarray) -> None:
        """Remember the increment (size,) that the last force led to."""
        place = self.count % KEPT
        self.steps[place], self.forces[place] = step, self.forces[KEPT]
        self.gram[place] = self.gram[:, place] = self.products[:KEPT]
        self.gram[place, place] = self.products[KEPT]
        self.count += 1
