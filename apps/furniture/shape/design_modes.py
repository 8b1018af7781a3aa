"""Design modes: the valid design parameters of a piece, made dimensionless."""

from dataclasses import dataclass, replace

import numpy as np
from restshape_apps.furniture.shape.planks import FREEDOMS, Piece


@dataclass(frozen=True)
class DesignModes:
    """Modes of a piece: each moves, turns or lengthens one plank, and the ends of its neighbours follow.

    Args:
        piece: what they are modes of.
        freedoms: (m, 2) plank and number of its design parameter in `FREEDOMS`.
        unit: what a change of 1 of a move or a length is [m]: the longest side of the bounding box.
        blocks: (n, 8, 8) change of the piece's own parameters by those that modes are of; None: they are the same.
        mates: of each mode plank, number and sign of other design parameters that change with it; empty: none has any.

    Source: the thesis, section 6.5.1.
    """

    piece: Piece
    freedoms: np.ndarray
    unit: float
    blocks: np.ndarray | None = None
    mates: tuple[tuple[tuple[int, int, float], ...], ...] = ()

    @classmethod
    def of(cls, piece: Piece, freedoms: list[tuple[int, int]]) -> "DesignModes":
        """The modes of those design parameters."""
        return cls(piece, np.array(freedoms, dtype=np.int32).reshape(-1, 2), piece.size)

    def __len__(self) -> int:
        return len(self.freedoms)

    @property
    def directions(self) -> np.ndarray:
        """Change (m, 8 n) of all design parameters of the piece by each mode, [m] and [rad]."""
        planks = len(self.piece.planks)
        directions = np.zeros((len(self), planks, 8))
        plank, number = self.freedoms.T
        blocks = np.broadcast_to(np.eye(8), (planks, 8, 8)) if self.blocks is None else self.blocks
        directions[np.arange(len(self)), plank] = blocks[plank, :, number] * self.units[:, None]
        for k, mates in enumerate(self.mates):
            for other, mate, sign in mates:
                directions[k, other] += sign * blocks[other, :, mate] * self.units[k]
        return directions.reshape(len(self), 8 * planks)

    @property
    def units(self) -> np.ndarray:
        """What a change (m,) of 1 of each mode is, [m] or [rad]."""
        number = self.freedoms[:, 1]
        return np.where((number >= 3) & (number < 6), 1.0, self.unit)

    def some(self, modes: np.ndarray) -> "DesignModes":
        """A few of the modes, by their numbers."""
        chosen = np.asarray(modes)
        mates = tuple(self.mates[k] for k in chosen.tolist()) if self.mates else ()
        return replace(self, freedoms=self.freedoms[chosen], mates=mates)

    def after(self, gamma: np.ndarray, moved: Piece) -> "DesignModes":
        """The same modes, of the piece that design parameters (n, 8) have led to.

        Parameters of a plank that has turned are along and about the axes that it had, and about its former middle;
        those of the moved piece are along and about the axes that it has.
        """
        axes, turned = (np.array([plank.axes for plank in piece.planks]) for piece in (self.piece, moved))
        centre, now = (np.array([plank.centre for plank in piece.planks]) for piece in (self.piece, moved))
        pivot = centre + np.einsum("nab,nb->na", axes, gamma[:, :3])
        back, turns = np.swapaxes(turned, 1, 2), _right_jacobians(gamma[:, 3:6])
        blocks = np.broadcast_to(np.eye(8), (len(gamma), 8, 8)).copy()
        blocks[:, :3, :3], blocks[:, 3:6, 3:6] = back @ axes, turns
        blocks[:, :3, 3:6] = -_crosses(np.einsum("nab,nb->na", back, now - pivot)) @ turns
        return replace(self, piece=moved, blocks=blocks)

    def direction(self, modes: np.ndarray, parts: np.ndarray) -> np.ndarray:
        """Change (n, 8) of the design parameters by a combination: numbers of modes and their parts (k,)."""
        direction = np.zeros((len(self.piece.planks), 8))
        for k, part in zip(modes, parts):
            plank, number = self.freedoms[k]
            mates = self.mates[int(k)] if self.mates else ()
            for other, mate, sign in ((plank, number, 1.0), *mates):
                direction[other, mate] += sign * part * (1.0 if 3 <= number < 6 else self.unit)
        return direction

    def names(self, modes: np.ndarray) -> tuple[str, ...]:
        """What modes do, in words."""
        return tuple(f"{self.piece.planks[p].name}: {FREEDOMS[f]}" for p, f in self.freedoms[np.asarray(modes)])


def _right_jacobians(turns: np.ndarray) -> np.ndarray:
    """Turns (n, 3, 3), about a plank's own axes, by each unit of change of rotation vectors (n, 3)."""
    angle = np.linalg.norm(turns, axis=1)[:, None, None]
    small, cross = angle < 1e-4, _crosses(turns)
    safe = np.where(small, 1.0, angle)
    first = np.where(small, 0.5, (1.0 - np.cos(safe)) / safe**2)
    second = np.where(small, 1.0 / 6.0, (safe - np.sin(safe)) / safe**3)
    return np.eye(3) - first * cross + second * cross @ cross


def _crosses(vectors: np.ndarray) -> np.ndarray:
    """Matrices (n, 3, 3) whose products with a vector are the vector products of vectors (n, 3)."""
    x, y, z = vectors.T
    zero = np.zeros_like(x)
    return np.stack([zero, -z, y, z, zero, -x, -y, x, zero], axis=1).reshape(-1, 3, 3)
