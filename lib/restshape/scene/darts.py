"""Darts: ``[darts.NAME]``, what is cut out of the cloth, or folded away, so that it takes a form in space."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from restshape.errors import UserError
from restshape.scene.dart_keys import END, IMAGE, Dart, Pair, PlacedDart
from restshape.scene.edge_names import edge_suggestion
from restshape.scene.panels import frames_of, panels_of
from restshape.scene.plain_values import Table, table_in
from restshape.scene.seam_keys import Seam, placed_pleats
from restshape.scene.unfolding import reflection

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from restshape.scene.model import Scene

ON_FOLD = 1e-6
"""Distance of a point from a fold, over the length of that, up to which it lies on it."""


def darts_of(scene: Scene) -> Mapping[str, Dart]:
    """The darts of a scene by name; none where no physics of it has registered a table of them."""
    key = scene.tables.get(Dart)
    return getattr(scene, key) if key else {}


def with_darts(scene: Scene) -> Scene:
    """The scene whose shape has its darts and pleats, and whose seams are those of the darts, too.

    Raises:
        UserError: a dart has no place in the shape, a seam has its name, or a pleat has no edge.
    """
    darts = darts_of(scene)
    seams = getattr(scene, scene.tables[Seam]) if Seam in scene.tables else {}
    pleats = placed_pleats(seams, panels_of(scene))
    if pleats:
        scene = scene.model_copy(update={"shape": scene.shape.with_pleats(pleats)})
    if not darts:
        return scene
    placed = [one for name, dart in darts.items() for one in _placed(scene, name, dart)]
    key = scene.tables[Seam]
    seams = dict(getattr(scene, key))
    kinds = scene.shape.kinds()
    for one in placed:
        name = one.seam_name
        if name in seams:
            raise UserError(f"the seam {name!r} has the name of a dart, which is a seam itself", one.where, "rename it")
        if taken := next((part for part in one.kinds() if part in kinds), None):
            raise UserError(f"the name {taken!r}, a part of the dart, is in use already", one.where, "rename the dart")
        seams[name] = one.seam
        kinds |= one.kinds()
    return scene.model_copy(update={"shape": scene.shape.with_darts(tuple(placed)), key: seams})


def _placed(scene: Scene, name: str, dart: Dart) -> Iterator[PlacedDart]:
    """A dart in the pattern plane, and its mirror image where its panel is cut on the fold beside it."""
    panel, edge = _panel_and_edge(scene, name, dart)
    frame = frames_of(scene).get(panel)
    line = dart.line if frame is None or dart.line is None else (frame.place(dart.line[0]), frame.place(dart.line[1]))
    before = f"{panel}." if panel else ""
    at = None if dart.line is not None else 0.5 if dart.at is None else dart.at
    placed = PlacedDart(f"{before}{name}", name, dart, edge, at, line, dart.angle)
    fold = panels_of(scene)[panel].mirror if panel else None
    if fold is None:
        yield placed
        return
    edge_of_fold = scene.shape.edges[f"{panel}.{fold}"]
    start, end = (scene.shape.vertices[one] for one in getattr(edge_of_fold, edge_of_fold.kind))
    if _on_fold(scene, placed, (start, end)):
        yield _on_its_fold(placed, f"{panel}.{fold}")
        return
    yield placed
    reflect = reflection(start, end)
    image = None if line is None else (reflect(line[0]), reflect(line[1]))
    other = None if edge is None else f"{panel}.{IMAGE}.{edge.removeprefix(before)}"
    yield PlacedDart(f"{before}{IMAGE}.{name}", name, dart, other, at, image, -dart.angle, image=True)


def _panel_and_edge(scene: Scene, name: str, dart: Dart) -> tuple[str, str | None]:
    """The panel that a dart is in, empty for a scene of one sheet, and its edge as the scene's shape names it.

    Raises:
        UserError: there is no such panel or edge.
    """
    where, panels, kinds = f"darts.{name}", panels_of(scene), scene.shape.kinds()
    edge, panel = dart.edge, dart.panel
    if panel is not None and panel not in panels:
        do = f"name one of {', '.join(panels)}" if panels else "leave it out: the scene has one sheet"
        raise UserError(f"there is no panel {panel!r}", f"{where}.panel", do)
    if edge is not None and panel is not None and f"{panel}.{edge}" in kinds:
        edge = f"{panel}.{edge}"
    if panels and panel is None:
        panel = edge.partition(".")[0] if edge is not None else next(iter(panels)) if len(panels) == 1 else None
        if panel is None:
            raise UserError("the dart does not say in which panel it lies", where, f"name one: {', '.join(panels)}")
    if edge is None or scene.shape.file is not None:
        return panel or "", edge
    if panel not in panels:
        panel = ""
    own = [one for one, kind in kinds.items() if kind == "edge" and one.startswith(f"{panel}." if panel else "")]
    if edge not in own:
        what = f"the dart is to open at {edge!r}, which is no edge" + (f" of the panel {panel!r}" if panel else "")
        raise UserError(what, f"{where}.edge", edge_suggestion(edge, own))
    if panel and edge == f"{panel}.{panels[panel].mirror}":
        what = f"the dart is to open at {edge!r}, about which the panel is unfolded: there the cloth goes on"
        raise UserError(what, f"{where}.edge", "leave the edge out, and give a line along the fold: a diamond")
    if panel and edge.startswith(f"{panel}.{IMAGE}."):
        what = f"{edge!r} is of the panel's other half, which has the mirror images of all darts"
        raise UserError(what, f"{where}.edge", f"name {panel}.{edge.removeprefix(f'{panel}.{IMAGE}.')}")
    return panel or "", edge


def _on_fold(scene: Scene, placed: PlacedDart, fold: tuple[Pair, Pair]) -> bool:
    """Whether a dart lies on the fold of its panel: with both points of its line, or where its edge meets the fold."""
    length = math.dist(*fold)

    def beside(point: Pair) -> bool:
        (x0, y0), (x1, y1) = fold
        away = (x1 - x0) * (point[1] - y0) - (y1 - y0) * (point[0] - x0)
        return abs(away) <= ON_FOLD * length * length

    if placed.line is not None:
        return all(map(beside, placed.line))
    if placed.edge is None or placed.at is None or END < placed.at < 1.0 - END:
        return False
    edge = scene.shape.edges[placed.edge]
    end = getattr(edge, edge.kind)[round(placed.at)]
    return beside(scene.shape.vertices[end])


def _on_its_fold(placed: PlacedDart, fold: str) -> PlacedDart:
    """A dart on the fold of its panel, along which it goes.

    Raises:
        UserError: it is folded, or turned away from the fold.
    """
    if placed.dart.folded:
        what = "the dart lies on the fold of its panel, and is to be folded"
        raise UserError(what, placed.where, "leave `folded` out, or write both halves of the panel")
    if placed.angle != 0.0:
        what = "the dart lies on the fold of its panel, and its angle would turn it to one side"
        raise UserError(what, f"{placed.where}.angle", "leave the angle out")
    return replace(placed, fold=fold)


def without_darts(scene: Scene) -> Table:
    """The plain tables of a scene without its darts, with their seams in their place."""
    raw = dict(scene.raw)
    if not darts_of(scene):
        return raw
    raw.pop("darts")
    made = {}
    for one in scene.shape.darts:
        left, right = one.legs
        made[one.seam_name] = {"from": left, "to": right, **one.seam.keys}
    return raw | {"seams": {**table_in(raw, "seams"), **made}}
