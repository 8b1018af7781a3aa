"""Friction whose normals and normal forces are those of the place: what its frozen potential leaves out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import bsr_matrix, csr_matrix

from restshape.physics.cloth.contact import POTENTIAL, Contact


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

    def area_forces(self, shares: np.ndarray) -> np.ndarray:
        """Rates (k, 3) of the force when areas grow by these shares (k,) of themselves: the largest force does."""
        return (self.over * self.limit * shares)[:, None] * self.slid

    def anchor_forces(self, contact: Contact, number: int, places: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """Rates (k, 3) of the force when the anchors of all places move with rates (n + m, 3) [m]."""
        along = rates[self.at] - np.einsum("ka,ka->k", rates[self.at], self.normals)[:, None] * self.normals
        size = np.linalg.norm(self.slid, axis=1)
        way = self.slid / np.maximum(size, TINY)[:, None]
        share = size / contact.slip
        change = np.where(share < 1.0, 2.0 * (1.0 - share), 0.0) / contact.slip
        part = np.einsum("ka,ka->k", along, way)[:, None] * way
        return -self.limit[:, None] * (self.over[:, None] * (along - part) + change[:, None] * part)


SLIDING = 1e-6
"""Share of the slip below which a place at the end of its slip counts as one that sticks."""
TINY = 1e-300
"""Length [m] below which there is no direction."""


class AgreedFriction:
    """Friction of one contact at an equilibrium, where normals and normal forces agree with the places.

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

    def forces(self, of: dict[int, np.ndarray]) -> np.ndarray:
        """The sum (nodes, 3) of forces (k, 3) at the places that each body presses, by its number."""
        total = np.zeros((self.weights.shape[0], 3))
        for k, forces in of.items():
            total[self.pressed[k].at] += forces
        return self.weights.T @ total

    def design_rates(self, area_rates: np.ndarray, anchors: np.ndarray) -> np.ndarray:
        """Rates (nodes, 3) of friction at constant places.

        Args:
            area_rates: (n + m,) of what corners and points stand for [m^2].
            anchors: (n + m, 3) rates of the anchors [m].
        """
        shares = area_rates / self.contact.areas
        found = {}
        for k, one in self.pressed.items():
            anchored = one.anchor_forces(self.contact, k, self.places, anchors)
            found[k] = anchored + one.area_forces(shares[one.at])
        return self.forces(found)


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
