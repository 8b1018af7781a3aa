"""Outlines from what a scene says about its shape."""

# More than 15 modules: all that draws a shape enters here.

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import ParamSpec, TypeVar

import numpy as np
from pydantic import ValidationError

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.bare_lengths import with_bare_lengths
from restshape.scene.model import CircleLoop, EdgeLoop, PolygonLoop, Scene, ShapeSpec
from restshape.scene.plain_values import table_in
from restshape.scene.shape_edges import ArcSpec, LineSpec, PolylineSpec, SplineSpec
from restshape.scene.source import Source
from restshape.scene.validation_errors import user_error
from restshape.shape.curves import bulge_through
from restshape.shape.draft import Draft, DraftEdge, add_circle, add_loop, add_polygon
from restshape.shape.drawings.imported_shape import imported_shape
from restshape.shape.outline import Outline
from restshape.shape.panels.dart_corners import dart_named, with_darts
from restshape.shape.panels.pleat_folds import with_pleats
from restshape.shape.validity import problem

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")


def unchecked_outline(spec: ShapeSpec, scene_dir: Path | str = ".") -> Outline:
    """The outline that a ``ShapeSpec`` describes, whose loops may cross.

    Args:
        spec: a ``ShapeSpec``, the ``[shape]`` of a scene.
        scene_dir: folder that ``shape.file`` is relative to.

    Raises:
        UserError: open or degenerate loops, unknown or repeated names, unreadable file; with the key below ``shape``
            that is wrong.
    """
    spec = with_file(spec, Path(scene_dir))
    if not spec.pieces:
        raise UserError("the shape has no outline", "shape.outline", "list the edges of the outer loop in order")
    draft = Draft(vertices={name: (float(p[0]), float(p[1])) for name, p in spec.vertices.items()})
    draft.frames = spec.panel_frames()
    for name, edge in spec.edges.items():
        draft.edges[name] = _edge(draft, name, edge)
    for name, edges in spec.pieces.items():
        _located("shape.outline", add_loop, draft, name, "outline", list(edges))
    for key, kind in (("holes", "hole"), ("regions", "region")):
        for name, loop in getattr(spec, key).items():
            _located(f"shape.{key}.{name}", _add, draft, name, kind, loop)
    _refuse_unused(draft)
    for name, p in spec.points.items():
        if name in draft.vertices:
            raise UserError(f"the name {name!r} is used twice", f"shape.points.{name}", "rename one of them")
        draft.vertices[name] = (float(p[0]), float(p[1]))
    draft.groups = {name: tuple(parts) for name, parts in spec.groups.items()}
    outline = _located("shape", draft.outline)
    _check_groups(outline)
    return with_pleats(with_darts(outline, spec.darts), spec.pleats)


def outline_from_spec(spec: ShapeSpec, scene_dir: Path | str = ".") -> Outline:
    """The outline that a ``ShapeSpec`` describes, in one piece and valid; arguments as of `unchecked_outline`.

    Raises:
        UserError: as `unchecked_outline`; or loops that cross, touch or leave the outline.
    """
    outline = unchecked_outline(spec, scene_dir)
    wrong = problem(outline)
    if wrong:
        do = "mend it: loops must neither cross, touch nor leave the outline"
        if wrong.startswith("point ") and "closer" in wrong:
            do = "move it inside; on an edge let it be a vertex, between two edges"
        apart = "give one of them another `at`, or leave it out: panels without are packed in rows"
        if not wrong.startswith("panel") and (dart := dart_named(spec.darts, outline, wrong)):
            do = "make the dart shorter, or narrower or wider, or move it"
            raise UserError(wrong, dart.where, do)
        place = _place(outline, wrong)
        if place.startswith("shape.regions."):
            name = place.rpartition(".")[2]
            do = f"keep it inside, or give it the outline's own edges as sides: {name} = {{ loop = [...] }}"
        raise UserError(wrong, place, apart if wrong.startswith("panel") else do)
    return outline


def outline_of(scene: Scene) -> Outline:
    """The outline of the tables of a scene, before any edit.

    Raises:
        UserError: as `outline_from_spec`, with file and line.
    """
    try:
        return outline_from_spec(scene.shape, scene.folder)
    except UserError as error:
        raise with_bare_lengths(scene.located(error), scene) from error


