"""Friction between layers of cloth: a potential of how far touching places have slid since they stuck."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

TINY = 1e-300
"""Length [m] below which there is no direction."""


@dataclass(frozen=True, eq=False)
class Touching:
    """Pairs of places that touch, each place a mean of nodes.

    Args:
        nodes: (m, 4) of each pair; where there are fewer, the first one again, with no share.
        shares: (m, 4) of the nodes in the way between both places: those of one side add up to 1, the others to -1.
        normals: (m, 3) from one place to the other, of length 1.
        forces: (m,) that press the pairs apart [N].
    """

    nodes: np.ndarray
    shares: np.ndarray
    normals: np.ndarray
    forces: np.ndarray

    @classmethod
    def none(cls) -> Touching:
        """No pairs."""
        return cls(np.zeros((0, 4), np.int64), np.zeros((0, 4)), np.zeros((0, 3)), np.zeros(0))

    @property
    def keys(self) -> np.ndarray:
        """The pairs' nodes (m, 4), ordered, as one value each."""
        ordered = np.ascontiguousarray(np.sort(np.where(self.shares != 0.0, self.nodes, -1), axis=1))
        return ordered.view([("", ordered.dtype)] * 4).ravel()

    def between(self, values: np.ndarray) -> np.ndarray:
        """The differences (m, 3) between both places of each pair, of values (n, 3) of the nodes."""
        return np.einsum("mk,mka->ma", self.shares, values[self.nodes])

    def along(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (m, 3) without their parts along the normals."""
        return vectors - np.einsum("ma,ma->m", vectors, self.normals)[:, None] * self.normals


@dataclass(frozen=True, eq=False)
class LayerFriction:
    """What friction between layers remembers; each update makes another one.

    Args:
        touching: at the last update.
        offsets: (m, 3) how far each pair had slid then and is still held back by [m].
        places: (n, 3) of the nodes then [m].

    Source: docs/theory/cloth.md.
    """

    touching: Touching
    offsets: np.ndarray
    places: np.ndarray

    @classmethod
    def none(cls, nodes: int) -> LayerFriction:
        """The history of layers that have not touched."""
        return cls(Touching.none(), np.zeros((0, 3)), np.zeros((nodes, 3)))

    def updated(self, x: np.ndarray, touching: Touching, slip: float) -> tuple[LayerFriction, float]:
        """The history with pairs that touch at x (n, 3), and the farthest way that one has slid on without being held.

        Args:
            x: positions [m].
            touching: pairs at x.
            slip: way at which friction is all there [m].
        """
        kept = self._slid(x)
        length = np.linalg.norm(kept, axis=1)
        slid = float(np.maximum(length - slip, 0.0).max(initial=0.0, where=self.touching.forces > 0.0))
        kept *= np.minimum(1.0, slip / np.maximum(length, TINY))[:, None]
        return LayerFriction(touching, touching.along(self._handed(kept, touching)), x.copy()), slid

    def moved(self, way: np.ndarray) -> LayerFriction:
        """The history when the material of nodes has moved, and they with it by (n, 3) [m], as cloth lies."""
        return replace(self, places=self.places + way)

    def mapped(self, x: np.ndarray, interpolate: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """What holds the nodes of another mesh of the same material, for `begun`.

        Args:
            x: (n, 3) positions [m].
            interpolate: takes values (n, f) at the nodes to those of the other mesh (k, f).
        """
        return interpolate(self._by_nodes(self._slid(x)))

    @classmethod
    def begun(cls, x: np.ndarray, touching: Touching, slides: np.ndarray) -> LayerFriction:
        """The history of pairs that touch at x (n, 3) [m], from what holds the nodes (n, 4), see `mapped`."""
        return cls(touching, touching.along(_from_nodes(slides, touching)), x.copy())

    def energy(self, x: np.ndarray, friction: float, slip: float) -> float:
        """The potential [J] at x (n, 3) [m]."""
        y = np.linalg.norm(self._slid(x), axis=1) / slip
        part = np.where(y < 1.0, y**2 - y**3 / 3.0, y - 1.0 / 3.0)
        return float(friction * slip * (self.touching.forces @ part))

    def add_forces(self, x: np.ndarray, friction: float, slip: float, out: np.ndarray) -> None:
        """Add the gradient [N] of the potential at x (n, 3) to `out` (n, 3)."""
        slid = self._slid(x)
        y = np.linalg.norm(slid, axis=1) / slip
        # The force over the way.
        over = friction * self.touching.forces / slip * np.where(y < 1.0, 2.0 - y, 1.0 / np.maximum(y, 1.0))
        forces = self.touching.shares[:, :, None] * (over[:, None] * slid)[:, None, :]
        np.add.at(out, self.touching.nodes, forces)

    def hessians(self, x: np.ndarray, friction: float, slip: float) -> np.ndarray:
        """Second derivatives (m, 3, 3) [N/m] of the pairs' potentials by the ways between both places at x (n, 3)."""
        slid, normals = self._slid(x), self.touching.normals
        length = np.linalg.norm(slid, axis=1)
        y, way = length / slip, slid / np.maximum(length, TINY)[:, None]
        size = friction * self.touching.forces / slip
        over = size * np.where(y < 1.0, 2.0 - y, 1.0 / np.maximum(y, 1.0))
        rate = size * np.where(y < 1.0, 2.0 - 2.0 * y, 0.0)
        across = np.eye(3) - np.einsum("ma,mb->mab", normals, normals)
        turned = np.einsum("ma,mb->mab", way, way)
        return over[:, None, None] * (across - turned) + rate[:, None, None] * turned

    def _slid(self, x: np.ndarray) -> np.ndarray:
        """How far (m, 3) [m] the pairs have slid, as far as they are held back."""
        return self.touching.along(self.offsets + self.touching.between(x - self.places))

    def _by_nodes(self, kept: np.ndarray) -> np.ndarray:
        """What the pairs are held back by (m, 3) [m] as sums (n, 4) at the nodes: ways by forces [N m], forces [N].

        Half of each way is on either side, to opposite directions.
        """
        pairs, slides = self.touching, np.zeros((len(self.places), 4))
        weights = pairs.forces[:, None] * pairs.shares
        np.add.at(slides[:, :3], pairs.nodes, weights[:, :, None] * kept[:, None, :])
        np.add.at(slides[:, 3], pairs.nodes, np.abs(weights))
        return slides

    def _handed(self, kept: np.ndarray, after: Touching) -> np.ndarray:
        """What the pairs were held back by (m, 3), handed on to other pairs (k, 3) [m].

        Pairs that touch as before keep it. Others, such as a node on the next triangle, take what their nodes had.
        """
        before = self.touching
        if not len(before.nodes) or not len(after.nodes):
            return np.zeros((len(after.nodes), 3))
        found = _from_nodes(self._by_nodes(kept), after)
        _, old, new = np.intersect1d(before.keys, after.keys, return_indices=True)
        same = np.einsum("mk,mk->m", *self._aligned(old, new, after)) > 0.0
        found[new[same]] = kept[old[same]]
        return found

    def _aligned(self, old: np.ndarray, new: np.ndarray, after: Touching) -> tuple[np.ndarray, np.ndarray]:
        """The shares (k, 4) of pairs that are in both lists, in the same order of nodes."""
        lists = ((self.touching, old), (after, new))
        orders = [np.argsort(np.where(part.shares[at] != 0.0, part.nodes[at], -1), axis=1) for part, at in lists]
        first, second = (np.take_along_axis(part.shares[at], order, 1) for (part, at), order in zip(lists, orders))
        return first, second


def _from_nodes(slides: np.ndarray, pairs: Touching) -> np.ndarray:
    """What pairs are held back by (m, 3) [m], from what their nodes are, see `LayerFriction._by_nodes`."""
    means = slides[:, :3] / np.maximum(slides[:, 3:], TINY)
    known = slides[:, 3] > 0.0
    size = (np.abs(pairs.shares) * known[pairs.nodes]).sum(axis=1)
    return np.einsum("mk,mka->ma", pairs.shares, means[pairs.nodes]) / np.maximum(size, 1.0)[:, None]
