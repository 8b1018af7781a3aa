"""The lines of nodes that seams join, and which places of them belong together: by share of their lengths."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from restshape.errors import UserError
from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.seams.pleats import Pleats
from restshape.scene.model import Scene
from restshape.scene.seam_keys import Seam

STIFFER = 100.0
"""Stiffness of a seam over the membrane's by mesh size, where the scene names none."""
ALIKE = 0.05
"""Share by which the ways of two pairings may differ that are alike."""
SAME = 1e-9
"""Shares of two sides that differ by no more are the same place."""


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
        slack: distance across it up to which its springs do not pull [m].
        pleats: of the first side, as it is in this order; None: it has none.
    """

    name: str
    first: SeamLine
    second: SeamLine
    stiffness: float
    ease: float
    size: float
    flat: bool = False
    slack: float = 0.0
    pleats: Pleats | None = None

    def joins_the_same(self, other: SeamPair) -> bool:
        """Whether the other one joins the same nodes of the mesh in the same order, and bends alike."""
        lines = ((self.first, other.first), (self.second, other.second))
        alike = all(np.array_equal(a.nodes, b.nodes) and np.array_equal(a.along, b.along) for a, b in lines)
        return alike and (self.name, self.flat) == (other.name, other.flat)


def seam_pairs(scene: Scene, mesh: Mesh, placed: np.ndarray, stiffest: float) -> tuple[SeamPair, ...]:
    """The seams of a scene on a mesh.

    Args:
        scene: of cloth; mesh: of it.
        placed: (n, 3) where its nodes lie at first [m], by which sides are paired: see `turned_round`.
        stiffest: the largest stiffness of the membrane [N/m].

    Raises:
        UserError: a side has no edge on the mesh.
    """
    return tuple(_pair(scene, mesh, placed, stiffest, name, seam) for name, seam in scene.seams.items())


def _pair(scene: Scene, mesh: Mesh, placed: np.ndarray, stiffest: float, name: str, seam: Seam) -> SeamPair:
    first, second = joined_sides(mesh, placed, name, seam.sides, seam.reverse)
    size = scene.mesh.size or float(np.mean([np.diff(line.lengths(mesh.X)).mean() for line in (first, second)]))
    stiffness, flat = seam.stiffness or STIFFER * stiffest / size, seam.stitched == "flat"
    pleats = _pleats(scene, mesh, name, first) if seam.pleats else None
    return SeamPair(name, first, second, stiffness, seam.ease, size, flat, seam.slack, pleats)


def joined_sides(
    mesh: Mesh, placed: np.ndarray, name: str, sides: Sequence[tuple[str, ...]], reverse: bool | None
) -> tuple[SeamLine, SeamLine]:
    """Both sides of a seam, in the order in which their places belong together; `placed` as of `seam_pairs`.

    Args:
        name: of the seam; sides: names of the edges of each; reverse: as of `Seam`.

    Raises:
        UserError: a side has no edge on the mesh.
    """
    first, second = (_line(mesh, placed, side, f"seams.{name}.{key}") for key, side in zip(("from", "to"), sides))
    # Chains have the cloth on their left: side by side they run in opposite directions.
    turned = turned_round(mesh.X, placed, first, second) if reverse is None else not reverse
    return first, second.reversed if turned else second


def pleated_lines(scene: Scene, mesh: Mesh, placed: np.ndarray) -> Iterator[tuple[SeamLine, Pleats]]:
    """The sides of seams that have pleats, and these; arguments as of `seam_pairs`."""
    for name, seam in scene.seams.items():
        if seam.pleats:
            line = _line(mesh, placed, seam.sides[0], f"seams.{name}.from")
            yield line, _pleats(scene, mesh, name, line)


def _pleats(scene: Scene, mesh: Mesh, name: str, line: SeamLine) -> Pleats:
    """The pleats of a seam along its first side.

    Raises:
        UserError: two lie on each other, or one reaches beyond an end of the seam as it is laid.
    """
    place = {node: k for k, node in enumerate(line.nodes.tolist())}
    placed = [one for one in scene.shape.pleats if one.seam == name]
    folds = np.array([[place[int(mesh.nodes_of(fold)[0])] for fold in one.folds] for one in placed])
    rise = np.where(folds[:, 0] < folds[:, 1], 1.0, -1.0) * [
        1.0 if one.pleat.toward == "end" else -1.0 for one in placed
    ]
    order = np.argsort(folds.min(axis=1))
    found = Pleats(folds.min(axis=1)[order], folds.max(axis=1)[order], rise[order])
    if (found.first[1:] < found.second[:-1]).any():
        raise UserError("two pleats overlap", f"seams.{name}.pleats", "move one of them, or make one less deep")
    places = found.places(line.lengths(mesh.X))
    beyond = max(float(-places.min()), float((places - places[-1]).max()))
    if beyond > 0.0:
        what = f"a pleat, as it is laid, reaches {1e3 * beyond:.3g} mm beyond an end of the seam"
        raise UserError(what, f"seams.{name}.pleats", "move it away from that end, or make it less deep")
    return found


def turned_round(X: np.ndarray, placed: np.ndarray, first: SeamLine, second: SeamLine) -> bool:
    """Whether two sides belong together where the second one is turned round.

    The shorter way between their ends decides. Where both ways are within `ALIKE` of each other the energy of the first
    frame at its start does, in which the pairings differ by their springs alone. Where that is alike too the same
    face of the cloth is outside on both sides, so that springs do not cross.

    Args:
        X: (n, 2) nodes in the pattern [m]; placed: (n, 3) in space [m].
        first, second: sides with the cloth on their left.
    """
    a, b, c, d = (placed[line.nodes[end]] for line in (first, second) for end in (0, -1))
    ways = [np.sum((a - p) ** 2) + np.sum((b - q) ** 2) for p, q in ((c, d), (d, c))]
    for straight, turned in (ways, [mean_square(X, placed, first, other) for other in (second, second.reversed)]):
        if abs(straight - turned) > ALIKE * max(straight, turned):
            return bool(turned < straight)
    return True


def mean_square(X: np.ndarray, placed: np.ndarray, first: SeamLine, second: SeamLine) -> float:
    """The mean square [m^2] of the distance in space between places of two sides at one share of their lengths."""
    shares = [line.lengths(X) / line.lengths(X)[-1] for line in (first, second)]
    s = np.union1d(*shares)
    one, other = (
        np.stack([np.interp(s, share, placed[line.nodes, k]) for k in range(3)], axis=1)
        for share, line in zip(shares, (first, second))
    )
    gap = one - other
    # Simpson's rule: the distance is linear between nodes of either side.
    middle = 0.5 * (gap[1:] + gap[:-1])
    square = [np.einsum("ij,ij->i", part, part) for part in (gap[:-1], middle, gap[1:])]
    return float(np.diff(s) @ (square[0] + 4.0 * square[1] + square[2]) / 6.0)


def _line(mesh: Mesh, placed: np.ndarray, names: tuple[str, ...], where: str) -> SeamLine:
    """One side along edges of these names, each with the end first that is nearer to the end of the one before."""
    chains = [_chain(mesh, piece, where) for name in names for piece in _pieces(mesh, name)]
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


def _pieces(mesh: Mesh, name: str) -> list[str]:
    """The edge itself, or what darts have left of it, in order along it."""
    edges = mesh.outline.entity(name).edges
    return [mesh.outline.edges[e].name for e in edges] if len(edges) > 1 else [name]


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
