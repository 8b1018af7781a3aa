"""How many combinations of design modes the suggestions miss: they beside a grid of the full test."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import combinations as choose
from itertools import product

import numpy as np
from restshape_apps.furniture.guidance.suggestions import SHOWN, suggest
from restshape_apps.furniture.physics.furniture import ALL, Furniture
from restshape_apps.furniture.pieces import cantilever, scales, table
from restshape_apps.furniture.shape.design_modes import DesignModes
from restshape_apps.furniture.shape.planks import Piece
from restshape_apps.furniture.small_pieces import toppling

from restshape.guidance.combination_search import Limits
from restshape.guidance.force_space import LONGEST

POINTS = (201, 21, 9)
"""Along each mode of a grid of one mode, of pairs and of triples."""

MANY = 10**6
UNLIMITED = Limits(trials=MANY, kept=0, glances=0, mended=MANY, continued=MANY)
FIRST_ONLY = Limits(trials=MANY, kept=0, glances=0, mended=0, continued=0)
"""All rays by derivatives at the piece as it is, and no direction looked for again."""

SMALL: dict[str, Callable[[], Piece]] = {
    "cantilever": lambda: cantilever(kilograms=1.8),
    "long cantilever": lambda: cantilever(width=0.1, arm=0.3, kilograms=1.3),
    "cantilever, 2 kg": lambda: cantilever(kilograms=2.0),
    "cantilever, 2.8 kg": lambda: cantilever(kilograms=2.8),
    "scales": scales,
    "cantilever that falls": toppling,
}
"""Invalid pieces of at most four planks."""

LARGER: dict[str, Callable[[], Piece]] = {"table": table}
"""Pieces of which grids of single modes and pairs alone are made."""


@dataclass(frozen=True)
class Misses:
    """What a grid finds and a search does not, by the number of modes: one, two, three.

    Args:
        there: sets of modes that the grid makes valid; none holds a smaller one that it makes valid.
        missed: those of them that no suggestion has.
        beyond: suggestions that the grid has not: its points are too far apart.
    """

    there: tuple[int, ...]
    missed: tuple[int, ...]
    beyond: int

    @property
    def rate(self) -> float:
        """The part of what the grid finds that no suggestion has."""
        return sum(self.missed) / max(sum(self.there), 1)


@dataclass(frozen=True)
class Grid:
    """What a grid of the full test makes valid in an invalid piece of few planks.

    Args:
        piece: that is looked at.
        modes: how many it has.
        ways: sets of one, two and three modes that make it valid; none holds a smaller one.
    """

    piece: Piece
    modes: int
    ways: tuple[frozenset[tuple[int, ...]], ...]

    @classmethod
    def of(cls, piece: Piece, points: tuple[int, ...] = POINTS) -> "Grid":
        """All sets of modes of a piece, as far as suggestions go; `points` along each mode by the number of modes."""
        furniture = Furniture(piece)
        furniture.test()
        modes = DesignModes.of(piece, furniture.kernel.freedoms())
        found: list[frozenset[tuple[int, ...]]] = []
        for count, several in enumerate(points, 1):
            line = np.linspace(-LONGEST, LONGEST, several)
            places = np.array([p for p in product(line, repeat=count) if all(p) and np.linalg.norm(p) <= LONGEST])
            # What is near is more likely to keep all joints.
            places = places[np.argsort(np.linalg.norm(places, axis=1), kind="stable")]
            found.append(
                frozenset(
                    some
                    for some in choose(range(len(modes)), count)
                    if not any(set(less) <= set(some) for smaller in found for less in smaller)
                    and _somewhere(furniture, modes, np.array(some), places)
                )
            )
        furniture.test()
        return cls(piece, len(modes), tuple(found))

    def beside(self, limits: Limits | None = None, shown: int = MANY) -> Misses:
        """What a search misses.

        Args:
            limits: of the search; default: those of `suggest`.
            shown: suggestions at most.
        """
        found = {one.modes for one in suggest(Furniture(self.piece), len(POINTS), shown, limits).found}
        there, missed = (tuple(len(ways - less) for ways in self.ways) for less in (set(), found))
        return Misses(there, missed, sum(len(some) <= len(self.ways) for some in found - frozenset().union(*self.ways)))

    def as_shown(self) -> Misses:
        """What the search of an edit misses, with its limits and as many suggestions as it shows."""
        return self.beside(None, SHOWN)


def _somewhere(furniture: Furniture, modes: DesignModes, some: np.ndarray, places: np.ndarray) -> bool:
    """Whether the full test holds at one of the places (p, k) of a few modes."""
    whole = np.stack([modes.direction(np.array([k]), np.array([1.0])) for k in some])
    return any(furniture.test(gamma, ALL, True).valid for gamma in np.tensordot(places, whole, 1))
