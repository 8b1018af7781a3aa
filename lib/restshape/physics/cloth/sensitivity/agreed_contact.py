"""Contact whose friction has the normals and normal forces of the place: its tangent, and its rates."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix

from restshape import _kernels
from restshape.physics.cloth.contact.contact import POTENTIAL, Contact

STICKS, SLIDES, FREE = 0, 1, 2
"""What friction does to a place."""
SLIDING = 1e-2
"""Share of the slip by which a place that slides may be short of it: friction is the largest to 1e-4 there."""


@dataclass(frozen=True, eq=False)
class Pressed:
    """The places that one body presses, at an equilibrium.

    Args:
        at: (k,) their numbers, those of points of triangles after those of corners.
        slid: (k, 3) the way u from the anchor along the surface [m].
        over: (k,) the force of friction over that way and over the largest force [1/m].
        limit: (k,) the largest force of friction, the coefficient times the normal force [N].
        friction: coefficient.
        normals: (k, 3) of the surface; hessians: (k, 3, 3) of its distance [1/m].
        curvature: (k,) how fast the normal force falls with the distance [N/m].
        slides: (k,) whether the largest force is reached.
    """

    at: np.ndarray
    slid: np.ndarray
    over: np.ndarray
    limit: np.ndarray
    friction: float
    normals: np.ndarray
    hessians: np.ndarray
    curvature: np.ndarray
    slides: np.ndarray

    @classmethod
    def by(cls, contact: Contact, number: int, places: np.ndarray) -> Pressed:
        """Those that a body presses at places (n + m, 3) [m], where friction was updated last."""
        body, history, friction = contact.bodies[number], contact.history, float(contact.friction[number])
        at = np.flatnonzero(history.limits[number] > 0.0)
        y = np.ascontiguousarray(places[at])
        _, normals, hessians = body.distance(y)
        table = np.zeros((len(at), POTENTIAL))
        body.add_contact(y, contact.areas[at], contact.stiffness, contact.thickness, table, False)
        limit = friction * np.maximum(-np.einsum("ka,ka->k", table[:, 3:6], normals), 0.0)
        way = y - history.anchors[number, at]
        slid = way - np.einsum("ka,ka->k", way, normals)[:, None] * normals
        share = np.linalg.norm(slid, axis=1) / contact.slip
        over = np.where(share < 1.0, 2.0 - share, 1.0 / np.maximum(share, 1.0)) / contact.slip
        curvature = table[:, 6:9].sum(axis=1)
        slides = share >= 1.0 - SLIDING
        return cls(at, slid, over, limit, friction, normals, hessians, curvature, slides)

    def tangents(self) -> np.ndarray:
        """What (k, 3, 3) [N/m] the tangent of the frozen potential leaves out.

        mu phi u (dN/dx)^T, for the normal force follows the place, and -L phi n (H u)^T, for so does the normal.
        """
        loss = -self.friction * self.over * self.curvature
        bent = self.limit * self.over
        turned = np.einsum("kab,kb->ka", self.hessians, self.slid)
        return np.einsum("k,ka,kb->kab", loss, self.slid, self.normals) - np.einsum(
            "k,ka,kb->kab", bent, self.normals, turned
        )


@dataclass(frozen=True, eq=False)
class BodyChange:
    """How a body changes.

    Args:
        body: with its rates.
        friction: rate of its coefficient.
        anchors: rates (n, 3) of the anchors (n, 3) [m] that it takes along.
    """

    body: _kernels.BodyRates
    friction: float
    anchors: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True, eq=False)
class ContactChange:
    """Rates of the numbers of contact.

    Args:
        stiffness: [N/m^3]; thickness: [m]; slip: [m].
        bodies: those that change, by their number.
    """

    stiffness: float = 0.0
    thickness: float = 0.0
    slip: float = 0.0
    bodies: Mapping[int, BodyChange] = field(default_factory=dict)


class AgreedContact:
    """Contact at an equilibrium, where the normals and normal forces of friction agree with the places.

    Args:
        contact: whose friction was updated at the equilibrium.
        corners: (n, 3) places of corners [m].
        numbers: (n,) node of each corner; nodes: of the problem.

    Source: docs/theory/design-derivative.md.
    """

    def __init__(self, contact: Contact, corners: np.ndarray, numbers: np.ndarray, nodes: int) -> None:
        self.contact, self.nodes = contact, nodes
        self.places = contact.place(corners)
        rough = [k for k, friction in enumerate(contact.friction) if friction > 0.0]
        self.pressed = {k: Pressed.by(contact, k, self.places) for k in rough}
        self.pressed = {k: one for k, one in self.pressed.items() if len(one.at)}
        self.weights = _weights(contact, numbers, nodes)

    @property
    def acts(self) -> bool:
        """Whether it holds any place."""
        return bool(self.pressed)

    @property
    def counts(self) -> tuple[int, int]:
        """Places that stick, and places that slide."""
        slide = sum(int(one.slides.sum()) for one in self.pressed.values())
        return sum(len(one.at) for one in self.pressed.values()) - slide, slide

    @property
    def states(self) -> np.ndarray:
        """What friction does to each place (n + m,)."""
        found = np.full(len(self.places), FREE)
        for one in self.pressed.values():
            state = np.where(one.slides, SLIDES, STICKS)
            found[one.at] = np.where(found[one.at] == SLIDES, SLIDES, state)
        return found

    def tangent(self) -> csr_matrix:
        """What (3 nodes, 3 nodes) [N/m] the tangent of the frozen potential leaves out; it is not symmetric."""
        count = self.weights.shape[0]
        blocks = np.zeros((count, 3, 3))
        for one in self.pressed.values():
            blocks[one.at] += one.tangents()
        touched = np.flatnonzero(blocks.any(axis=(1, 2)))
        own = bsr_matrix((blocks[touched], np.arange(len(touched)), np.arange(len(touched) + 1)))
        spread = _by_components(self.weights[touched])
        return (spread.T @ own @ spread).tocsr()

    def rates(
        self,
        way: np.ndarray | None = None,
        areas: np.ndarray | None = None,
        anchors: np.ndarray | None = None,
        change: ContactChange | None = None,
    ) -> np.ndarray:
        """Rates (nodes, 3) [N] of all forces of contact and friction, by dual numbers.

        Args:
            way: (nodes, 3) rates of the unknowns [m].
            areas: (n + m,) of what corners and points stand for [m^2].
            anchors: (n + m, 3) of all anchors [m], besides those that bodies take along.
            change: of the numbers of contact and of bodies.
        """
        contact, change = self.contact, change or ContactChange()
        still, none = np.zeros_like(self.places), np.zeros(len(self.places))
        way = still if way is None else np.ascontiguousarray(self.weights @ way)
        areas, anchors = none if areas is None else areas, still if anchors is None else anchors
        total = np.zeros_like(self.places)
        for k, body in enumerate(contact.bodies):
            mine = change.bodies.get(k)
            towed = anchors if mine is None else anchors + mine.anchors(contact.history.anchors[k])
            (_kernels.BodyRates(body) if mine is None else mine.body).add_force_rates(
                self.places,
                way,
                contact.areas,
                areas,
                (contact.stiffness, change.stiffness),
                (contact.thickness, change.thickness),
                (float(contact.friction[k]), 0.0 if mine is None else mine.friction),
                (contact.slip, change.slip),
                contact.history.anchors[k],
                towed,
                contact.history.limits[k],
                total,
            )
        return self.weights.T @ total


def _weights(contact: Contact, numbers: np.ndarray, nodes: int) -> csr_matrix:
    """The matrix (n + m, nodes) from values of nodes to those of corners and points."""
    n, points = len(numbers), contact.points
    rows, cols, values = [np.arange(n)], [numbers], [np.ones(n)]
    if points is not None and len(points.cut):
        m = len(points.cell)
        rows.append(n + np.repeat(np.arange(m), 3))
        cols.append(numbers[points.nodes].ravel())
        values.append(points.weights.ravel())
    count = n + (len(rows[1]) // 3 if len(rows) > 1 else 0)
    data = tuple(map(np.concatenate, (values, rows, cols)))
    return csr_matrix((data[0], data[1:]), shape=(count, nodes))


def _by_components(weights: csr_matrix) -> csr_matrix:
    """The same matrix for three components of each value."""
    rows, cols = weights.shape
    blocks = weights.data[:, None, None] * np.eye(3)
    return bsr_matrix((blocks, weights.indices, weights.indptr), shape=(3 * rows, 3 * cols)).tocsr()
