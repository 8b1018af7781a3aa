"""A piece between two edits, with its model and what guidance finds of it, each found once."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from time import perf_counter

import numpy as np

from restshape.guidance.force_space import durability_space
from restshape.guidance.ranges import Ranges, predicted_ends, valid_ranges
from restshape.guidance.reconnect import reconnections
from restshape.guidance.suggestions import suggest
from restshape.guidance.support_planks import FLOOR, SupportPlank, support_planks
from restshape.physics.furniture import LOST, OVERLAPPING, UNSTABLE, WEAK, Furniture
from restshape.shape.design_modes import DesignModes
from restshape.shape.planks import FREEDOMS, Piece

REACH = 0.5
"""How far a parameter is looked at on both sides, in parts of the piece's size, or in rad."""


@dataclass(frozen=True)
class Guidance:
    """How much guidance is asked for.

    Args:
        ranges: valid ranges of the parameter under the hand.
        suggestions: shown at most; 0 looks for none.
        freedoms: of the design that a suggestion changes at most.
    """

    ranges: bool = True
    suggestions: int = 8
    freedoms: int = 3


@dataclass(frozen=True)
class Idea:
    """A suggestion of any kind.

    Args:
        words: what it does.
        direction: (n, 8) change of the design parameters by a unit of t; None: it is another piece.
        t: where it is shown.
        span: valid range of t around it.
        valid: the full test holds there; else something else is still wrong.
        piece: with one more plank; None where planks move.
    """

    words: str
    direction: np.ndarray | None
    t: float
    span: tuple[float, float]
    valid: bool
    piece: Piece | None = None


@dataclass(frozen=True)
class Ideas:
    """What was found for an invalid piece: suggestions, combinations tried, full tests, and the time taken [s]."""

    found: tuple[Idea, ...] = ()
    tried: int = 0
    tested: int = 0
    seconds: float = 0.0


@dataclass(frozen=True, eq=False)
class Way:
    """A parameter under the hand: design parameters t times `direction` of a design.

    Args:
        design: that it changes.
        direction: (n, 8).
        name: for people.
        low, high: how far it is looked at.
    """

    design: Design
    direction: np.ndarray
    name: str
    low: float
    high: float

    @cached_property
    def ranges(self) -> Ranges:
        """Where the piece is valid along it."""
        return self.design.valid_along(self)


@dataclass(eq=False)
class Design:
    """A piece as it is between two edits.

    Args:
        piece: with closed joints, as far as they can be closed.
        guidance: how much is asked for.

    Raises:
        UserError: the piece cannot be had.
    """

    piece: Piece
    guidance: Guidance = field(default_factory=Guidance)

    def __post_init__(self) -> None:
        self.furniture = Furniture(self.piece)

    @classmethod
    def closed(cls, piece: Piece, guidance: Guidance) -> Design:
        """The design of a piece whose joints are as they were drawn."""
        return cls(Furniture(piece).moved(), guidance)

    def moved(self, gamma: np.ndarray) -> Design:
        """The design at design parameters (n, 8)."""
        return Design(self.furniture.moved(gamma), self.guidance)

    @cached_property
    def freedoms(self) -> frozenset[tuple[int, int]]:
        """Plank and number of each design parameter that is valid."""
        found = frozenset((int(p), int(f)) for p, f in self.furniture.kernel.freedoms())
        self.furniture.test()
        return found

    def way(self, direction: np.ndarray, name: str, scale: float = 1.0) -> Way:
        """The way along a direction (n, 8); a unit of t changes a length by `scale` [m], or an angle by 1 rad."""
        turns = np.abs(direction[:, 3:6]).max() > 0.0
        reach = REACH if turns else REACH * self.piece.size / scale
        return Way(self, direction, name, -reach, reach)

    def parameter(self, plank: int, number: int) -> Way:
        """The way along one design parameter, in m or rad."""
        direction = np.zeros((len(self.piece.planks), 8))
        direction[plank, number] = 1.0
        return self.way(direction, f"{self.piece.planks[plank].name}: {FREEDOMS[number]}")

    def valid_along(self, way: Way) -> Ranges:
        """Where the piece is valid along a way, with ends that the force space predicts as hints."""
        self.furniture.kernel.forget()
        verdict = self.furniture.test()
        hints = None
        used = np.argwhere(way.direction != 0.0)
        if not verdict.flaws & LOST and len(self.piece.joints) and len(used):
            modes = DesignModes.of(self.piece, [tuple(one) for one in used.tolist()])
            units = np.array([modes.directions[k].reshape(-1, 8)[p, f] for k, (p, f) in enumerate(used)])
            parts = np.array([way.direction[p, f] for p, f in used]) / units
            hints = predicted_ends(durability_space(self.furniture, modes), parts)
        return valid_ranges(self.furniture, way.direction, way.low, way.high, hints=hints)

    @cached_property
    def ideas(self) -> Ideas:
        """Suggestions for a piece that is not valid; none for one that is."""
        most, start = self.guidance.suggestions, perf_counter()
        self.furniture.kernel.forget()
        flaws = self.furniture.test().flaws
        if not flaws or not most:
            return Ideas()
        if flaws & LOST:
            found = [
                Idea(one.mode, one.direction, one.t, one.span, one.flaws == 0)
                for one in reconnections(self.furniture, most)
            ]
            return Ideas(tuple(found), seconds=perf_counter() - start)
        if flaws & OVERLAPPING or not flaws & (UNSTABLE | WEAK):
            return Ideas(seconds=perf_counter() - start)
        search = suggest(self.furniture, self.guidance.freedoms, most)
        found = [Idea(" + ".join(one.words), one.direction, one.t, one.span, one.valid) for one in search.found]
        if flaws & WEAK and not flaws & UNSTABLE:
            supports = [self._supported(one) for one in support_planks(self.furniture)][:most]
            found = [*found[: most - len(supports)], *supports]
        return Ideas(tuple(found), sum(search.tried), search.tested, perf_counter() - start)

    def _supported(self, board: SupportPlank) -> Idea:
        first, other = ("the floor" if k == FLOOR else self.piece.planks[k].name for k in board.between)
        words = f"a plank between {first} and {other}"
        return Idea(words, None, 1.0, (0.0, 1.0), board.verdict.valid, board.piece)
