"""Design modes: the valid design parameters of a piece, made dimensionless."""

from dataclasses import dataclass

import numpy as np

from restshape.shape.planks import FREEDOMS, Piece


@dataclass(frozen=True)
class DesignModes:
    """Modes of a piece: each moves, turns or lengthens one plank, and the ends of its neighbours follow.

    Args:
        piece: what they are modes of.
        freedoms: (m, 2) plank and number of its design parameter in `FREEDOMS`.
        unit: what a change of 1 of a move or a length is [m]: the longest side of the bounding box.

    Source: the thesis, section 6.5.1.
    """

    piece: Piece
    freedoms: np.ndarray
    unit: float

    @classmethod
    def of(cls, piece: Piece, freedoms: list[tuple[int, int]]) -> "DesignModes":
        """The modes of those design parameters."""
        return cls(piece, np.array(freedoms, dtype=np.int32).reshape(-1, 2), piece.size)

    def __len__(self) -> int:
        return len(self.freedoms)

    @property
    def directions(self) -> np.ndarray:
        """Change (m, 8 n) of all design parameters by each mode, [m] and [rad]."""
        directions = np.zeros((len(self), 8 * len(self.piece.planks)))
        plank, number = self.freedoms.T
        turns = (number >= 3) & (number < 6)
        directions[np.arange(len(self)), 8 * plank + number] = np.where(turns, 1.0, self.unit)
        return directions

    def direction(self, modes: np.ndarray, parts: np.ndarray) -> np.ndarray:
        """Change (n, 8) of the design parameters by a combination: numbers of modes and their parts (k,)."""
        direction = np.zeros((len(self.piece.planks), 8))
        for k, part in zip(modes, parts):
            plank, number = self.freedoms[k]
            direction[plank, number] += part * (1.0 if 3 <= number < 6 else self.unit)
        return direction

    def names(self, modes: np.ndarray) -> tuple[str, ...]:
        """What modes do, in words."""
        return tuple(f"{self.piece.planks[p].name}: {FREEDOMS[f]}" for p, f in self.freedoms[np.asarray(modes)])
