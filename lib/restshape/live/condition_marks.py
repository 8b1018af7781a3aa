"""Marks of supports and loads: where they act, and which way."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from restshape.errors import UserError
from restshape.live.shown_marks import Arrows, Lines, Mark
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


@dataclass(frozen=True, eq=False)
class ActsOn:
    """Where a support or a load acts, as nodes of a mesh.

    Args:
        name: of the support or load.
        load: None of a support.
        sides: (m, 2) nodes of facets in order; nodes: (k,) of vertices, where there are no facets.
        inner: the node nearest to the middle of the material, where the load acts inside; None elsewhere.
    """

    name: str
    load: Load | None
    sides: Indices
    nodes: Indices
    inner: Indices | None = None


class ConditionMarks:
    """Marks of the supports, loads and accelerations of each frame; those of one that rests are the same objects."""

    def __init__(self) -> None:
        self._bound: tuple[object, ...] = ()
        self._acting: list[ActsOn] = []
        self._inner: Indices = np.zeros(1, dtype=np.int32)
        self._shown: tuple[tuple[object, ...], list[Mark]] = ((), [])

    def __call__(self, seen: SeenFrame) -> list[Mark]:
        """The marks of a frame."""
        scene, space = seen.scene, seen.space
        bound = scene, space, space.topology
        if not _same(bound, self._bound):
            self._bound, self._inner = bound, _inner_node(space)
            self._acting = list(_acting(scene, space, self._inner))
        drawn = *bound, space.geometry, seen.deformed
        if not _same(drawn, self._shown[0]):
            marks = [mark for one in self._acting if (mark := _mark(one, seen)) is not None]
            self._shown = drawn, [*marks, *_accelerations(seen, self._inner)]
        return self._shown[1]


def _same(these: tuple[object, ...], those: tuple[object, ...]) -> bool:
    """Whether two keys are of the same objects, and of the same numbers."""
    return len(these) == len(those) and all(
        one == other if isinstance(one, int) else one is other for one, other in zip(these, those)
    )


def _inner_node(space: PlaneSpace) -> Indices:
    """The node (1,) nearest to the middle of all nodes: in the material, whatever holes it has."""
    X = space.X
    return np.array([int(((X - X.mean(axis=0)) ** 2).sum(axis=1).argmin())], dtype=np.int32)


def _acting(scene: Scene, space: PlaneSpace, inner: Indices) -> Iterator[ActsOn]:
    """Where the supports and loads of a scene act."""
    conditions = [(name, None, one.on) for name, one in scene.supports.items()]
    for name, load, on in (*conditions, *((name, one, one.on) for name, one in scene.loads.items())):
        for place in on:
            inside = load is not None and (load.kind == "body" or place == "all")
            try:
                sides, nodes = space.facets[space.facets_of(place)][:, :2], space.nodes_of(place)
            except UserError:
                # What an edit has removed acts nowhere.
                continue
            yield ActsOn(name, load, sides, nodes[:ALONG], inner if inside else None)


def _mark(one: ActsOn, seen: SeenFrame) -> Mark | None:
    if one.load is None:
        return _support(one, seen)
    kind = one.load.kind
    if one.inner is not None:
        return _inside(one, seen, one.load, one.inner)
    if len(one.sides):
        chosen = one.sides[_spread(len(one.sides))]
        ends = seen.space.X[chosen]
        along = ends[:, 1] - ends[:, 0]
        outwards = np.column_stack([along[:, 1], -along[:, 0]])
        outwards /= np.maximum(np.linalg.norm(outwards, axis=1, keepdims=True), 1e-300)
        at, moved = seen.places(chosen).mean(axis=1), seen.moved(chosen)
        moved = None if moved is None else moved.mean(axis=1)
    elif len(one.nodes):
        at, moved, outwards = seen.places(one.nodes), seen.moved(one.nodes), np.zeros((len(one.nodes), 2))
    else:
        return None
    vectors = load_vectors(seen.scene, one.name, one.load, Place([], at, at[:, :2], outwards, at[0, :2]), False)
    if vectors is None or not vectors.any():
        return Lines(f"load {one.name}", at, range(len(at)), "load", moved)
    pushes = (vectors * outwards).sum(axis=1) < PUSHES * np.linalg.norm(vectors, axis=1)
    unit = UNITS.get(kind, "")
    return Arrows(f"load {one.name}", at, vectors, unit, "load", _on_middle(vectors, unit), moved, pushes.tolist())


def _inside(one: ActsOn, seen: SeenFrame, load: Load, inner: Indices) -> Mark | None:
    """The arrow of a load on all of a body."""
    at, none = seen.places(inner), np.zeros((1, 2))
    vectors = load_vectors(seen.scene, one.name, load, Place([], at, at[:, :2], none, at[0, :2]), True)
    if vectors is None or not vectors.any():
        return None
    unit = UNITS.get(load.kind, "")
    return Arrows(f"load {one.name}", at, vectors, unit, "load", _on_middle(vectors, unit), seen.moved(inner))


def _support(one: ActsOn, seen: SeenFrame) -> Mark | None:
    """The edges that a support holds, or its points."""
    if len(one.sides):
        # A line goes on as long as the next facet begins where it has ended.
        starts = np.flatnonzero(np.append(True, one.sides[1:, 0] != one.sides[:-1, 1]))
        ends = one.sides[np.append(starts[1:], len(one.sides)) - 1, 1]
        nodes = np.insert(one.sides[:, 0], np.append(starts[1:], len(one.sides)), ends)
        begins = (starts + np.arange(len(starts))).tolist()
    elif len(one.nodes):
        nodes, begins = one.nodes, list(range(len(one.nodes)))
    else:
        return None
    return Lines(f"support {one.name}", seen.places(nodes), begins, "support", seen.moved(nodes))


def _accelerations(seen: SeenFrame, inner: Indices) -> Iterator[Mark]:
    """An arrow for each acceleration of all bodies, such as gravity, in the middle."""
    for name, value in accelerations(seen.scene).items():
        way = in_plane(seen.scene, name, value)
        if way.any():
            at, words = seen.places(inner), [si(float(np.hypot(*way)), "m/s²")]
            yield Arrows(name, at, way[None], "m/s²", "load", words, seen.moved(inner))


def _spread(count: int) -> Indices:
    """Which of so many facets along a chain have arrows."""
    few = min(count, ALONG)
    return ((np.arange(few) + 0.5) * (count / few)).astype(np.int32)


def _on_middle(vectors: Reals, unit: str) -> list[str]:
    """The size of the arrow in the middle, and no words of the others."""
    words = [""] * len(vectors)
    middle = len(vectors) // 2
    words[middle] = si(float(np.linalg.norm(vectors[middle])), unit)
    return words
