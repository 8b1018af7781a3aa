"""Suggestions for a piece that holds, but is doubtful or has a quantity beyond its limit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
from restshape_apps.furniture.guidance.clear_range import range_end
from restshape_apps.furniture.guidance.doubts import depends, doubts, free
from restshape_apps.furniture.guidance.lengthening import rejoined
from restshape_apps.furniture.guidance.preferences import kept_modes
from restshape_apps.furniture.guidance.quantity_limits import violated_limits
from restshape_apps.furniture.guidance.remedies import remedies
from restshape_apps.furniture.guidance.suggested import Suggestion
from restshape_apps.furniture.physics.furniture import Furniture
from restshape_apps.furniture.physics.plank_findings import DEPENDS, DOUBTFUL, FREE
from restshape_apps.furniture.shape.planks import Piece

from restshape.findings import Finding
from restshape.guidance.combination_search import REPRESENTED
from restshape.replay.constraints import LIMIT
from restshape.scene.model import Quantity

PLACES = (1 / 64, 1 / 32, 1 / 16, 1 / 8, 1 / 4, 1 / 2, 1.0)
"""Where a freedom is looked at, in parts of how far a suggestion may go."""
FIRST = 3
"""Places after which a freedom that has not lessened what is wrong is given up."""
TESTS = 4000
"""Pieces that are looked at in a search, over the number of planks."""
END = 1e-4
"""How well the end of a range is known, in parts of how far a suggestion may go."""
LARGEST = 1e3
"""Of what one finding counts: a single fastener bears no twist at all."""


class DoubtMends:
    """What mends a piece that holds, but is not beyond doubt: free ends joined, what is no other drawing, and single
    freedoms with what follows them.

    Args:
        furniture: the model of the piece, which holds.
        quantities: of its scene, by name.
        keep: locks, as in `[effects.guidance]`.
        far: how far a freedom is looked at, in parts of the piece.
    """

    def __init__(
        self, furniture: Furniture, quantities: Mapping[str, Quantity], keep: Sequence[str], far: float
    ) -> None:
        self.furniture, self.quantities, self.keep, self.far = furniture, quantities, keep, far
        self.doubts = doubts(furniture.moved(), quantities)
        self.tried = self.tests = self.freedoms = 0
        self.most = TESTS // len(furniture.piece.planks)

    def found(self) -> list[Suggestion]:
        """All that leave it beyond doubt, but for ends that are free already, and free ends joined."""
        if not self.doubts:
            return []
        piece, kinds = self.furniture.moved(), {one.kind for one in self.doubts}
        found = [Suggestion.of(one) for one in rejoined(piece)]
        if kinds != {FREE}:
            found += [Suggestion.by(one) for one in remedies(piece, self._clear, strict=True)]
            found += self._freedoms()
        self.furniture.test()
        return found

    def why(self) -> str:
        """Why nothing is found."""
        kinds = {one.kind for one in self.doubts}
        if kinds <= {FREE}:
            return "no free end meets its face by its length or a move beside it: draw its plank elsewhere, or leave it"
        limits = [one.subjects[0] for one in self.doubts if one.kind == LIMIT]
        goal = f"brings {' and '.join(limits)} within limits" if len(limits) == len(self.doubts) else "ends the doubt"
        looked = f"{self.freedoms} freedoms, each alone, fasteners and thicknesses tried"
        return f"{looked}: none {goal}" + ("; the search was cut short" if self.tests >= self.most else "")

    def _clear(self, piece: Piece) -> bool:
        return not self._left(doubts(piece, self.quantities))

    def _left(self, found: Sequence[Finding]) -> list[Finding]:
        """What counts of what is doubtful: free ends do where there was none, and are joined where there was."""
        had = any(one.kind == FREE for one in self.doubts)
        return [one for one in found if not had or one.kind != FREE]

    def _freedoms(self) -> list[Suggestion]:
        """Single freedoms, first of those that keep symmetry and level, until some mend it."""
        for modes in kept_modes(self.furniture, self.keep):
            found: list[Suggestion] = []
            self.freedoms = max(self.freedoms, len(modes))
            for k in range(len(modes)):
                self.tried += 1
                found += self._along(modes.direction(np.array([k]), np.ones(1)))
            if found:
                return found
        return []

    def _along(self, direction: np.ndarray) -> Iterator[Suggestion]:
        """The nearest range of a freedom (n, 8) in which nothing is doubtful, in each sense."""
        for sense in (direction, -direction):
            span = self._span(sense)
            if span:
                t = span[0] + REPRESENTED * (span[1] - span[0])
                yield Suggestion.along(self.furniture.piece, sense, t, span, span[1] >= self.far, True)

    def _span(self, direction: np.ndarray) -> tuple[float, float] | None:
        """The nearest range along a direction in which nothing is doubtful; None: there is none as far as is seen."""

        def clear(t: float) -> bool:
            return self._excess(t * direction) == 0.0

        places, start = [self.far * part for part in PLACES], _excess(self._left(self.doubts))
        before = 0.0
        for k, t in enumerate(places):
            excess = self._excess(t * direction)
            if excess == 0.0:
                low = range_end(clear, t, before, END * self.far)
                return low, self._last(clear, t, places[k + 1 :])
            if not np.isfinite(excess) or self.tests >= self.most or (k + 1 >= FIRST and excess >= start):
                return None
            before = t
        return None

    def _last(self, clear: Callable[[float], bool], inside: float, places: Sequence[float]) -> float:
        """The last place from inside on where nothing is doubtful, or the last one that is looked at."""
        for t in places:
            if not clear(t):
                return range_end(clear, inside, t, END * self.far)
            inside = t
        return inside

    def _excess(self, gamma: np.ndarray) -> float:
        """How much is doubtful at design parameters (n, 8); infinite where the piece does not hold."""
        self.tests += 1
        piece = self.furniture.moved(gamma)
        result = Furniture(piece).test()
        if not result.valid:
            return np.inf
        found = (*result.doubts, *violated_limits(piece, self.quantities))
        # Compliances cost ten equilibria.
        if not found or any(one.kind == DEPENDS for one in self.doubts):
            found += (*free(piece), *depends(piece))
        return _excess(self._left(found))


def _excess(findings: Sequence[Finding]) -> float:
    """By how much findings are beyond their bounds, in parts of these; 0 without any."""
    total = 0.0
    for one in findings:
        value, bound = one.value or 0.0, one.bound or 0.0
        # The bound of what compliances decide is the least utilisation, that of a free end no goal.
        bound = 1.0 if one.kind in (DEPENDS, DOUBTFUL) else bound
        over = abs(value - bound) / max(abs(bound), 1e-12)
        total += 1.0 if one.kind == FREE else min(max(over, 1e-12), LARGEST)
    return total
