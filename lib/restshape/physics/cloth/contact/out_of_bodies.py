"""Cloth that begins inside bodies is brought out of them before its first step, the nearest way."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from restshape import _kernels
from restshape.physics.cloth.contact.collision_surface import unique_edges

LEAST = 0.5
"""Depth of a pocket over the thickness of contact from which on it is brought out: contact lifts shallower ones."""
TORN = 0.5
"""Cosine of the angle between the nearest ways out at both ends of an edge below which these would tear the cloth."""
LONG, DEEP = 2.0, 0.15
"""Of an edge that lies through a body: its length over that before, and the depth of its middle over its length."""
MARCHES, LEFT = 200, 0.01
"""Steps of a way out at most; distance over the thickness of contact that may be left at its end."""


class Bodies:
    """All bodies as one.

    Args:
        bodies: of the cloth.
    """

    def __init__(self, bodies: Sequence[_kernels.Body]) -> None:
        self.bodies = bodies

    def distance(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Signed distances (n,) [m] of places x (n, 3) from the nearest one, and unit vectors (n, 3) away from it."""
        found = [body.distance(x)[:2] for body in self.bodies]
        nearest = np.argmin([distance for distance, _ in found], axis=0)
        own = np.arange(len(x))
        distance, away = (np.array([one[part] for one in found])[nearest, own] for part in range(2))
        length = np.linalg.norm(away, axis=1)
        return distance, away / np.where(length > 0.0, length, 1.0)[:, None]

    def left(self, x: np.ndarray, clear: float, way: np.ndarray | None = None) -> np.ndarray:
        """Where places (m, 3) [m] come to that leave all bodies: a distance `clear` [m] away from them.

        Args:
            x: the places; clear: the distance.
            way: unit vector (3,) that all of them go along; None: each goes the nearest way.
        """
        x = x.copy()
        inside = np.arange(len(x))
        for _ in range(MARCHES):
            distance, away = self.distance(x[inside])
            short = clear - distance
            on = short > LEFT * clear
            inside = inside[on]
            if not len(inside):
                break
            x[inside] += short[on, None] * (away[on] if way is None else way)
        return x


def brought_out(
    bodies: Sequence[_kernels.Body], x: np.ndarray, cells: np.ndarray, movable: np.ndarray, thickness: float
) -> np.ndarray:
    """Places (n, 3) [m] of nodes at x (n, 3), those that may move brought out of bodies.

    Shallow pockets stay, and those that no way leads out of: see `still_inside`.
    Nodes inside that are joined by edges are a pocket. Each of them goes the nearest way out, unless that would tear
    the pocket apart, as where it lies across the middle of a body: then all go the same way, the shortest.

    Args:
        bodies: of the cloth; x: where it begins.
        cells: (ne, 3) triangles.
        movable: (n,) whether nothing holds a node.
        thickness: distance at which contact begins [m], and at which they end.
    """
    union = Bodies(bodies)
    distance, away = union.distance(x)
    inside = (distance < 0.0) & movable
    found = x.copy()
    if not inside.any():
        return found
    edges = unique_edges(cells)
    own = edges[inside[edges].all(axis=1)]
    graph = coo_matrix((np.ones(len(own)), own.T), shape=(len(x), len(x)))
    pocket = np.where(inside, connected_components(graph, directed=False)[1], -1)
    for number in np.unique(pocket[inside]):
        nodes = np.flatnonzero(pocket == number)
        if distance[nodes].min() > -LEAST * thickness:
            continue
        first, second = own[pocket[own[:, 0]] == number].T
        torn = (np.einsum("ma,ma->m", away[first], away[second]) < TORN).any()
        found[nodes] = _together(union, x, nodes, cells, thickness) if torn else union.left(x[nodes], thickness)
    return found


def through_words(bodies: Sequence[_kernels.Body], placed: np.ndarray, out: np.ndarray, edges: np.ndarray) -> str:
    """What there is to say of edges (m, 2) of cloth that lie through bodies after its way out; empty where none does.

    Args:
        bodies: of the cloth; placed: (n, 3) [m] where nodes begin; out: (n, 3) where they are brought.
    """
    before, after = (np.linalg.norm(x[edges[:, 1]] - x[edges[:, 0]], axis=1) for x in (placed, out))
    middles = out[edges].mean(axis=1)
    through = (after > LONG * before) & (Bodies(bodies).distance(middles)[0] < -DEEP * after)
    if not through.any():
        return ""
    longest = int(np.argmax(np.where(through, after / before, 0.0)))
    place = ", ".join(f"{1e3 * one:.0f}" for one in middles[longest])
    what = f"brought out of bodies, cloth lies through one near ({place}) mm, where an edge is stretched to"
    return f"{what} {after[longest] / before[longest]:.2g} times its length: begin it farther outside"


def still_inside(bodies: Sequence[_kernels.Body], x: np.ndarray, thickness: float) -> np.ndarray:
    """Whether nodes (n,) at x (n, 3) [m] are deeper in bodies than what contact of a thickness [m] lifts."""
    return Bodies(bodies).distance(x)[0] < -LEAST * thickness


def _together(union: Bodies, x: np.ndarray, nodes: np.ndarray, cells: np.ndarray, thickness: float) -> np.ndarray:
    """Where the nodes (m,) of a pocket come to that all go one way: the shortest of those that are tried.

    Tried are the mean of the nearest ways, and both ways across the pocket.
    """
    depth, away = union.distance(x[nodes])
    own = x[cells[np.isin(cells, nodes).any(axis=1)]]
    across = np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]).sum(axis=0)
    best, least = x[nodes], np.inf
    for way in ((depth[:, None] * -away).sum(axis=0), across, -across):
        length = float(np.linalg.norm(way))
        if length == 0.0:
            continue
        found = union.left(x[nodes], thickness, way / length)
        gone = float(np.linalg.norm(found - x[nodes], axis=1).max())
        if gone < least and union.distance(found)[0].min() > 0.0:
            best, least = found, gone
    return best
