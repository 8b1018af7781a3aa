"""A prediction of a drape whose positions are known, and which nothing else has been asked of yet."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.cloth_boundary import ClothDirichlet
from restshape.physics.cloth.cloth_supports import supports_of
from restshape.physics.cloth.initial_placement import InitialPlacement
from restshape.physics.cloth.relaxation.state import RelaxationState


class Postponed:
    """What a frame shows of a prediction, without stiffness, areas and friction of the pattern as it lies.

    Args:
        rest: the equilibrium that it is predicted from.
        values: (n, 3) predicted unknowns.
        make: makes the state of it, with the pattern as it lies when this is made.

    Attributes:
        x: (n, 3) unknowns, prescribed ones as they are given.
    """

    def __init__(self, rest: RelaxationState, values: np.ndarray, make: Callable[[], RelaxationState]) -> None:
        self.rest, self._make = rest, make
        mesh, problem = rest.problem.mesh, rest.problem
        self._mesh, self._X = mesh, mesh.X.copy()
        supports = supports_of(rest.scene, mesh, InitialPlacement(rest.scene))
        boundary = ClothDirichlet(supports, mesh, problem.corner_number, problem.n_nodes, problem.morley)
        self.x = np.where(boundary.mask, boundary.values, values)

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
