"""A prediction of a drape whose positions are known, and which nothing else has been asked of yet."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.relaxation.state import RelaxationState


class Postponed:
    """What a frame shows of a prediction, without stiffness, areas and friction of the pattern as it lies.

    Args:
        rest: the equilibrium that it is predicted from.
        x: (n, 3) predicted unknowns, prescribed ones as they are given.
        make: makes the state of it, with the pattern as it lies when this is made.
    """

    def __init__(self, rest: RelaxationState, x: np.ndarray, make: Callable[[], RelaxationState]) -> None:
        self.rest, self.x, self._make = rest, x, make
        self._mesh, self._X = rest.problem.mesh, rest.problem.mesh.X.copy()

    def state(self) -> RelaxationState:
        """The prediction with all that belongs to it, wherever the mesh has gone since."""
        with _nodes_at(self._mesh, self._X):
            return self._make()


@contextmanager
def _nodes_at(mesh: Mesh, X: np.ndarray) -> Iterator[None]:
    """Within it the nodes of a mesh are at X (n, 2) [m]."""
    now = None if np.array_equal(mesh.X, X) else mesh.X.copy()
    if now is not None:
        mesh.X[:] = X
    try:
        yield
    finally:
        if now is not None:
            mesh.X[:] = now
