"""How a drawing in true size is spread over sheets of paper that overlap."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from typing import NamedTuple

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError

PAPERS = {"a4": (210.0, 297.0), "a3": (297.0, 420.0), "letter": (215.9, 279.4)}
"""Width and height [mm]."""
EDGE = 10.0
"""Width of the border that no printer prints on [mm]."""
OVERLAP = 10.0
"""By how much sheets lie over each other [mm]."""
MOST = 1000
"""Sheets at most."""


class Tile(NamedTuple):
    """A sheet by its place, counted from below and from the left."""

    row: int
    column: int

    @property
    def name(self) -> str:
        """Its row as a letter, its column from 1."""
        letters, row = "", self.row
        while row >= 0:
            letters, row = chr(ord("A") + row % 26) + letters, row // 26 - 1
        return f"{letters}{self.column + 1}"


@dataclass(frozen=True)
class TileGrid:
    """Sheets over a drawing.

    Args:
        paper: key of `PAPERS`; low, high: (2,) corners of the drawing [mm].
    """

    paper: str
    low: Reals
    high: Reals

    @property
    def printed(self) -> Reals:
        """Width and height (2,) that are printed on a sheet [mm]."""
        return np.array(PAPERS[self.paper]) - 2.0 * EDGE

    @property
    def step(self) -> Reals:
        """From a sheet to the next ones (2,) [mm]."""
        return self.printed - OVERLAP

    @property
    def count(self) -> tuple[int, int]:
        """Rows and columns.

        Raises:
            UserError: there are too many sheets.
        """
        x, y = ((self.high - self.low - OVERLAP) / self.step).tolist()
        columns, rows = max(ceil(x - 1e-9), 1), max(ceil(y - 1e-9), 1)
        if rows * columns > MOST:
            what = f"the pattern would take {rows * columns} sheets, more than {MOST}"
            raise UserError(what, "--tiles", "check the units of the pattern, or take a3")
        return rows, columns

    def corner(self, tile: Tile) -> Reals:
        """The lower left corner (2,) of what a sheet prints, in the drawing [mm]."""
        return self.low + self.step * (tile.column, tile.row)

    def tiles(self, lines: list[Reals]) -> list[Tile]:
        """The sheets on which any of the lines (m, 2) [mm] is, from the upper left to the lower right."""
        rows, columns = self.count
        starts, ends = (np.concatenate([line[part] for line in lines]) for part in (slice(-1), slice(1, None)))
        all_tiles = [Tile(row, column) for row in reversed(range(rows)) for column in range(columns)]
        return [tile for tile in all_tiles if _meets(starts, ends, self.corner(tile), self.printed)]


def _meets(starts: Reals, ends: Reals, low: Reals, size: Reals) -> bool:
    """Whether any of some segments (n, 2) meets a box, by the parts of them within its slabs."""
    first, last = np.zeros(len(starts)), np.ones(len(starts))
    way = ends - starts
    for axis in range(2):
        along = np.where(way[:, axis] == 0.0, 1.0, way[:, axis])
        near, far = ((low[axis] + side - starts[:, axis]) / along for side in (0.0, size[axis]))
        inside = (starts[:, axis] >= low[axis]) & (starts[:, axis] <= low[axis] + size[axis])
        near, far = np.minimum(near, far), np.maximum(near, far)
        still = way[:, axis] == 0.0
        first = np.maximum(first, np.where(still, np.where(inside, 0.0, 2.0), near))
        last = np.minimum(last, np.where(still, 1.0, far))
    return bool((first <= last).any())
