"""Distance from a body on an adaptive grid of cubes, with which the even one is compared.

Source: Frisken, Perry, Rockwood, Jones, Adaptively sampled distance fields, SIGGRAPH 2000: cubes are divided where the
trilinear interpolation of their corners is wrong by more than a tolerance at the middles of the cube, its faces and its
edges.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape import _kernels

MOST_DIVISIONS = 10
"""Times that a cube is divided, at most."""
CUBE_BYTES, NODE_BYTES = 32, 8
"""Bytes of the eight corners of a cube, in single precision, and of a place in the tree."""
CORNERS = np.array([[i, j, k] for i in (0, 1) for j in (0, 1) for k in (0, 1)])
TESTED = np.array([[i, j, k] for i in range(3) for j in range(3) for k in range(3) if 1 in (i, j, k)])
"""Places at which a cube is tested, in halves of it."""


def _weights(t: np.ndarray) -> np.ndarray:
    """Trilinear weights (n, 8) of the corners at places (n, 3) of unit cubes."""
    return np.prod(np.where(CORNERS, t[:, None], 1.0 - t[:, None]), axis=2)


def _slopes(t: np.ndarray) -> np.ndarray:
    """Their derivatives (n, 8, 3)."""
    factors = np.where(CORNERS, t[:, None], 1.0 - t[:, None])
    signs = np.where(CORNERS, 1.0, -1.0)
    return np.stack([signs[:, a] * np.prod(np.delete(factors, a, axis=2), axis=2) for a in range(3)], axis=2)


@dataclass(frozen=True)
class Level:
    """The cubes of one size that are not divided.

    Args:
        codes: (n,) sorted, of their places; corners: (n, 8) distances [m].
    """

    codes: np.ndarray
    corners: np.ndarray


class AdaptiveDistance:
    """A distance by trilinear interpolation in cubes of many sizes.

    Args:
        search: the exact distance.
        low: (3,) corner [m] of the cube around the body, and its side [m].
        side: see there.
        band: [m] on both sides of the surface, beyond which cubes are not divided.
        tolerance: error above which they are [m].

    Attributes:
        levels: by how often cubes were divided; nodes: of the tree.
    """

    def __init__(
        self, search: _kernels.SurfaceSearch, low: np.ndarray, side: float, band: float, tolerance: float
    ) -> None:
        self.low, self.side, self.levels = low, side, []
        at, self.nodes = np.zeros((1, 3), dtype=np.int64), 0
        for depth in range(MOST_DIVISIONS + 1):
            self.nodes += len(at)
            values = self._exact(search, at, depth)
            corners = values[:, [9 * 2 * i + 3 * 2 * j + 2 * k for i, j, k in CORNERS]]
            wrong = np.abs(corners @ _weights(0.5 * TESTED).T - values[:, [9 * i + 3 * j + k for i, j, k in TESTED]])
            near = np.abs(values[:, 13]) <= band + 0.5 * np.sqrt(3.0) * side / 2**depth
            divided = near & (wrong.max(axis=1) > tolerance) & (depth < MOST_DIVISIONS)
            codes = self._codes(at, depth)
            order = np.argsort(codes[~divided])
            self.levels.append(Level(codes[~divided][order], corners[~divided][order]))
            at = (2 * at[divided][:, None] + CORNERS).reshape(-1, 3)
            if not len(at):
                break

    @property
    def cubes(self) -> int:
        """The number of cubes that are not divided."""
        return sum(len(level.codes) for level in self.levels)

    @property
    def megabytes(self) -> float:
        """What cubes and tree take."""
        return (CUBE_BYTES * self.cubes + NODE_BYTES * self.nodes) / 1e6

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Distances (n,) [m] and gradients (n, 3) at places (n, 3) within the cube around the body."""
        value, gradient = np.full(len(x), np.nan), np.full((len(x), 3), np.nan)
        for depth, level in enumerate(self.levels):
            if not len(level.codes):
                continue
            wide = self.side / 2**depth
            own = np.floor((x - self.low) / wide).astype(np.int64)
            codes = self._codes(own, depth)
            found = np.minimum(np.searchsorted(level.codes, codes), len(level.codes) - 1)
            here = level.codes[found] == codes
            t, corners = ((x - self.low) / wide - own)[here], level.corners[found[here]]
            value[here] = (corners * _weights(t)).sum(axis=1)
            gradient[here] = np.einsum("ne,nea->na", corners, _slopes(t)) / wide
        return value, gradient

    @staticmethod
    def _codes(at: np.ndarray, depth: int) -> np.ndarray:
        """What orders cubes of one size (n,)."""
        return np.asarray((at[:, 0] << 2 * depth) + (at[:, 1] << depth) + at[:, 2])

    def _exact(self, search: _kernels.SurfaceSearch, at: np.ndarray, depth: int) -> np.ndarray:
        """Exact distances (n, 27) at corners and middles of cubes (n, 3), each place once."""
        count = 2 ** (depth + 1) + 1
        halves = np.array([[i, j, k] for i in range(3) for j in range(3) for k in range(3)])
        places = (2 * at[:, None] + halves).reshape(-1, 3)
        codes, own = np.unique((places[:, 0] * count + places[:, 1]) * count + places[:, 2], return_inverse=True)
        grid = np.column_stack([codes // count**2, codes // count % count, codes % count])
        found = search.nearest(self.low + grid * (self.side / 2 ** (depth + 1)))[0]
        return np.asarray(found[own].reshape(-1, 27))
