"""Seams of several edges whose sides would begin much nearer to each other if the edges came in another order."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restshape.mesh.mesh import Mesh
from restshape.physics.cloth.seams.seam_lines import joined_sides, mean_square
from restshape.scene.model import Scene
from restshape.scene.seam_keys import Seam

NEARER = 0.5
"""Distance of both sides in another order, over that in the scene's, below which a note names the other one."""
FEW = 8
"""Edges whose order a note has in full; of more it has the first one."""


@dataclass(frozen=True)
class Order:
    """An order of the edges on one side of a seam.

    Args:
        where: the key of the side; edges: in that order.
        apart: how far both sides lie apart at first [m], as a root mean square; written: in the scene's order.
    """

    where: str
    edges: tuple[str, ...]
    apart: float
    written: float

    def __str__(self) -> str:
        order = ", ".join(self.edges) if len(self.edges) <= FEW else f"that begins with {self.edges[0]}"
        apart = f"{1e3 * self.written:.3g} mm apart, and {1e3 * self.apart:.3g} mm in the order {order}"
        return f"{self.where}: both sides begin {apart}: is its order the right one?"


def order_notes(scene: Scene, mesh: Mesh, placed: np.ndarray) -> list[str]:
    """What there is to doubt of the order of edges in seams, of cloth at places (n, 3) [m]: of the worst seam."""
    found = [order for name, seam in scene.seams.items() if (order := _nearer(mesh, placed, name, seam))]
    found.sort(key=lambda order: order.apart - order.written)
    others = f"; {len(found) - 1} more begin nearer in another order" if len(found) > 1 else ""
    return [f"{order}{others}" for order in found[:1]]


def _nearer(mesh: Mesh, placed: np.ndarray, name: str, seam: Seam) -> Order | None:
    """The order in which a seam begins nearest, where that is much nearer than in its own; None where it is not.

    Orders are those of a ring, from any of its edges on: of `to`, or of `from` where `to` is one edge.
    """
    side = 1 if len(seam.sides[1]) > 1 else 0
    edges = seam.sides[side]
    if len(edges) < 2:
        return None
    orders = [(*edges[k:], *edges[:k]) for k in range(len(edges))]
    squares = []
    for order in orders:
        sides = (seam.sides[0], order) if side else (order, seam.sides[1])
        squares.append(mean_square(mesh.X, placed, *joined_sides(mesh, placed, name, sides, seam.reverse)))
    best = int(np.argmin(squares))
    if squares[best] >= NEARER**2 * squares[0]:
        return None
    written, apart = (float(np.sqrt(squares[k])) for k in (0, best))
    return Order(f"seams.{name}.{('from', 'to')[side]}", orders[best], apart, written)
