"""Darts that a hand draws: what the scene says of them then."""

# More than 15 modules: a place that is drawn becomes one of a panel, a fold and an edge, each of a module of its own.

from __future__ import annotations

import numpy as np

from restshape.arrays import Reals
from restshape.errors import UserError
from restshape.scene.dart_event import DrawnDart
from restshape.scene.dart_keys import IMAGE
from restshape.scene.darts import darts_of
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.scene.panels import frames_of
from restshape.scene.pattern_packing import turned
from restshape.scene.plain_values import Table, table_in
from restshape.shape.chain_crossings import crossings
from restshape.shape.outline import CHORD_ERROR, Entity, Outline
from restshape.shape.panels.dart_mouth import normal_at, share_at
from restshape.shape.panels.fold_line import fold_of
from restshape.shape.pieces import PieceFinder
from restshape.shape.topology_edits import nearest

NEAR = 0.02
"""Distance from an edge, over the length of the line that is drawn, up to which an end of that is on the edge."""


def with_drawn_dart(scene: Scene, outline: Outline, event: DrawnDart) -> Scene:
    """The scene with a dart that is drawn on its shape.

    Raises:
        UserError: its name is taken, or it has no place there.
    """
    if event.name in darts_of(scene):
        raise UserError(f"there is a dart {event.name!r} already", do="choose another name, or set its keys")
    table = event.keys
    if event.start is not None and event.to is not None:
        table |= _by_line(scene, outline, np.array(event.start), np.array(event.to))
    return revise(scene, "darts", {**table_in(scene.raw, "darts"), event.name: table})


def without_dart(scene: Scene, name: str) -> Scene:
    """The scene without a dart."""
    return revise(scene, "darts", {key: one for key, one in table_in(scene.raw, "darts").items() if key != name})


def _by_line(scene: Scene, outline: Outline, start: Reals, end: Reals) -> Table:
    """What a table says of the place of a dart with this line [m]: at an edge that it meets, or inside a panel.

    Raises:
        UserError: it meets several edges.
    """
    met = _met(outline, start, end) or _near(outline, start, end)
    legs = {leg: dart for dart in scene.shape.darts for side in dart.legs for leg in side}
    if other := next((legs[outline.edges[e].name] for e, _ in met if outline.edges[e].name in legs), None):
        raise UserError(f"the dart's line meets the dart {other.key!r}", do="draw it beside that, or move that one")
    if len(met) > 1:
        names = " and ".join(repr(outline.edges[e].parent) for e, _ in met)
        raise UserError(f"the dart's line meets {names}", do="draw it from one edge into the panel, or inside")
    if met:
        return _at_edge(scene, outline, met[0], start, end)
    piece = PieceFinder(outline).of_point(0.5 * (start + end))
    panel = outline.piece_names[piece]
    frame = frames_of(scene).get(panel)
    if frame is None:
        return {"line": [start.tolist(), end.tolist()]}
    fold = fold_of(scene, outline, panel)
    ends = [start, end] if fold is None else fold.of_half(start, end, NEAR)
    return {"panel": panel, "line": [list(turned((x - frame.x, y - frame.y), -frame.angle)) for x, y in ends]}


def _met(outline: Outline, start: Reals, end: Reals) -> list[tuple[int, Reals]]:
    """Edges of outlines and holes that a line crosses, each with the place (2,) [m]."""
    found: list[tuple[int, Reals]] = []
    same = NEAR * float(np.hypot(*(end - start)))
    for e in _bounding(outline):
        chain = outline.polyline(e, CHORD_ERROR * outline.size)
        found += [(e, np.array(place)) for place in crossings(start, end, chain)]

    def corner(e: int, place: Reals, other: int) -> bool:
        """Whether a place is at a vertex of both edges, where one of them is meant."""
        shared = set(outline.layout.ends[e].tolist()) & set(outline.layout.ends[other].tolist())
        return any(np.hypot(*(outline.points[v] - place)) <= same for v in shared)

    return [
        (e, place)
        for k, (e, place) in enumerate(found)
        if not any(corner(e, place, other) and np.hypot(*(place - at)) <= same for other, at in found[:k])
    ]


def _near(outline: Outline, start: Reals, end: Reals) -> list[tuple[int, Reals]]:
    """The edge that one end of a line is so near to that it is meant, with the place (2,) [m]."""
    found = []
    for place in (start, end):
        edge, s = nearest(outline, Entity(edges=tuple(_bounding(outline))), place)
        on = outline.point(edge, s)[0]
        if np.hypot(*(on - place)) <= NEAR * np.hypot(*(end - start)):
            found.append((edge, on))
    return found


def _bounding(outline: Outline) -> list[int]:
    """Edges of outlines and holes."""
    return sorted({e for loop in outline.loops if loop.kind != "region" for e, _ in loop.edges})


def _at_edge(scene: Scene, outline: Outline, met: tuple[int, Reals], start: Reals, end: Reals) -> Table:
    """What a table says of a dart from an edge to that end of the line that lies inside."""
    parent = outline.edges[met[0]].parent
    entity = outline.entity(parent)
    edge, s = nearest(outline, entity, met[1])
    place, inward, _ = normal_at(outline, edge, s)
    way = max((start - place, end - place), key=lambda one: float(one @ inward))
    length, share = float(np.hypot(*way)), share_at(outline, entity, edge, s)
    angle = float(np.arctan2(inward[0] * way[1] - inward[1] * way[0], inward @ way))
    panel = outline.piece_names[int(outline.layout.edge_piece[edge])]
    fold = fold_of(scene, outline, panel)
    if fold is not None and np.hypot(*(fold.ends - place).T).min() <= NEAR * length:
        # At the end of the fold it goes along that.
        share, angle = float(round(share)), 0.0
    if parent.startswith(f"{panel}.{IMAGE}."):
        parent, angle = f"{panel}.{parent.removeprefix(f'{panel}.{IMAGE}.')}", -angle
    return {"edge": parent, "at": share, "length": length} | ({"angle": angle} if angle else {})
