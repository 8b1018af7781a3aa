"""Marks of supports and loads: where they act, and which way."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.live.kept_marks import same_objects
from restshape.live.shown_marks import NOWHERE, Arrows, Lines, Mark
from restshape.outputs.si_numbers import si
from restshape.report.entity_outlines import ALONG, Place
from restshape.report.load_vectors import accelerations, in_plane, load_vectors

if TYPE_CHECKING:
    from restshape.arrays import Indices, Reals
    from restshape.fem.space import PlaneSpace
    from restshape.live.seen_frame import SeenFrame
    from restshape.scene.model import Load, Scene

UNITS = {"force": "N", "traction": "Pa", "pressure": "Pa", "body": "N/m³"}
"""Of kinds of loads that are vectors, or become some."""
PUSHES = -1e-9
"""Cosine with the normal out of the body below which a load pushes on it."""


class ConditionMarks:
    """Marks of the supports, loads and accelerations of each frame.

    What they act on stays as long as entities keep their nodes and the scene its values; those of a frame that rests
    are the same objects.
    """

    def __init__(self) -> None:
        self._scene: Scene | None = None
        self._bound: tuple[object, ...] = ()
        self._acting: list[ActsOn | LoadArrows] = []
        self._geometry, self._deformed = -1, cast("Reals | None", None)
        self._shown: list[Mark] = []

    def __call__(self, seen: SeenFrame) -> list[Mark]:
        """The marks of a frame."""
        space, scene = seen.space, seen.scene
        known = scene is self._scene and space is self._bound[-2] and space.facets is self._bound[-1]
        if not known:
            # Edits of other tables leave these as they are.
            bound = scene.supports, scene.loads, scene.effects, scene.parameters, space, space.facets
            known = same_objects(bound, self._bound)
            self._scene, self._bound = scene, bound
        if not known:
            self._acting = [*_supports(scene, space), *_loads(scene, space)]
        if not known or self._geometry != space.geometry or self._deformed is not seen.deformed:
            self._geometry, self._deformed = space.geometry, seen.deformed
            self._shown = [one.mark(seen) for one in self._acting]
        return self._shown


class ActsOn:
    """Edges or points on which a support acts.

    Args:
        name: what it is.
        nodes: (m,) along its lines, one line after the other; starts: index of the first of each.
    """

    def __init__(self, name: str, nodes: Indices, starts: Sequence[int]) -> None:
        self.name, self.nodes, self.starts = name, nodes, starts
        self._last = Lines("", np.empty((0, 2)))

    def mark(self, seen: SeenFrame) -> Mark:
        """The lines of a frame: the last ones where nothing has moved."""
        if seen.all_nodes_drawn:
            if self._last.nodes is None:
                self._last = Lines(self.name, NOWHERE, self.starts, "support", nodes=self.nodes[:, None])
            return self._last
        at, moved = seen.places(self.nodes), seen.moved(self.nodes)
        if not (_equal(at, self._last.points) and _equal(moved, self._last.moved)):
            self._last = Lines(self.name, at, self.starts, "support", moved)
        return self._last


class LoadArrows:
    """Arrows of a load, or of an acceleration; made again where the places on which it acts have moved.

    Args:
        name: what it is; load: None of an acceleration.
        ends: (m, 2) nodes between which the arrows stand, on facets in order: the body is on their left.
        inside: it acts in the body, not on facets.
        vector: (2,) of an acceleration.
    """

    def __init__(self, name: str, load: Load | None, ends: Indices, inside: bool, vector: Reals | None = None) -> None:
        self.name, self.load, self.ends, self.inside, self.vector = name, load, ends, inside, vector
        self._rows = ends.ravel().astype(np.intp)
        self._at: Reals | None = None
        self._both: Reals | None = None
        self._last: Arrows | Lines = Lines("", np.empty((0, 2)))

    def mark(self, seen: SeenFrame) -> Mark:
        """The arrows of a frame: the last ones where nothing has moved."""
        at = seen.space.X.take(self._rows, axis=0)
        if not _equal(at, self._at):
            self._at, self._both, self._last = at, None, self._made(seen.scene, seen.places(self.ends))
            if seen.all_nodes_drawn:
                self._last = self._last.at_nodes(self.ends)
        if self._last.nodes is not None or seen.all_nodes_drawn:
            return self._last
        if not _equal(both := seen.moved(self.ends), self._both):
            self._both = both
            self._last = self._last.gone(None if both is None else 0.5 * (both[:, 0] + both[:, 1]))
        return self._last

    def _made(self, scene: Scene, ends: Reals) -> Arrows | Lines:
        """The arrows between places (m, 2, d); lines where the load has no direction."""
        at, along = 0.5 * (ends[:, 0] + ends[:, 1]), ends[:, 1, :2] - ends[:, 0, :2]
        outwards = np.stack([along[:, 1], -along[:, 0]], axis=1)
        outwards /= np.maximum(np.hypot(*along.T)[:, None], 1e-300)
        return arrows_of(scene, self.name, self.load, Place([], at, at, outwards, at[0, :2]), self.inside, self.vector)


def arrows_of(
    scene: Scene, name: str, load: Load | None, place: Place, inside: bool, vector: Reals | None = None
) -> Arrows | Lines:
    """The arrows of a load, or of an acceleration; lines where the load has no direction.

    Args:
        scene: of it; name: what it is; load: None of an acceleration.
        place: where the arrows stand; inside: it acts in the body, not on edges; vector: (2,) of an acceleration.
    """
    if load is None:
        assert vector is not None, "an acceleration has a vector"
        vectors: Reals | None = vector[None]
        unit, key = "m/s²", name
    else:
        # In space, too, loads of a plane shape act in its plane.
        flat = replace(place, at=place.at[:, :2])
        vectors = load_vectors(scene, name, load, flat, inside)
        unit, key = UNITS.get(load.kind, ""), f"load {name}"
    if vectors is None or not vectors.any():
        return Lines(key, place.at, range(len(place.at)), "load")
    sizes = np.hypot(*vectors.T)
    tips = (vectors * place.outwards).sum(axis=1) < PUSHES * sizes
    words = [""] * len(vectors)
    words[len(words) // 2] = si(float(sizes[len(words) // 2]), unit)
    return Arrows(key, place.at, vectors, unit, "load", words, None, tips.tolist())


def _equal(these: Reals | None, those: Reals | None) -> bool:
    """Whether two arrays are the same; or there is neither."""
    if these is None or those is None:
        return these is those
    return these.shape == those.shape and _kernels.same_bits(these, those)


def _supports(scene: Scene, space: PlaneSpace) -> Iterator[ActsOn]:
    """What the supports of a scene act on; what an edit has removed is left out."""
    for name, support in scene.supports.items():
        for on in support.on:
            sides, vertices = _sides(space, on), _vertices(space, on)
            if len(sides):
                # A line goes on as long as the next facet begins where the last one has ended.
                starts = np.flatnonzero(np.append(True, sides[1:, 0] != sides[:-1, 1]))
                after = np.append(starts[1:], len(sides))
                nodes = np.insert(sides[:, 0], after, sides[after - 1, 1])
                yield ActsOn(f"support {name}", nodes, (starts + np.arange(len(starts))).tolist())
            elif len(vertices):
                yield ActsOn(f"support {name}", vertices, range(len(vertices)))


def _loads(scene: Scene, space: PlaneSpace) -> Iterator[LoadArrows]:
    """The arrows of the loads and accelerations of a scene; those inside stand near the middle of the material."""
    X = space.X
    inner = np.full((1, 2), ((X - X.mean(axis=0)) ** 2).sum(axis=1).argmin(), dtype=np.int32)
    for name, load in scene.loads.items():
        for on in load.on:
            if load.kind == "body" or on == "all":
                yield LoadArrows(name, load, inner, inside=True)
                continue
            sides, vertices = _sides(space, on), _vertices(space, on)
            if not len(sides):
                sides = np.stack([vertices, vertices], axis=1)
            if len(sides):
                few = min(len(sides), ALONG)
                spread = ((np.arange(few) + 0.5) * (len(sides) / few)).astype(np.int32)
                yield LoadArrows(name, load, sides[spread], inside=False)
    for name, value in accelerations(scene).items():
        if (way := in_plane(scene, name, value)).any():
            yield LoadArrows(name, None, inner, inside=True, vector=way)


def _sides(space: PlaneSpace, on: str) -> Indices:
    """The ends (m, 2) of the facets of an entity, in order; none where there is no such entity."""
    try:
        found: Indices = space.facets[space.facets_of(on)][:, :2]
    except UserError:
        found = np.empty((0, 2), dtype=np.int32)
    return found


def _vertices(space: PlaneSpace, on: str) -> Indices:
    """The nodes (k,) of an entity; none where there is no such entity."""
    try:
        return space.nodes_of(on)
    except UserError:
        return np.empty(0, dtype=np.int32)
