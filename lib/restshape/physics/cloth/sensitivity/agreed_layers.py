"""Friction between layers of cloth that has the normals and normal forces of the place: its tangent, and its rates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix

from restshape.physics.cloth.self_contact.self_contact import SelfContact
from restshape.physics.cloth.self_contact.touching_pairs import Collided, collided
from restshape.physics.cloth.sensitivity.agreed_contact import FREE, SLIDES, SLIDING, STICKS

STEP = 1e-30
"""Of complex steps, which are exact: nothing is subtracted."""


@dataclass(frozen=True, eq=False)
class Rubbing:
    """Pairs of one kind, with what friction remembers of them.

    Args:
        pairs: that touch.
        places: (m, 4, 3) of their nodes [m].
        shares: (m, 4) of the nodes there.
        offsets: (m, 3) how far each has slid and is still held back by [m].
    """

    pairs: Collided
    places: np.ndarray
    shares: np.ndarray
    offsets: np.ndarray

    def forces(self, places: np.ndarray, pairs: Collided, thickness: float, numbers: Sequence[complex]) -> np.ndarray:
        """Forces (m, 4, 3) [N] on the nodes at places (m, 4, 3) [m], where one argument may have a complex step.

        Args:
            places: of the nodes.
            pairs: with the weights and scales there.
            thickness: distance at which contact begins [m].
            numbers: stiffness [Pa], coefficient of friction, slip [m].
        """
        stiffness, friction, slip = numbers
        shares, normals, pressed = pairs.pressing(places, thickness)
        way = self.offsets + np.einsum("mk,mka->ma", self.shares, places - self.places)
        way = way - np.einsum("ma,ma->m", way, normals)[:, None] * normals
        y = np.sqrt(np.einsum("ma,ma->m", way, way)) / slip
        over = np.where(y.real < 1.0, 2.0 - y, 1.0 / np.where(y.real < 1.0, 1.0, y))
        size = friction * stiffness * pressed / slip * over
        return shares[:, :, None] * (size[:, None] * way)[:, None, :]


class AgreedLayers:
    """Friction between layers at an equilibrium, where its normals, places and normal forces agree with the cloth.

    Args:
        contact: of the cloth with itself, whose friction was updated at the equilibrium.
        x: (corners, 3) places of corners [m].
        numbers: (corners,) node of each corner; nodes: of the problem.

    Source: docs/theory/design-derivative.md.
    """

    def __init__(self, contact: SelfContact, x: np.ndarray, numbers: np.ndarray, nodes: int) -> None:
        self.contact, self.x, self.numbers, self.nodes = contact, x, numbers, nodes
        values, known = contact.values, contact.history.offsets
        self.values = values.stiffness, values.friction, values.slip
        self.lists: list[Rubbing] = []
        start = 0
        for one in collided(contact.surface, contact.at(x).collisions):
            places, stop = x[one.nodes], start + len(one.nodes)
            self.lists.append(Rubbing(one, places, one.pressing(places, values.thickness)[0], known[start:stop]))
            start = stop

    @property
    def counts(self) -> tuple[int, int]:
        """Pairs that stick, and pairs that slide."""
        slides = self._slides & (self.contact.history.touching.forces > 0.0)
        return int((self.contact.history.touching.forces > 0.0).sum() - slides.sum()), int(slides.sum())

    @property
    def states(self) -> np.ndarray:
        """What friction between layers does to each corner (corners,)."""
        found, touching = np.full(len(self.x), FREE), self.contact.history.touching
        for state, there in ((STICKS, ~self._slides), (SLIDES, self._slides)):
            there = there & (touching.forces > 0.0)
            found[touching.nodes[there][touching.shares[there] != 0.0]] = state
        return found

    @property
    def _slides(self) -> np.ndarray:
        length = np.linalg.norm(self.contact.history.offsets, axis=1)
        return length >= (1.0 - SLIDING) * self.contact.values.slip

    def tangent(self) -> csr_matrix:
        """What (3 nodes, 3 nodes) [N/m] the tangent of the frozen potential leaves out; it is not symmetric."""
        history, values = self.contact.history, self.contact.values
        frozen, start = history.hessians(self.x, values.friction, values.slip), 0
        rows, cols, entries = [], [], []
        for one in self.lists:
            m, stop = len(one.places), start + len(one.places)
            blocks = np.empty((m, 4, 3, 4, 3))
            for node in range(4):
                for axis in range(3):
                    places = one.places.astype(complex)
                    places[:, node, axis] += 1j * STEP
                    found = one.forces(places, one.pairs, values.thickness, self.values)
                    blocks[:, :, :, node, axis] = found.imag / STEP
            shared = np.einsum("mi,mj,mab->miajb", one.shares, one.shares, frozen[start:stop])
            blocks, start = blocks - shared, stop
            unknowns = (3 * self.numbers[one.pairs.nodes][:, :, None] + np.arange(3)).reshape(m, 12)
            rows.append(np.repeat(unknowns, 12, axis=1).ravel())
            cols.append(np.tile(unknowns, (1, 12)).ravel())
            entries.append(blocks.ravel())
        size = 3 * self.nodes
        if not rows:
            return csr_matrix((size, size))
        return csr_matrix((np.concatenate(entries), (np.concatenate(rows), np.concatenate(cols))), shape=(size, size))

    def pattern_rates(self, dX: np.ndarray) -> np.ndarray:
        """Rates (nodes, 3) [N] at constant places when corners move in the pattern with dX (corners, 2) [m].

        What presses pairs is by areas of the pattern; what is nearly parallel by lengths in it.
        """
        contact, moved = self.contact, np.column_stack([dX, np.zeros(len(dX))])
        if not contact.mesh.are_area_jacobians_initialized():
            contact.mesh.init_area_jacobians()
        near = contact.collisions(self.x, contact.values.thickness, differentiable=True)
        found, rest = [], contact.mesh.rest_positions
        gradient = contact.surface.library.edge_edge_mollifier_threshold_gradient
        for one in self.lists:
            listed = getattr(near, one.pairs.kind)
            weights = np.array([(part.weight_gradient.T @ moved.ravel()).item() for part in listed])
            scales = np.zeros(len(weights))
            if one.pairs.kind == "ee_collisions":
                scales = np.array([gradient(*rest[nodes]) @ moved[nodes].ravel() for nodes in one.pairs.nodes])
            stepped = replace(
                one.pairs,
                weights=one.pairs.weights + 1j * STEP * weights,
                scales=one.pairs.scales + 1j * STEP * scales,
            )
            found.append(one.forces(one.places, stepped, contact.values.thickness, self.values).imag / STEP)
        return self._spread(found)

    def number_rates(self, stiffness: float, friction: float, slip: float) -> np.ndarray:
        """Rates (nodes, 3) [N] with rates of the stiffness [Pa], of the coefficient of friction and of the slip [m]."""
        rates = stiffness, friction, slip
        stepped = [value + 1j * STEP * rate for value, rate in zip(self.values, rates)]
        thickness = self.contact.values.thickness
        return self._spread([one.forces(one.places, one.pairs, thickness, stepped).imag / STEP for one in self.lists])

    def _spread(self, found: Sequence[np.ndarray]) -> np.ndarray:
        """Sums (nodes, 3) of what is found of the nodes (m, 4, 3) of pairs."""
        out = np.zeros((self.nodes, 3))
        for one, forces in zip(self.lists, found):
            np.add.at(out, self.numbers[one.pairs.nodes], forces)
        return out
