"""The lines of nodes that seams join, and which places of them belong together: by share of their lengths."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.seam_keys import Seam
from restshape.scene.model import Scene

STIFFER = 100.0
"""Stiffness of a seam over the membrane's by mesh size, where the scene names none."""
SAME = 1e-9
"""Shares of two sides that differ by no more are the same place."""
SHARES = 9
"""Places of a side by which it is found which end of the other one belongs to its first one."""
ALIKE = 1e-9
"""Part by which one of two ways is shorter than the other one where they are alike."""


@dataclass(frozen=True, eq=False)
class SeamLine:
    """One side of a seam.

    Args:
        nodes: (p,) of the mesh, in order along it.
        along: (p - 1,) 1 where cloth's edge goes from a node to the next one; 0 where an edge ends and another begins.
    """

    nodes: np.ndarray
    along: np.ndarray

    def lengths(self, X: np.ndarray) -> np.ndarray:
        """Lengths (p,) [m] from its start to each node, at X (n, 2)."""
        way = np.diff(X[self.nodes], axis=0)
        return np.concatenate([[0.0], np.cumsum(np.hypot(*way.T) * self.along)])

    def length_rates(self, X: np.ndarray, dX: np.ndarray) -> np.ndarray:
        """Their rates (p,) when nodes move with dX (n, 2)."""
        way, change = np.diff(X[self.nodes], axis=0), np.diff(dX[self.nodes], axis=0)
        size = np.hypot(*way.T)
        rates = np.einsum("ij,ij->i", way, change) / np.where(size > 0.0, size, 1.0)
        return np.concatenate([[0.0], np.cumsum(rates * self.along)])

    def at_shares(self, X: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Places (m, 3) at even shares of its length at X (n, 2), of nodes at x (n, 3)."""
        lengths = self.lengths(X)
        wanted = np.linspace(0.0, lengths[-1], SHARES)
        return np.column_stack([np.interp(wanted, lengths, part) for part in x[self.nodes].T])

    @property
    def reversed(self) -> SeamLine:
        """The same one from its other end."""
        return SeamLine(self.nodes[::-1], self.along[::-1])


@dataclass(frozen=True, eq=False)
class SeamPair:
    """Two sides that are sewn together, on one mesh.

    Args:
        name: of the seam.
        first, second: its sides, in the order in which their places belong together.
        stiffness: of its springs by length [N/m^2].
        ease: of `Seam`.
        size: of the mesh [m], where it is given; else of its edges there.
        flat: the cloth bends across it.
    """

    name: str
    first: SeamLine
    second: SeamLine
    stiffness: float
    ease: float
    size: float
    flat: bool = False

    def joins_the_same(self, other: SeamPair) -> bool:
        """Whether the other one joins the same nodes of the mesh in the same order, and bends alike."""
        lines = ((self.first, other.first), (self.second, other.second))
        alike = all(np.array_equal(a.nodes, b.nodes) and np.array_equal(a.along, b.along) for a, b in lines)
        return alike and (self.name, self.flat) == (other.name, other.flat)


def seam_pairs(scene: Scene, mesh: Mesh, placed: np.ndarray, stiffest: float) -> tuple[SeamPair, ...]:
    """The seams of a scene on a mesh.

    Args:
        scene: of cloth; mesh: of it.
        placed: (n, 3) where its nodes lie at first [m]: the ends of sides that are nearer there belong together.
        stiffest: the largest stiffness of the membrane [N/m].

    Raises:
        UserError: a side has no edge on the mesh.
    """
    return tuple(_pair(scene, mesh, placed, stiffest, name, seam) for name, seam in scene.seams.items())


def _pair(scene: Scene, mesh: Mesh, placed: np.ndarray, stiffest: float, name: str, seam: Seam) -> SeamPair:
    first, second = (_line(mesh, placed, side, f"seams.{name}.{key}") for key, side in zip(("from", "to"), seam.sides))
    # Chains have the cloth on their left: side by side they run in opposite directions.
    turned = _nearer_turned(mesh.X, placed, first, second) if seam.reverse is None else not seam.reverse
    second = second.reversed if turned else second
    size = scene.mesh.size or float(np.mean([np.diff(line.lengths(mesh.X)).mean() for line in (first, second)]))
    return SeamPair(
        name, first, second, seam.stiffness or STIFFER * stiffest / size, seam.ease, size, seam.stitched == "flat"
    )


def _nearer_turned(X: np.ndarray, placed: np.ndarray, first: SeamLine, second: SeamLine) -> bool:
    """Whether two sides are nearer to each other at places (n, 3) where the second one is turned round.

    By the squares of the ways between places of one share of their lengths: of a side that is closed in space its ends
    say nothing.
    """
    a, b = (line.at_shares(X, placed) for line in (first, second))
    straight, turned = (float(np.sum((a - other) ** 2)) for other in (b, b[::-1]))
    return turned < straight * (1.0 - ALIKE)


def _line(mesh: Mesh, placed: np.ndarray, names: tuple[str, ...], where: str) -> SeamLine:
    """One side along edges of these names, each with the end first that is nearer to the end of the one before."""
    chains = [_chain(mesh, name, where) for name in names]
    if len(chains) > 1:
        ends = placed[chains[1][[0, -1]]]
        off = [np.linalg.norm(ends - placed[chains[0][end]], axis=1).min() for end in (0, -1)]
        chains[0] = chains[0][::-1] if off[0] < off[1] else chains[0]
    nodes, along = list(chains[0]), [1.0] * (len(chains[0]) - 1)
    for chain in chains[1:]:
        off = np.linalg.norm(placed[chain[[0, -1]]] - placed[nodes[-1]], axis=1)
        chain = chain[::-1] if off[1] < off[0] else chain
        if chain[0] == nodes[-1]:
            chain = chain[1:]
            along += [1.0] * len(chain)
        else:
            along += [0.0] + [1.0] * (len(chain) - 1)
        nodes += list(chain)
    return SeamLine(np.array(nodes, np.int32), np.array(along))


def _chain(mesh: Mesh, name: str, where: str) -> np.ndarray:
    """Nodes (p,) along an edge, with the material on the left."""
    facets = mesh.facets[mesh.facets_of(name)]
    if not len(facets):
        raise UserError(f"{name!r} is no edge of the mesh", where, "name an edge of the outline or of a hole")
    following = dict(facets.tolist())
    starts = [a for a in following if a not in set(following.values())]
    if len(starts) > 1:
        raise UserError(f"the edge {name!r} is in {len(starts)} pieces", where, "name the pieces, in their order")
    start = starts[0] if starts else int(facets[0, 0])
    nodes = [start, following[start]]
    while nodes[-1] in following and nodes[-1] != start:
        nodes.append(following[nodes[-1]])
    return np.array(nodes, np.int32)
