"""How many combinations of design modes the suggestions miss: they beside a grid of the full test."""

from dataclasses import dataclass
from itertools import combinations as choose

import numpy as np

from restshape.guidance.force_space import LONGEST
from restshape.guidance.suggestions import suggest
from restshape.physics.furniture import ALL, Furniture
from restshape.shape.design_modes import DesignModes
from restshape.shape.planks import Piece

POINTS = 21
MANY = 10**6


@dataclass(frozen=True)
class Misses:
    """What a grid and suggestions find.

    Args:
        modes: of the piece.
        single, pairs: sets of modes that a grid makes valid; pairs hold no mode that works alone.
        single_missed, pairs_missed: those of them that no suggestion has.
        beyond: suggestions of one or two modes that the grid has not: its points are too far apart.
    """

    modes: int
    single: int
    single_missed: int
    pairs: int
    pairs_missed: int
    beyond: int

    @property
    def there(self) -> int:
        """What the grid finds."""
        return self.single + self.pairs

    @property
    def missed(self) -> int:
        """What of it no suggestion has."""
        return self.single_missed + self.pairs_missed

    @property
    def rate(self) -> float:
        """The part of what the grid finds that no suggestion has."""
        return self.missed / max(self.there, 1)


def misses(piece: Piece, points: int = POINTS, mended: int = MANY) -> Misses:
    """How many single modes and pairs of an invalid piece suggestions miss, with no limit of trials.

    Args:
        piece: of few planks: all pairs of its modes are tested on a grid.
        points: of the grid along each mode; those that lie further away than suggestions go are left out.
        mended: as in `suggest`.
    """
    furniture = Furniture(piece)
    furniture.test()
    modes = DesignModes.of(piece, furniture.kernel.freedoms())
    every = suggest(furniture, most=2, shown=MANY, trials=MANY, kept=0, mended=mended).found
    found = {tuple(one.modes) for one in every}
    grid = np.linspace(-LONGEST, LONGEST, points)
    whole = [modes.direction(np.array([k]), np.array([1.0])) for k in range(len(modes))]
    alone = {(k,) for k in range(len(modes)) if (furniture.kernel.scan(whole[k], grid, ALL)[0] == 0).any()}
    pairs = {
        (a, b)
        for a, b in choose(range(len(modes)), 2)
        if not {(a,), (b,)} & alone and _somewhere(furniture, whole[a], whole[b], grid)
    }
    return Misses(
        len(modes), len(alone), len(alone - found), len(pairs), len(pairs - found), len(found - alone - pairs)
    )


def _somewhere(furniture: Furniture, one: np.ndarray, other: np.ndarray, grid: np.ndarray) -> bool:
    """Whether the full test holds at a point of a grid over two modes."""
    places = ((s, t) for s in grid for t in grid if np.hypot(s, t) <= LONGEST)
    return any(furniture.test(s * one + t * other, ALL, True).valid for s, t in places)
