"""Pleats: cloth that is laid back on itself along a seam, in three layers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Pleats:
    """Knife pleats along a line: the cloth goes on to a fold, back over the depth to another one, and on again.

    Args:
        first, second: (k,) places in the line's nodes of the folds of each, in order along it.
        rise: (k,) 1: what comes before the first fold lies outermost, on the face of the cloth; -1: what follows the
            second one.
    """

    first: np.ndarray
    second: np.ndarray
    rise: np.ndarray

    def places(self, lengths: np.ndarray) -> np.ndarray:
        """Places (p,) [m] along the folded line of nodes at lengths (p,) [m] along the flat one; linear in these."""
        begin, end = lengths[self.first], lengths[self.second]
        node = np.arange(len(lengths))[:, None]
        back = np.where(node >= self.second, end - begin, lengths[:, None] - begin)
        return lengths - 2.0 * np.where(node <= self.first, 0.0, back).sum(axis=1)

    def heights(self, along: np.ndarray, lengths: np.ndarray) -> np.ndarray:
        """Heights (q,) [m] over the flat cloth of a wave that folds to the pleats when it is pushed together.

        Args:
            along: (q,) [m] from the line's start; lengths: (p,) [m] to its nodes.
        """
        begin, end = lengths[self.first], lengths[self.second]
        depth = end - begin
        off = (along[:, None] - 0.5 * (begin + end)) / depth
        wave = np.interp(off, [-1.5, -0.5, 0.5, 1.5], [0.0, 1.0, -1.0, 0.0])
        return (wave * depth * self.rise).sum(axis=1)
