"""Seams as springs from the nodes of each side to places on the edges of the other one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from restshape.fem.elements import SEAM
from restshape.fem.integral import Integral
from restshape.physics.cloth.seams.pleated_springs import springs_of
from restshape.physics.cloth.seams.seam_lines import SeamLine, SeamPair
from restshape.physics.cloth.seams.seam_springs import Springs
from restshape.physics.cloth.seams.sewn_neighbours import clusters, shared_nodes, with_shared

OPEN = 1e-3
"""Distance across a seam [m] from which on a note reports it."""


class Seams:
    """All seams of cloth on one mesh.

    Args:
        pairs: what is sewn.
        corner_number: (corners,) node of each node of the mesh.

    Attributes:
        pairs: others with other stiffness may be set before `place`.
        pull: part of their stiffness that there is.
        changes: another number whenever the springs are between other nodes.
        nodes: (m, 3) nodes of the mesh of each spring.
    """

    def __init__(self, pairs: Sequence[SeamPair], corner_number: np.ndarray) -> None:
        self.pairs, self.corner_number = tuple(pairs), corner_number
        self.pull, self.changes = 1.0, 0
        self._springs: list[Springs] = []
        self.nodes = np.zeros((0, 3), np.int32)
        self.X = np.empty((0, 2))

    def place(self, X: np.ndarray) -> None:
        """Take in where the mesh's nodes are in the material, (n, 2) [m]."""
        self.X = X.copy()
        self.lengths = [[line.lengths(X) for line in (pair.first, pair.second)] for pair in self.pairs]
        self._springs = [springs_of(pair, lengths) for pair, lengths in zip(self.pairs, self.lengths)]
        nodes = np.vstack([one.nodes(lines) for one, lines in zip(self._springs, self._lines)])
        if not np.array_equal(nodes, self.nodes):
            self.nodes, self.changes = nodes, self.changes + 1
        tables = [one.coefficients(lengths) for one, lengths in zip(self._springs, self.lengths)]
        self.coefficients = np.vstack(tables)
        counts = [len(table) for table in tables]
        self.stiffness = np.repeat([pair.stiffness for pair in self.pairs], counts)
        self.slack = np.repeat([pair.slack for pair in self.pairs], counts)

    @property
    def flat_lines(self) -> list[tuple[SeamLine, SeamLine]]:
        """Both sides of the seams that are sewn flat."""
        return [lines for pair, lines in zip(self.pairs, self._lines) if pair.flat]

    def flat_pieces(self) -> list[tuple[list[np.ndarray], np.ndarray]]:
        """Of each of them, the edges (k,) on both sides of its pieces between all nodes, and their lengths (k,) [m]."""
        found = []
        for springs, lengths in self._flat:
            edges, begin = springs.pieces([part / part[-1] for part in lengths])
            found.append((edges, self._between(springs.coefficients(lengths), begin, lengths)))
        return found

    def flat_length_rates(self, dX: np.ndarray) -> list[np.ndarray]:
        """The rates of these lengths when the mesh's nodes move with dX (n, 2)."""
        found = []
        for lines, (springs, lengths) in zip(self.flat_lines, self._flat):
            rates = [line.length_rates(self.X, dX) for line in lines]
            _, begin = springs.pieces([part / part[-1] for part in lengths])
            shares, changes = springs.coefficients(lengths), springs.coefficient_rates(lengths, rates)
            found.append(self._between(changes, begin, lengths) + self._between(shares, begin, rates))
        return found

    @property
    def _flat(self) -> list[tuple[Springs, list[np.ndarray]]]:
        return [one for pair, *one in zip(self.pairs, self._springs, self.lengths) if pair.flat]

    @staticmethod
    def _between(table: np.ndarray, begin: np.ndarray, lengths: Sequence[np.ndarray]) -> np.ndarray:
        """Differences of shares after springs (k,), times the mean of both whole lengths."""
        return np.diff(table[:, 0, 0])[begin] * 0.5 * (lengths[0][-1] + lengths[1][-1])

    @property
    def edge_length(self) -> float:
        """Of the edges along seams, on average [m]."""
        ends = self.X[self.nodes[:, 1:]]
        return float(np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).mean())

    @property
    def _lines(self) -> list[tuple[SeamLine, SeamLine]]:
        return [(pair.first, pair.second) for pair in self.pairs]

    @property
    def dofs(self) -> np.ndarray:
        """Nodes (m, 3) int32 whose unknowns the springs have."""
        return np.ascontiguousarray(self.corner_number[self.nodes].astype(np.int32))

    @property
    def own_nodes(self) -> np.ndarray:
        """Numbers (m, 3) int32 of what each spring has at its nodes, which no other one has."""
        return np.arange(self.nodes.size, dtype=np.int32).reshape(-1, 3)

    def integral(self, block: int, stiffness: np.ndarray | None = None, slack: np.ndarray | None = None) -> SeamForces:
        """The springs, a block of the operator, with their stiffness or another (m,) [N/m^2], and so slack (m,) [m]."""
        values = self.pull * self.stiffness if stiffness is None else stiffness
        table = np.ascontiguousarray(self.coefficients.reshape(-1, 2))
        places = np.ascontiguousarray(self.X[self.nodes].reshape(-1, 2))
        parameters = np.column_stack([values, self.slack if slack is None else slack])
        own = Integral(
            SEAM["edge3"], places, self.own_nodes, parameters, block=block, coefficients=table, dofs=self.dofs
        )
        return SeamForces(self, self.corner_number, own)

    def slack_rate_integrals(self, rates: np.ndarray, corners: np.ndarray) -> list[SeamForces]:
        """What sums up to the rates of the forces at positions (n, 3) of the mesh's nodes when slack has rates (m,).

        Where a spring pulls its force is linear in the slack: the difference of two slacks is exact.
        """
        gaps = self.gaps(corners)
        change = rates * self.stiffness * np.divide(2.0, gaps, where=gaps > 0.0, out=np.zeros_like(gaps))
        return [self.integral(0, change, self.slack + 0.5 * gaps), self.integral(0, -change)]

    def moved(self, dX: np.ndarray) -> np.ndarray:
        """Rates of places (3 m, 2) of the springs' nodes as the mesh's nodes move with dX (n, 2)."""
        return np.ascontiguousarray(dX[self.nodes].reshape(-1, 2))

    def coefficient_rates(self, dX: np.ndarray) -> np.ndarray:
        """Rates (3 m, 2) of shares and lengths when the mesh's nodes move with dX (n, 2)."""
        found = []
        for lines, springs, lengths in zip(self._lines, self._springs, self.lengths):
            rates = [line.length_rates(self.X, dX) for line in lines]
            found.append(springs.coefficient_rates(lengths, rates))
        return np.ascontiguousarray(np.vstack(found).reshape(-1, 2))

    @property
    def shares_of_edges(self) -> np.ndarray:
        """Shares (m,) of the edges that lie between their first ends and the places."""
        s = self.coefficients[:, :, 0]
        return (s[:, 0] - s[:, 1]) / (s[:, 2] - s[:, 1])

    def gaps(self, corners: np.ndarray) -> np.ndarray:
        """Distances (m,) [m] across the seams at positions (n, 3) of the mesh's nodes, beyond their slack."""
        t, x = self.shares_of_edges[:, None], corners[self.nodes]
        return np.maximum(np.linalg.norm(x[:, 0] - (1.0 - t) * x[:, 1] - t * x[:, 2], axis=1) - self.slack, 0.0)

    def gap(self, corners: np.ndarray) -> float:
        """The largest of them."""
        return float(self.gaps(corners).max())

    def gap_notes(self, corners: np.ndarray) -> list[str]:
        """What there is to say of seams that are open at positions (n, 3): of the widest."""
        gaps = self.gaps(corners)
        wide = sorted(((gaps[own].max(), name) for name, own in self.springs_by_name()), reverse=True)
        found = [(gap, name) for gap, name in wide if gap > OPEN]
        more = len(found) - 1
        others = f", and {more} {'others are' if more > 1 else 'other is'} open" if more else ""
        return [f"seams.{name} is open by {1e3 * gap:.3g} mm{others}" for gap, name in found[:1]]

    def ease_notes(self) -> list[str]:
        """What there is to say of sides of unlike lengths."""
        found = []
        for pair, (first, second) in zip(self.pairs, self.lengths):
            ratio = (pair.pleats.places(first) if pair.pleats else first)[-1] / second[-1]
            if max(ratio, 1.0 / ratio) > 1.0 + pair.ease:
                longer = "from" if ratio > 1.0 else "to"
                found.append((max(ratio, 1.0 / ratio), f"seams.{pair.name}.{longer}"))
        found.sort(reverse=True)
        others = f", and {len(found) - 1} others" if len(found) > 1 else ""
        return [
            f"{where} is gathered: {ratio:.3g} times as long as what it is sewn to{others}"
            for ratio, where in found[:1]
        ]

    def sewing(self) -> tuple[np.ndarray, np.ndarray]:
        """Numbers (n,) int32 of the mesh's nodes, one for those that are sewn to each other, and pairs (k, 2) of them.

        A pair is a node, and an end of the edge between whose ends it is sewn.
        """
        t = self.shares_of_edges
        at_ends = [(self.nodes[:, 0], self.nodes[:, 1], t < 1.0 - ENDS), (self.nodes[:, 0], self.nodes[:, 2], t > ENDS)]
        inner = (t > ENDS) & (t < 1.0 - ENDS)
        joined = np.vstack([np.column_stack([i, j])[on & ~inner] for i, j, on in at_ends])
        number = clusters(joined, len(self.X))
        between = np.vstack([np.column_stack([number[i], number[j]])[inner] for i, j, _ in at_ends])
        # All layers of pleats are sewn to one line: they lie on each other there.
        several = [pair.second for pair in self.pairs if pair.pleats]
        shared = shared_nodes([line.nodes for line in (*(line for lines in self._lines for line in lines), *several)])
        return number, with_shared(between, np.unique(number[shared]), len(self.X))

    def springs_by_name(self) -> list[tuple[str, slice]]:
        """The springs of each seam."""
        ends = np.cumsum([0, *(len(one.node) for one in self._springs)]).tolist()
        return [(pair.name, slice(*ends[k : k + 2])) for k, pair in enumerate(self.pairs)]


