"""Suggestions for a piece that holds, but is doubtful or has a quantity beyond its limit."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from textwrap import shorten

import numpy as np
from restshape_apps.furniture.guidance.clear_range import range_end
from restshape_apps.furniture.guidance.doubts import depends, doubts, free
from restshape_apps.furniture.guidance.lengthening import rejoined, worse_if_joined
from restshape_apps.furniture.guidance.preferences import kept_modes
from restshape_apps.furniture.guidance.quantity_limits import violated_limits
from restshape_apps.furniture.guidance.remedies import Thickened, as_thick, remedies
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
TESTS, COMPLIANCES, BENDING = 5000, 10, 8
"""Pieces looked at in a search, over the number of planks, and what one counts besides whose compliances vary, or whose
planks bend."""
END = 1e-4
"""How well the end of a range is known, in parts of how far a suggestion may go."""
SMALL = 1e-6
"""Change of what is wrong, in parts of it, of a freedom that is not looked at the other way."""
WHY = 220
"""Letters at most of why free ends are not joined."""
LARGEST = 1e3
"""Of what one finding counts: a single fastener bears no twist at all."""

Matter = tuple[str, tuple[str, ...]]


class DoubtMends:
    """What mends a piece that holds, but is not beyond doubt: free ends joined, what is no other drawing, and single
    freedoms with what follows them.

    Args:
        furniture: the model of the piece, which holds.
        quantities: of its scene, by name.
        keep: locks, as in `[effects.guidance]`.
        far: how far a freedom is looked at, in parts of the piece.
        thickened: what gives all planks another thickness.
        bending: whether planks bend.
    """

    def __init__(
        self,
        furniture: Furniture,
        quantities: Mapping[str, Quantity],
        keep: Sequence[str],
        far: float,
        thickened: Thickened = as_thick,
        bending: bool = False,
    ) -> None:
        self.furniture, self.quantities, self.keep, self.far = furniture, quantities, keep, far
        self.thickened, self.bending = thickened, bending
        self.doubts = doubts(furniture.moved(), quantities, bending)
        self.matters = list(dict.fromkeys(map(_matter, self.doubts)))
        # Ends that are free already are joined.
        self.goal = {one for one in self.matters if one[0] != FREE}
        self.tried = self.tests = self.freedoms = self.most = 0
        self.idle = False

    def found(self) -> list[Suggestion]:
        """Free ends joined, and what leaves it beyond doubt; without any, what ends one of several doubts."""
        if not self.doubts:
            return []
        found = [Suggestion.of(one) for one in rejoined(self.furniture.moved())]
        mends = self._mends() if self.goal else []
        if not mends and len(whole := self.goal) > 1:
            for one in [one for one in self.matters if one in whole]:
                self.goal = {one}
                mends += self._mends()
        self.furniture.test()
        return found + mends

    def _mends(self) -> list[Suggestion]:
        """Other fasteners, other thicknesses and single freedoms that reach the goal."""
        self.most = self.tests + TESTS // len(self.furniture.piece.planks)
        others = remedies(self.furniture.moved(), self._clear, True, self.thickened)
        return [*map(Suggestion.by, others), *self._freedoms()]

    def why(self) -> str:
        """Why nothing is found."""
        kinds = {one.kind for one in self.doubts}
        if kinds <= {FREE}:
            if worse := worse_if_joined(self.furniture.moved()):
                said = "; ".join(f"{done}, does not hold: {then}" for done, then in worse.values())
                return shorten(said, WHY, placeholder=" ...")
            return "no free end meets its face by its length or a move beside it: draw its plank elsewhere, or leave it"
        limits = [one.subjects[0] for one in self.doubts if one.kind == LIMIT]
        doubt = ["ends a doubt"] if len(limits) < len(self.doubts) else []
        goal = " or ".join([*doubt, *(f"brings {one} within its limit" for one in limits)])
        looked = f"{self.freedoms} freedoms, each alone, fasteners and thicknesses tried"
        return f"{looked}: none {goal}" + ("; the search was cut short" if self.tests >= self.most else "")

    def _clear(self, piece: Piece) -> bool:
        return not self._left(doubts(piece, self.quantities, self.bending))

    def _counting(self) -> dict[str, Quantity]:
        """The quantities with a limit that is of the goal, or was kept before."""
        limited = {name: one for name, one in self.quantities.items() if one.max is not None or one.min is not None}
        return {name: one for name, one in limited.items() if self._counts((LIMIT, (name,)))}

    def _counts(self, matter: Matter) -> bool:
        """Whether what is doubtful counts: it is of the goal, or was not so before."""
        return matter in self.goal or matter not in self.matters

    def _left(self, found: Sequence[Finding]) -> list[Finding]:
        """What counts of what is doubtful."""
        return [one for one in found if self._counts(_matter(one))]

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
            elif self.idle:
                return

    def _span(self, direction: np.ndarray) -> tuple[float, float] | None:
        """The nearest range along a direction in which nothing is doubtful; None: there is none as far as is seen."""

        def clear(t: float) -> bool:
            return self._excess(t * direction) == 0.0

        places, start, self.idle = [self.far * part for part in PLACES], _excess(self._left(self.doubts)), False
        before = 0.0
        for k, t in enumerate(places):
            excess = self._excess(t * direction)
            if excess == 0.0:
                low = range_end(clear, t, before, END * self.far)
                return low, self._last(clear, t, places[k + 1 :])
            if not np.isfinite(excess) or self.tests >= self.most or (k + 1 >= FIRST and excess >= start):
                self.idle = abs(excess - start) <= SMALL * start
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
        counting = self._counting()
        self.tests += 1 + (BENDING if self.bending or any(one.deflection for one in counting.values()) else 0)
        piece = self.furniture.moved(gamma)
        result = Furniture(piece).test()
        if not result.valid:
            return np.inf
        left = self._left((*result.doubts, *violated_limits(piece, counting, self.bending)))
        if not left or (DEPENDS, ()) in self.goal:
            self.tests += COMPLIANCES
            left += self._left((*free(piece), *depends(piece)))
        return _excess(left)


def _matter(one: Finding) -> Matter:
    """What a finding is of: the limit of a quantity, or a kind of doubt."""
    return one.kind, one.subjects if one.kind == LIMIT else ()


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
