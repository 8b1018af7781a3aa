"""A problem on the next richer space, to which a solution is brought."""

from collections.abc import Callable

import numpy as np

from restshape.fem.problem import SteadyProblem
from restshape.mesh.enriched_space import EnrichedSpace
from restshape.mesh.lagrange_space import LagrangeSpace
from restshape.mesh.mesh import Mesh


class Enrichment:
    """The same problem on an `EnrichedSpace`: with curved sides met closer, and loads sampled better.

    Args:
        space: that the problem is solved on; its nodes may move, its edges may not flip.
        make: makes the problem on another space.
    """

    def __init__(self, space: Mesh | LagrangeSpace, make: Callable[[LagrangeSpace], SteadyProblem]) -> None:
        self.over = EnrichedSpace(space)
        self.problem = make(self.over.space)

    def follow(self) -> None:
        """Go where the nodes of the space are, which have moved."""
        self.over.follow()
        self.problem.update()

    def pose(self, make: Callable[[LagrangeSpace], SteadyProblem]) -> None:
        """Take another problem on the same space, as its nodes lie now."""
        self.over.follow()
        self.problem = make(self.over.space)

    def unknowns(self, x: np.ndarray) -> np.ndarray:
        """Unknowns (n, f) of the space at the nodes (m, f) of the richer one; prescribed ones as they are there."""
        boundary = self.problem.boundary
        return np.where(boundary.mask, boundary.values, self.over.prolonged(x))
