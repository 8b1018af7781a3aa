"""The springs of one seam: from the nodes of each side to places on the edges of the other one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from restshape.physics.cloth.seams.seam_lines import SAME, SeamLine


@dataclass(frozen=True, eq=False)
class Springs:
    """The springs of one seam, in order along it.

    Args:
        lines: the line, 0 or 1, of each (m,); node: its place (m,) in that line's nodes.
        edge: (m,) place of the other line's node at which the edge begins that it is sewn to.
    """

    lines: np.ndarray
    node: np.ndarray
    edge: np.ndarray

    @classmethod
    def of(cls, shares: Sequence[np.ndarray]) -> Springs:
        """Springs between two sides whose nodes have these shares (p,), (q,) of their lengths.

        Together they integrate the square of the distance along the seam by the trapezoidal rule on the pieces between
        all nodes of both sides: constant forces on a seam are those that either mesh has by itself.
        """
        values = np.concatenate(shares)
        line = np.repeat([0, 1], [len(part) for part in shares])
        node = np.concatenate([np.arange(len(part)) for part in shares])
        order = np.lexsort((node, line, np.round(values / SAME)))
        kept = order[_kept(values[order], line[order])]
        line, node = line[kept], node[kept]
        edge = np.empty(len(kept), np.int64)
        for side in range(2):
            own = line == side
            edge[own] = edges_at(shares[1 - side], shares[side][node[own]])
        return cls(line, node, edge)

    def nodes(self, lines: Sequence[SeamLine]) -> np.ndarray:
        """Nodes (m, 3) of the mesh: the one that is sewn, and the ends of the edge that it is sewn to."""
        found = np.empty((len(self.node), 3), np.int32)
        for side in range(2):
            own, other = self.lines == side, lines[1 - side].nodes
            found[own, 0] = lines[side].nodes[self.node[own]]
            found[own, 1], found[own, 2] = other[self.edge[own]], other[self.edge[own] + 1]
        return found

    def coefficients(self, lengths: Sequence[np.ndarray]) -> np.ndarray:
        """What the element takes at its nodes (m, 3, 2), for lengths (p,), (q,) [m] along both sides."""
        return self._table([part / part[-1] for part in lengths], 0.5 * (lengths[0][-1] + lengths[1][-1]))

    def coefficient_rates(self, lengths: Sequence[np.ndarray], rates: Sequence[np.ndarray]) -> np.ndarray:
        """The rates (m, 3, 2) of `coefficients` as the lengths have these rates."""
        shares = [part / part[-1] for part in lengths]
        changes = [(d - share * d[-1]) / part[-1] for part, share, d in zip(lengths, shares, rates)]
        mean, change = (0.5 * (part[0][-1] + part[1][-1]) for part in (lengths, rates))
        out = self._table(changes, mean)
        out[:, 0, 1] += self._table(shares, change)[:, 0, 1]
        return out

    def pieces(self, shares: Sequence[np.ndarray]) -> tuple[list[np.ndarray], np.ndarray]:
        """What lies between the springs: edges (k,) of both lines, and which of the springs (k,) each one begins at."""
        place = self._table(shares, 0.0)[:, 0, 0]
        begin = np.flatnonzero(np.diff(place) > SAME)
        middle = 0.5 * (place[begin] + place[begin + 1])
        return [edges_at(part, middle) for part in shares], begin

    def _table(self, shares: Sequence[np.ndarray], length: float) -> np.ndarray:
        """Shares of the nodes, and a length times half of what lies between the springs beside each; linear in both."""
        out = self._places(shares)
        place = out[:, 0, 0]
        out[:, 0, 1] = 0.5 * length * (np.append(place[1:], place[-1]) - np.insert(place[:-1], 0, place[0]))
        return out

    def _places(self, shares: Sequence[np.ndarray]) -> np.ndarray:
        """What the element takes at its nodes (m, 3, 2), with shares of these and no length yet."""
        out = np.zeros((len(self.node), 3, 2), np.result_type(*shares))
        for side in range(2):
            own, other = self.lines == side, shares[1 - side]
            out[own, 0, 0] = shares[side][self.node[own]]
            out[own, 1, 0], out[own, 2, 0] = other[self.edge[own]], other[self.edge[own] + 1]
        return out


def _kept(values: np.ndarray, line: np.ndarray) -> np.ndarray:
    """Which (m,) of the sorted shares of both lines stay: of a place that both have nodes at, those of one line."""
    group = np.cumsum(np.diff(values, prepend=values[0]) > 2.0 * SAME)
    counts = np.array([np.bincount(group[line == side], minlength=group[-1] + 1) for side in range(2)])
    return (line == np.where(counts[1] > counts[0], 1, 0)[group]).nonzero()[0]


def edges_at(shares: np.ndarray, places: np.ndarray) -> np.ndarray:
    """The edges (m,) of a line with these shares (q,) of its nodes that places (m,) lie on."""
    found = np.clip(np.searchsorted(shares, places + SAME, side="right") - 1, 0, len(shares) - 2)
    flat = np.diff(shares) <= SAME
    while (on := flat[found] & (found > 0)).any():
        # Between two edges that follow each other at a distance: the end of the first.
        found[on] -= 1
    return found
