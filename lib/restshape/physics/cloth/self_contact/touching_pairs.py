"""What touches what, from the library's collisions: nodes, shares of the nearest places, normals, forces."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from restshape.physics.cloth.contact.collision_surface import CollisionSurface
from restshape.physics.cloth.self_contact.layer_friction import Touching

KINDS = {
    "vv_collisions": ("vertex0_id", "vertex1_id"),
    "ev_collisions": ("edge_id", "vertex_id"),
    "ee_collisions": ("edge0_id", "edge1_id"),
    "fv_collisions": ("face_id", "vertex_id"),
}
"""Lists of the library's collisions, and what each is between."""


def _numbers(collisions: Any, kind: str) -> np.ndarray:
    """The numbers (m, 2) of what collides."""
    first, second = KINDS[kind]
    found = [(getattr(one, first), getattr(one, second)) for one in getattr(collisions, kind)]
    return np.array(found, np.int64).reshape(-1, 2)


def _nodes(kind: str, numbers: np.ndarray, surface: CollisionSurface) -> np.ndarray:
    """The nodes (m, 4) of collisions, those of the first part before those of the second; -1 where there are fewer."""
    first, second = numbers.T
    found = np.full((len(numbers), 4), -1, np.int64)
    match kind:
        case "vv_collisions":
            found[:, 0], found[:, 1] = first, second
        case "ev_collisions":
            found[:, :2], found[:, 2] = surface.edges[first], second
        case "ee_collisions":
            found[:, :2], found[:, 2:] = surface.edges[first], surface.edges[second]
        case _:
            found[:, :3], found[:, 3] = surface.cells[first], second
    return found


def node_lists(collisions: Any, surface: CollisionSurface) -> np.ndarray:
    """The nodes (m, 4) of all collisions; -1 where one has fewer."""
    return np.concatenate([_nodes(kind, _numbers(collisions, kind), surface) for kind in KINDS])


