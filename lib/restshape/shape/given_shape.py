"""How an outline follows the shape that a scene gives, when parameters change it after edits by hand."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.model import Scene
from restshape.scene.panels import frames_of
from restshape.scene.pattern_packing import PanelFrame
from restshape.shape.build import unchecked_outline
from restshape.shape.hand.gesture import Gesture, other_curves, towards
from restshape.shape.outline import Edge, Layout, Outline
from restshape.shape.panels.dart_corners import with_darts
from restshape.shape.panels.panel_placement import plane_axes
from restshape.shape.reinserted_vertices import arranged_as, reinserted
from restshape.shape.script_session import STILL
from restshape.shape.validity import problem

LINEAR = 1e-12
"""Share of the size of the shape within which control points go along a gesture."""


class Way(NamedTuple):
    """Where an edit without a hand has brought the shape: the outline, the gesture, and its coefficients."""

    outline: Outline
    gesture: Gesture
    c: tuple[float, float]


Follow = Callable[[Outline, Scene], Way | None]
"""Where a scene brings a shape; None where that stays."""


class ShapeFollower:
    """Follows the shape that a scene gives through the frames of an event.

    Args:
        outline: as edits have left it before the event.
        scene: before the event.
    """

    def __init__(self, outline: Outline, scene: Scene) -> None:
        self._start, self._scene = outline, scene
        self._gesture: Gesture | None = None

    def __call__(self, now: Outline, scene: Scene, part: float, whole: Callable[[float], Scene]) -> Way | None:
        """Where a scene of a part of the event brings the shape; None where it stays.

        Args:
            now: the shape.
            scene: of the part.
            part: of the event, 0 to 1.
            whole: gives the scene of any part.

        Raises:
            UserError: there is no such shape.
        """
        if scene.shape == self._scene.shape and now is self._start:
            return None
        wanted = self._outline(scene)
        wrong = problem(wanted)
        if wrong is not None:
            raise UserError(wrong)
        if wanted.topology != now.topology:
            return Way(wanted, towards("set", now, now), STILL)
        if np.array_equal(wanted.points, now.points) and not other_curves(now, wanted):
            return None
        if self._gesture is None:
            self._gesture = towards("set", self._start, wanted if part == 1.0 else self._outline(whole(1.0)))
        if self._goes_along(wanted, part):
            return Way(wanted, self._gesture, (part, 0.0))
        self._gesture = towards("set", now, wanted)
        return Way(wanted, self._gesture, (1.0, 0.0))

    def _goes_along(self, wanted: Outline, part: float) -> bool:
        """Whether the gesture to the end of the event leads to the shape of a part of it."""
        gesture = self._gesture
        if gesture is None or gesture.reference is not self._start.points:
            return False
        if not gesture.linear:
            return True
        away = float(np.abs(gesture.points((part, 0.0)) - wanted.points).max())
        return away <= LINEAR * wanted.size and not other_curves(self._start, wanted)

    def _outline(self, scene: Scene) -> Outline:
        before, after = (unchecked_outline(one.shape, one.folder) for one in (self._scene, scene))
        frames = frames_of(self._scene), frames_of(scene)
        start, before = in_frames(self._start, *frames), in_frames(before, *frames)
        known = self._scene.shape.darts
        if scene.shape.darts[: len(known)] == known and not np.array_equal(start.points, before.points):
            # What edits have moved has its new darts where it is.
            added = scene.shape.darts[len(known) :]
            return with_darts(start, added) if added else followed(start, before, after)
        return followed(start, before, after)


def in_frames(outline: Outline, now: Mapping[str, PanelFrame], wanted: Mapping[str, PanelFrame]) -> Outline:
    """An outline whose panels lie in other frames, so that what edits have moved in a panel stays there."""
    if now == wanted or now.keys() != wanted.keys():
        return outline
    points = outline.points.copy()
    for k, name in enumerate(outline.piece_names):
        if now[name] != wanted[name]:
            own = outline.layout.control_piece == k
            back, forth = plane_axes(now[name]), plane_axes(wanted[name])
            away = points[own] - now[name][:2]
            angle = now[name].angle != wanted[name].angle
            points[own] = (away @ back @ forth.T if angle else away) + wanted[name][:2]
    return Outline(outline.layout, points, outline.bulges, wanted)


def same_layout(one: Layout, other: Layout) -> bool:
    """Whether two layouts have the same names, edges and loops; knots of edges may differ."""
    keys = ("vertex_names", "loops", "embedded", "groups")
    if any(getattr(one, key) != getattr(other, key) for key in keys) or len(one.edges) != len(other.edges):
        return False
    return all(_alike(a, b) for a, b in zip(one.edges, other.edges))


def varied(outline: Outline, target: Outline) -> Outline:
    """An outline of the topology of one, with the control points, bulges and knots of another of the same layout.

    Polylines keep their knots, which do not change them.
    """
    knots = [b.knots if b.kind == "spline" else a.knots for a, b in zip(outline.edges, target.edges)]
    return Outline(outline.layout.with_knots(knots), target.points, target.bulges, target.frames)


def followed(outline: Outline, before: Outline, after: Outline) -> Outline:
    """The outline that edits have left, after the shape that the scene gives has changed.

    What edits have moved keeps its distance from where the scene has it. Vertices that edits have inserted, and holes
    that they have cut, stay where they are. Where the scene gives other edges inserted vertices go on theirs.

    Args:
        outline: as edits have left it.
        before: the shape that the scene gave until now; after: the one that it gives from now on.

    Raises:
        UserError: an edge whose points change was cut by an edit, or edits were made on another layout.
    """
    if not same_layout(before.layout, after.layout):
        if same_layout(outline.layout, before.layout):
            return _redrawn(outline, before, after)
        if (both := reinserted(outline, before, after)) is not None:
            return _redrawn(arranged_as(outline, both[0]), *both)
        what = "the scene gives the shape other edges now, and edits by hand have changed those before"
        raise UserError(what, do="undo these edits, or set it before the shape is edited")
    points, bulges = outline.points.copy(), outline.bulges.copy()
    knots = [edge.knots for edge in outline.edges]
    for place, old in _vertices(outline, before):
        points[place] = _shifted(points[place], before.points[old], after.points[old])
    for place, old in _edges(outline, before, after):
        own, was = list(outline.edges[place].inner), list(before.edges[old].inner)
        points[own] = _shifted(points[own], before.points[was], after.points[was])
        bulges[place] = _shifted(bulges[place], before.bulges[old], after.bulges[old])
        if outline.edges[place].kind == "spline" and knots[place] == before.edges[old].knots:
            knots[place] = after.edges[old].knots
    return Outline(outline.layout.with_knots(knots), points, bulges, after.frames)


def _redrawn(outline: Outline, before: Outline, after: Outline) -> Outline:
    """A shape of other edges, where edits have only moved the one before: what both have is as far from its place."""
    if np.array_equal(outline.points, before.points) and np.array_equal(outline.bulges, before.bulges):
        return after
    points, bulges = after.points.copy(), after.bulges.copy()
    for place, old in _vertices(after, before):
        points[place] = _shifted(points[place], before.points[old], outline.points[old])
    there = {edge.name: i for i, edge in enumerate(after.edges)}
    for old, edge in enumerate(before.edges):
        place = there.get(edge.name, -1)
        if place >= 0 and _alike(edge, replace(after.edges[place], start=edge.start, end=edge.end, inner=edge.inner)):
            own = list(after.edges[place].inner)
            points[own] = _shifted(points[own], before.points[list(edge.inner)], outline.points[list(edge.inner)])
            bulges[place] = _shifted(bulges[place], before.bulges[old], outline.bulges[old])
    return after.moved(points, bulges)


def _alike(one: Edge, other: Edge) -> bool:
    return len(one.knots) == len(other.knots) and replace(one, knots=()) == replace(other, knots=())


def _shifted(now: Reals, before: Reals, after: Reals) -> Reals:
    """Numbers moved as others are; exactly those others where they were the same."""
    return np.where(now == before, after, now + (after - before))


def _vertices(outline: Outline, before: Outline) -> Iterator[tuple[int, int]]:
    """Vertices that both have: their places in each."""
    there = {name: i for i, name in enumerate(outline.vertex_names)}
    return ((there[name], i) for i, name in enumerate(before.vertex_names) if name in there)


def _edges(outline: Outline, before: Outline, after: Outline) -> Iterator[tuple[int, int]]:
    """Edges that both have, of one kind and as many points: their places in each."""
    there = {edge.name: i for i, edge in enumerate(outline.edges)}
    for i, edge in enumerate(before.edges):
        place = there.get(edge.name)
        own = None if place is None else outline.edges[place]
        if own is not None and (own.kind, len(own.inner)) == (edge.kind, len(edge.inner)):
            yield there[edge.name], i
        elif _curve_changes(before, after, i) and any(piece.parent == edge.name for piece in outline.edges):
            what = f"an edit has cut or bent the edge {edge.name!r}, so that the scene does not give its form any more"
            raise UserError(what, do="undo that edit, or set the parameter before it")


def _curve_changes(before: Outline, after: Outline, edge: int) -> bool:
    """Whether an edge that is not straight changes from one outline to the other."""
    controls = before.layout.controls[edge]
    moves = not np.array_equal(before.points[controls], after.points[controls])
    bends = before.bulges[edge] != after.bulges[edge]
    return bool(bends or (moves and before.edges[edge].kind != "line"))
