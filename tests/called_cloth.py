"""What frames of cloth without an effect may call, from first principles: nothing else is to be found in them.

How many steps cloth takes to rest is not known beforehand. But its residual is one pass over the triangles and one over
what bends; each tangent is one over the triangles, beside that of bending, which is constant and made once a frame; and
points take part where descents have inertia, or bodies are near. The first frame falls with hinges, which Morley's
triangles go on from.
"""

from itertools import pairwise
from typing import Any

import numpy as np
from called import NEVER, pairs

Row = dict[str, Any]
HINGE = "hinge_flap4"
STABILISED, TRUE, POINT = "membrane_stabilised_tri3", "membrane_tri3", "potential_point1"


class ClothLaw:
    """What is called for a scene of cloth, whose effects are read off its text.

    Args:
        text: of the scene.
        cells: (ne, 3) of the cloth at the start; nodes: how many there are.
    """

    def __init__(self, text: str, cells: np.ndarray, nodes: int) -> None:
        self.hinged, self.touched = 'bending = "hinge"' in text, "[effects.contact]" in text
        self.cells, self.nodes, edges = len(cells), nodes, pairs(cells)
        opposite = across(cells)
        self.sizes = {POINT: nodes, HINGE: len(opposite)}
        if self.hinged:
            self.bending = HINGE
            both = np.unique(np.sort(np.concatenate([sides(cells), opposite]), axis=1), axis=0)
            self.unknowns, self.entries = 3 * nodes, 9 * (nodes + 2 * len(both))
            return
        # Each edge bears a slope. It meets its ends, of each of its cells the opposite corner, and the other two sides.
        self.bending, self.unknowns = "morley_tri6", 3 * (nodes + edges)
        self.entries = 9 * (nodes + edges + 2 * (edges + 2 * edges + 3 * len(cells) + 3 * len(cells)))

    def hold(self, rows: list[Row]) -> None:
        """Hold the first frame and those of level 1 against what they may do."""
        moved = [row for row in rows if row["level"] == 1]
        assert moved and rows[0]["level"] == 3
        for row in (rows[0], *moved):
            found = (row["unknowns"], row["elements"], row["entries"])
            assert found == (self.unknowns, self.cells, self.entries)
            assert row["events"]["RestshapePattern"] == ((1 if self.hinged else 2) if row is rows[0] else 0)
            assert not any(row["events"][name] for name in NEVER) and not row["events"]["EPSSolve"]
            self._hold_calls(row, row is rows[0])

    def _hold_calls(self, row: Row, first: bool) -> None:
        """Hold the calls of kernels in a frame."""
        calls = row["calls"]
        bent = {self.bending, HINGE} if first else {self.bending}
        assert set(calls) <= {TRUE, STABILISED, POINT} | bent
        for name, purposes in calls.items():
            for times, elements in purposes.values():
                assert elements == times * self.sizes.get(name, self.cells)

        def times(name: str, purpose: str) -> int:
            return calls.get(name, {}).get(purpose, (0, 0))[0]

        for purpose in ("residual", "energy"):
            assert times(TRUE, purpose) == sum(times(name, purpose) for name in bent) > 0
            assert not times(STABILISED, purpose) and not times(POINT, purpose)
        assert {purpose for purposes in calls.values() for purpose in purposes} <= {"residual", "energy", "tangent"}
        stabilised, true = (times(name, "tangent") for name in (STABILISED, TRUE))
        kept = sum(times(name, "tangent") for name in bent)
        # The first frame softens the membrane on its way, and restarts with each softness.
        assert kept >= 1 if first else kept == 1
        assert stabilised + true + kept == row["events"]["RestshapeValues"]
        inert = times(POINT, "tangent")
        # A saddle of the energy, which only the first frame meets, is left by a mode of the true tangent with inertia.
        assert stabilised <= inert <= stabilised + true if first else inert == stabilised + true * self.touched


def sides(cells: np.ndarray) -> np.ndarray:
    """Pairs (3 ne, 2) of nodes along the sides of triangles."""
    closed = np.column_stack([cells, cells[:, 0]])
    return np.concatenate([closed[:, [a, b]] for a, b in pairwise(range(4))])


def across(cells: np.ndarray) -> np.ndarray:
    """Pairs (m, 2) of corners opposite to each inner edge."""
    met: dict[frozenset[int], list[int]] = {}
    for cell in cells.tolist():
        for k in range(3):
            met.setdefault(frozenset((cell[k], cell[(k + 1) % 3])), []).append(cell[(k + 2) % 3])
    return np.array([corners for corners in met.values() if len(corners) == 2])
