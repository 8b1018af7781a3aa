"""Which parts of cloth may come near each other on the way of a step."""

from __future__ import annotations

from typing import Any

import numpy as np

from restshape import _kernels
from restshape.physics.cloth.contact.collision_surface import CollisionSurface

SPARE = 1e-3
"""Part by which what is kept of a step reaches farther than searches on it do."""


LONGER = 4.0
"""Factor from one part of a step that meets nothing to the next."""


class NearPairs:
    """Candidates of collisions, kept while they hold all that is nearer than a distance.

    Args:
        surface: of the cloth.
        distance: within which pairs must be found [m].
        reach: within which they are searched for [m]; the farther, the longer they may be kept.

    Attributes:
        searches: how many there were; none: the last one has found nothing.
    """

    def __init__(self, surface: CollisionSurface, distance: float, reach: float) -> None:
        self.surface, self.distance, self.reach = surface, distance, reach
        self.searches, self.none = 0, False
        self._start, self._found = np.zeros((0, 3)), None
        # About as long as an edge: farther, and each part comes by many others.
        self._short = float(np.ptp(surface.flat[:, :2], axis=0).max()) / len(surface.cells) ** 0.5
        self._search = _kernels.NearPairs(surface.flat[:, :2], surface.edges, surface.cells)
        if surface.sewn is not None:
            self._search.sew(*surface.sewn)

    def at(self, x: np.ndarray) -> Any:
        """The library's `Candidates` at x (n, 3) [m]."""
        if not self._holds(x):
            library, self.searches = self.surface.library, self.searches + 1
            self._start, self._found = x.copy(), library.Candidates()
            edge_edge, cell_node = self._search.search(x, self.reach)
            self.none = not (len(edge_edge) or len(cell_node))
            self._found.ee_candidates = [library.EdgeEdgeCandidate(*pair) for pair in edge_edge.tolist()]
            self._found.fv_candidates = [library.FaceVertexCandidate(*pair) for pair in cell_node.tolist()]
        return self._found

    def step_share(self, x: np.ndarray, d: np.ndarray) -> float:
        """The share of a step d (n, 3) from x (n, 3) [m] on which nothing meets.

        Long steps mostly meet something soon: their first part is looked at first, where few parts are near.
        """
        reach = (1.0 + SPARE) * self.reach
        longest = float(np.abs(d - d.mean(axis=0)).max())
        part = min(1.0, self._short / longest) if longest else 1.0
        while part < 1.0:
            share = self._search.step_share(x, part * d, reach)
            if share < 1.0:
                return part * share
            part *= LONGER
        return self._search.step_share(x, d, reach)

    def _holds(self, x: np.ndarray) -> bool:
        """Whether what is known holds all that is near at positions x (n, 3)."""
        if self._found is None or x.shape != self._start.shape:
            return False
        # Motions of all of the cloth together bring nothing nearer.
        return 2.0 * _kernels.farthest_apart(self._start, x) + self.distance <= self.reach