def _place(outline: Outline, wrong: str) -> str:
    """The key of the hole or region whose edges a message names; that of the shape where it names none of them.

    Of panels it is that of the panel.
    """
    words = wrong.replace(",", " ").split()
    if outline.piece_names != ("outline",):
        named = [k for edge, k in zip(outline.edges, outline.layout.edge_piece.tolist()) if edge.name in words]
        return f"panels.{outline.piece_names[named[0]]}" if len(set(named)) == 1 else "panels"
    for loop in outline.loops:
        if loop.kind in ("hole", "region") and any(outline.edges[edge].name in words for edge, _ in loop.edges):
            return f"shape.{loop.kind}s.{loop.name}"
    return "shape"


def with_file(spec: ShapeSpec, scene_dir: Path) -> ShapeSpec:
    """The shape with the outline of its ``file`` read in; what the scene adds itself comes on top."""
    drawing = imported_shape(spec, scene_dir)
    if drawing is None or spec.file is None:
        return spec
    read = drawing.tables
    own = spec.model_dump(exclude_unset=True, exclude={"file", "layers", "tolerance"})
    merged = {**read, **own}
    for key in ("vertices", "edges", "holes", "regions", "groups"):
        merged[key] = {**table_in(read, key), **table_in(own, key)}
    try:
        return type(spec).model_validate(merged).with_darts(spec.darts).with_pleats(spec.pleats)
    except ValidationError as error:
        raise user_error(error, Source(scene_dir / spec.file), type(spec), ("shape",)) from error


def _located(
    where: str, call: Callable[Arguments, Result], *arguments: Arguments.args, **named: Arguments.kwargs
) -> Result:
    """The result of a call, whose errors get a place."""
    try:
        return call(*arguments, **named)
    except UserError as error:
        raise UserError(error.what, error.where or where, error.do) from None


def _edge(draft: Draft, name: str, spec: LineSpec | ArcSpec | SplineSpec | PolylineSpec) -> DraftEdge:
    kind = spec.kind
    start, end = getattr(spec, kind)
    where = f"shape.edges.{name}"
    for vertex in (start, end):
        if vertex not in draft.vertices:
            raise UserError(f"there is no vertex {vertex!r}", where, f"vertices: {', '.join(draft.vertices)}")
    a, b = np.array(draft.vertices[start]), np.array(draft.vertices[end])
    if np.array_equal(a, b):
        what = f"the edge has zero length: {start!r} and {end!r} are the same point"
        raise UserError(what, where, "move one of them, or leave the edge out")
    if isinstance(spec, LineSpec):
        return DraftEdge(name, kind, start, end, spec.part_of or "")
    if isinstance(spec, ArcSpec):
        return DraftEdge(name, kind, start, end, spec.part_of or "", bulge=_bulge(where, a, b, spec))
    inner = tuple((float(x), float(y)) for x, y in spec.through)
    chain = np.array([a, *inner, b])
    if not np.hypot(*np.diff(chain, axis=0).T).all():
        raise UserError("two points that follow each other are the same", where, "remove one of them")
    edge = DraftEdge(name, kind, start, end, spec.part_of or "", inner)
    if isinstance(spec, PolylineSpec):
        return edge
    knots = () if spec.knots is None else (0.0, *spec.knots, 1.0)
    return replace(edge, knots=knots, ends=spec.ends)


def _bulge(where: str, a: Reals, b: Reals, spec: ArcSpec) -> float:
    if spec.bulge is not None:
        return float(spec.bulge)
    try:
        return bulge_through(a, np.array(spec.through), b)
    except ValueError:
        raise UserError(
            "no arc passes through its ends and `through`", where, "take a point between the ends"
        ) from None


def _add(draft: Draft, name: str, kind: str, loop: CircleLoop | EdgeLoop | PolygonLoop) -> None:
    if isinstance(loop, CircleLoop):
        add_circle(draft, name, kind, loop.circle.center, loop.circle.radius)
    elif isinstance(loop, PolygonLoop):
        add_polygon(draft, name, kind, loop.polygon)
    else:
        add_loop(draft, name, kind, list(loop.loop))


def _refuse_unused(draft: Draft) -> None:
    used = {edge for _, _, chain in draft.loops for edge, _ in chain}
    for name in draft.edges:
        if name not in used:
            raise UserError("the edge belongs to no loop", f"shape.edges.{name}", "add it to a loop or remove it")
    ends = {v for edge in draft.edges.values() for v in (edge.start, edge.end)}
    for name in draft.vertices:
        if name not in ends:
            raise UserError(
                "the vertex belongs to no edge", f"shape.vertices.{name}", "move it to [shape.points] or remove it"
            )


def _check_groups(outline: Outline) -> None:
    for name, parts in outline.groups.items():
        for part in parts:
            if part in outline.groups:
                raise UserError(f"a group cannot hold the group {part!r}", f"shape.groups.{name}", "list its entities")
            _located(f"shape.groups.{name}", outline.entity, part)
