"""Friction between layers of cloth: a potential of how far touching places have slid since they stuck."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from restshape.physics.cloth.sheet.turned_ways import maps_of_nodes

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
    def keys(self) -> tuple[np.ndarray, np.ndarray]:
        """The nodes of each pair and the side that each is on, as one value (m,), and 1 or -1 (m,) by their order.

        Pairs of one key lie at the same places: several edges that end there give as many. Where one has its places in
        the reverse order, its number is the other one.
        """
        sides = np.sign(self.shares).astype(np.int64) * (self.nodes + 1)
        sides = np.take_along_axis(sides, np.argsort(np.abs(sides), axis=1), axis=1)
        order = np.sign(sides[:, -1])
        keys = np.ascontiguousarray(sides * order[:, None])
        return keys.view([("", keys.dtype)] * 4).ravel(), order

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
        begin: of a frame, through which friction acts against all of the way from there; None: updates let go of what
            is beyond the way at which friction is all there.

    Source: docs/theory/cloth.md.
    """

    touching: Touching
    offsets: np.ndarray
    places: np.ndarray
    begin: LayersBegin | None = None

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
        if self.begin:
            return replace(self, touching=touching, offsets=self.begin.ways(x, touching), places=x.copy()), 0.0
        kept, slid = self._kept(x, slip)
        known = replace(self, offsets=kept)
        return LayerFriction(touching, touching.along(known.handed_on(touching)), x.copy()), slid

    def begun(self, x: np.ndarray, cells: np.ndarray, least: float) -> LayerFriction:
        """The history at the beginning of a frame, with nodes at x (n, 3) [m]; else as `LayersBegin`."""
        known = LayerFriction(self.touching, self._slid(x), x.copy())
        return replace(self, begin=LayersBegin(known, cells, least))

    def ended(self, x: np.ndarray, slip: float) -> tuple[LayerFriction, float]:
        """The history at the end of a frame, with nodes at x (n, 3) [m], and how far its pairs have slid [m]."""
        kept, slid = self._kept(x, slip)
        return replace(self, offsets=kept, places=x.copy(), begin=None), slid

    def moved(self, way: np.ndarray) -> LayerFriction:
        """The history when the material of nodes has moved, and they with it by (n, 3) [m], as cloth lies."""
        return replace(self, places=self.places + way)

    def mapped(self, x: np.ndarray, interpolate: Callable[[np.ndarray], np.ndarray]) -> np.ndarray:
        """What holds the nodes of another mesh of the same material, for `of_nodes`.

        Args:
            x: (n, 3) positions [m].
            interpolate: takes values (n, f) at the nodes to those of the other mesh (k, f).
        """
        return interpolate(replace(self, offsets=self._slid(x))._by_nodes())

    @classmethod
    def of_nodes(cls, x: np.ndarray, touching: Touching, slides: np.ndarray) -> LayerFriction:
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

    def _kept(self, x: np.ndarray, slip: float) -> tuple[np.ndarray, float]:
        """What holds pairs back (m, 3) at x (n, 3), and how far the farthest has slid without being held [m]."""
        kept = self._slid(x)
        length = np.linalg.norm(kept, axis=1)
        slid = float(np.maximum(length - slip, 0.0).max(initial=0.0, where=self.touching.forces > 0.0))
        return kept * np.minimum(1.0, slip / np.maximum(length, TINY))[:, None], slid

    def _by_nodes(self) -> np.ndarray:
        """What the pairs are held back by as sums (n, 4) at the nodes: ways by forces [N m], forces [N].

        Half of each way is on either side, to opposite directions.
        """
        pairs, slides = self.touching, np.zeros((len(self.places), 4))
        weights = pairs.forces[:, None] * pairs.shares
        np.add.at(slides[:, :3], pairs.nodes, weights[:, :, None] * self.offsets[:, None, :])
        np.add.at(slides[:, 3], pairs.nodes, np.abs(weights))
        return slides

    def handed_on(self, after: Touching) -> np.ndarray:
        """What the pairs are held back by, handed on to other pairs (k, 3) [m].

        Pairs that touch as before keep it, in either order of their sides. Others, such as a node on the next triangle,
        take what their nodes had.
        """
        before, kept = self.touching, self.offsets
        if not len(before.nodes) or not len(after.nodes):
            return np.zeros((len(after.nodes), 3))
        found = _from_nodes(self._by_nodes(), after)
        (known, order), (wanted, orders) = before.keys, after.keys
        values, first = np.unique(known, return_index=True)
        at = np.minimum(np.searchsorted(values, wanted), len(values) - 1)
        same, old = values[at] == wanted, first[at]
        found[same] = (kept[old] * (order[old] * orders)[:, None])[same]
        return found


@dataclass(frozen=True, eq=False)
class LayersBegin:
    """Where layers were as a frame has begun.

    Args:
        friction: what it remembered there.
        cells: (ne, 3) triangles.
        least: way [m] above which it turns with the triangles.
    """

    friction: LayerFriction
    cells: np.ndarray
    least: float

    def ways(self, x: np.ndarray, touching: Touching) -> np.ndarray:
        """How far (m, 3) [m] pairs that touch at x (n, 3) [m] have slid since, and what held them back.

        Where it is far, what was between their places turns with the triangles of both sides: layers that turn together
        have not slid.
        """
        places = self.friction.places
        kept, between = self.friction.handed_on(touching), touching.between(places)
        ways = kept + touching.between(x) - between
        far = np.linalg.norm(ways, axis=1) > self.least
        if far.any():
            nodes, shares, straight = touching.nodes[far], np.abs(touching.shares[far]), (kept - between)[far]
            turned = np.einsum("mk,mkab,mb->ma", shares, maps_of_nodes(places, x, self.cells)[nodes], straight)
            length, to = np.linalg.norm(straight, axis=1), np.linalg.norm(turned, axis=1)
            ways[far] = np.where((to > 0.0)[:, None], turned * (length / np.maximum(to, TINY))[:, None], straight)
        return touching.along(ways)


def _from_nodes(slides: np.ndarray, pairs: Touching) -> np.ndarray:
    """What pairs are held back by (m, 3) [m], from what their nodes are, see `LayerFriction._by_nodes`."""
    means = slides[:, :3] / np.maximum(slides[:, 3:], TINY)
    known = slides[:, 3] > 0.0
    size = (np.abs(pairs.shares) * known[pairs.nodes]).sum(axis=1)
    return np.einsum("mk,mka->ma", pairs.shares, means[pairs.nodes]) / np.maximum(size, 1.0)[:, None]