ENDS = 1e-6
"""Part of an edge from whose ends on a place is between them."""


class MovedParts(Protocol):
    """Springs, or what bends across seams."""

    def moved(self, dX: np.ndarray) -> np.ndarray:
        """Rates of the places of its own nodes as the mesh's nodes move with dX (n, 2)."""

    def coefficient_rates(self, dX: np.ndarray) -> np.ndarray:
        """Rates of its coefficients then."""


@dataclass(frozen=True, eq=False)
class SeamForces:
    """Like `fem.integral.Integral`, over springs, or what bends, that each have nodes and lengths of their own.

    Args:
        owner: whose they are, which knows the rates of places and coefficients.
        corner_number: (corners,) node of each node of the mesh.
        own: over these.
    """

    owner: MovedParts
    corner_number: np.ndarray
    own: Integral

    @property
    def block(self) -> int | None:
        """Of the operator."""
        return self.own.block

    def add_residual(self, x: np.ndarray, out: np.ndarray, subset: np.ndarray | None = None) -> None:
        """Add the forces [N] at x (n, 3) to `out` (n, 3)."""
        self.own.add_residual(x, out)

    def energies(self, x: np.ndarray) -> np.ndarray:
        """Energies (m,) [J] of the springs at x (n, 3)."""
        return self.own.energies(x)

    def term(self, x: np.ndarray, coefficient: float = 1.0, residual_factor: float | None = None) -> tuple:
        """The springs at x (n, 3) as a term of `algebra.operator.Operator.assemble`."""
        return self.own.term(x, coefficient, residual_factor)

    def add_tangent_product(self, x: np.ndarray, d: np.ndarray, out: np.ndarray) -> None:
        """Add (dr/dx) d, at x (n, 3) along d (n, 3), to `out` (n, 3)."""
        self.own.add_tangent_product(x, d, out)

    def add_design_product(self, x: np.ndarray, dX: np.ndarray, out: np.ndarray, dx: np.ndarray | None = None) -> None:
        """Add (dr/dX) dX + (dr/dx) dx to `out` (n, 3), dX (n, 2) of all nodes; arguments as of `Integral`'s."""
        own, at_corners = self.own, dX[self.corner_number]
        moved, rates = self.owner.moved(at_corners), self.owner.coefficient_rates(at_corners)
        own.element.design(own.X, moved, x, own.entities, own.parameters, out, dx, own.coefficients, rates, own.dofs)