@dataclass(frozen=True, eq=False)
class Collided:
    """Collisions of one kind.

    Args:
        kind: name of the library's list.
        nodes: (m, 4); where there are fewer, the first one again; there: (m, 4) whether it is one.
        weights: (m,) areas [m^2]; scales: (m,) square of the product of two edges below which these are parallel [m^4].
    """

    kind: str
    nodes: np.ndarray
    there: np.ndarray
    weights: np.ndarray
    scales: np.ndarray

    def pressing(self, places: np.ndarray, thickness: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Shares (m, 4) of the nodes at places (m, 4, 3) [m], normals (m, 3), forces (m,) over the stiffness [m^2].

        Places, weights and scales may have complex steps.
        """
        shares = SHARES[self.kind](places) * self.there
        way = np.einsum("mk,mka->ma", shares, places)
        distance = np.sqrt(np.einsum("ma,ma->m", way, way))
        forces = self.weights * barrier_force(distance, thickness)
        if self.kind == "ee_collisions":
            forces = forces * _mollified(places, self.scales)
        return shares, way / distance[:, None], forces


def collided(surface: CollisionSurface, collisions: Any) -> list[Collided]:
    """The library's collisions by kind, those lists that are not empty."""
    found = []
    for kind in KINDS:
        listed = getattr(collisions, kind)
        if len(listed):
            nodes = _nodes(kind, _numbers(collisions, kind), surface)
            there = nodes >= 0
            scales = [one.eps_x for one in listed] if kind == "ee_collisions" else np.ones(len(nodes))
            weights = np.array([one.weight for one in listed])
            found.append(Collided(kind, np.where(there, nodes, nodes[:, :1]), there, weights, np.array(scales)))
    return found


def touching(surface: CollisionSurface, collisions: Any, x: np.ndarray, thickness: float, stiffness: float) -> Touching:
    """The pairs that press each other apart.

    Args:
        surface: of the cloth.
        collisions: the library's at x (n, 3) [m].
        x: positions.
        thickness: distance at which contact begins [m]; stiffness: pressure of the barrier [Pa].
    """
    lists = collided(surface, collisions)
    if not lists:
        return Touching.none()
    found = [(one.nodes, *one.pressing(x[one.nodes], thickness)) for one in lists]
    nodes, shares, normals, forces = (np.concatenate(parts) for parts in zip(*found))
    return Touching(nodes, shares, normals, stiffness * forces)


def barrier_force(distance: np.ndarray, thickness: float) -> np.ndarray:
    """Pressure of the barrier over its stiffness, at distances [m] of less than the thickness [m].

    The energy by area over stiffness and thickness is -(y^2 - 1)^2 ln y^2, y the distance over the thickness.
    """
    y = distance / thickness
    inside = y.real < 1.0
    y = np.where(inside, y, 1.0)
    return np.where(inside, 4.0 * y * (y**2 - 1.0) * np.log(y**2) + 2.0 * (y**2 - 1.0) ** 2 / y, 0.0)


def _mollified(places: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """The part of the barrier that edges (m, 4, 3) have which are parallel, or nearly."""
    cross = np.cross(places[:, 1] - places[:, 0], places[:, 3] - places[:, 2])
    y = np.einsum("ma,ma->m", cross, cross) / scale
    y = np.where(y.real < 1.0, y, 1.0)
    return y * (2.0 - y)


def _two_nodes(places: np.ndarray) -> np.ndarray:
    return np.tile([1.0, -1.0, 0.0, 0.0], (len(places), 1))


def _edge_and_node(places: np.ndarray) -> np.ndarray:
    t = _along(places[:, 2], places[:, 0], places[:, 1])
    return np.column_stack([1.0 - t, t, np.full(len(t), -1.0), np.zeros(len(t))])


def _along(point: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """How far along edges the places nearest to points (m, 3) are, from 0 to 1."""
    edge = end - start
    length = np.einsum("ma,ma->m", edge, edge)
    return _within(np.einsum("ma,ma->m", point - start, edge) / length)


def _within(values: np.ndarray) -> np.ndarray:
    """Values (m,), those beyond 0 and 1 at these; complex steps are let through."""
    return np.where(values.real < 0.0, 0.0, np.where(values.real > 1.0, 1.0, values))


def _two_edges(places: np.ndarray) -> np.ndarray:
    """By the nearest places of both lines; where these are beyond the ends, by the nearest end."""
    a, b, c, d = places.transpose(1, 0, 2)
    u, v, w = b - a, d - c, a - c
    uu, uv, vv, uw, vw = (np.einsum("ma,ma->m", *pair) for pair in ((u, u), (u, v), (v, v), (u, w), (v, w)))
    square = uu * vv - uv**2
    crossed = square.real > 0.0
    s = _within(np.where(crossed, (uv * vw - vv * uw) / np.where(crossed, square, 1.0), 0.0))
    t = _along(a + s[:, None] * u, c, d)
    s = _along(c + t[:, None] * v, a, b)
    return np.column_stack([1.0 - s, s, t - 1.0, -t])


def _triangle_and_node(places: np.ndarray) -> np.ndarray:
    a, b, c, point = places.transpose(1, 0, 2)
    u, v, w = b - a, c - a, point - a
    uu, uv, vv, uw, vw = (np.einsum("ma,ma->m", *pair) for pair in ((u, u), (u, v), (v, v), (u, w), (v, w)))
    square = uu * vv - uv**2
    s, t = (vv * uw - uv * vw) / square, (uu * vw - uv * uw) / square
    return np.column_stack([1.0 - s - t, s, t, np.full(len(s), -1.0)])


SHARES = {
    "vv_collisions": _two_nodes,
    "ev_collisions": _edge_and_node,
    "ee_collisions": _two_edges,
    "fv_collisions": _triangle_and_node,
}
"""By the list of collisions, the shares (m, 4) of the nodes in the way between the nearest places, from theirs."""
