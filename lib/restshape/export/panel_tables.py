"""An outline of several pieces as the plain tables of ``[panels.NAME]``: each in coordinates of its own."""

from __future__ import annotations

from collections.abc import Mapping

from restshape.export.shape_tables import shape_tables
from restshape.scene.model import Scene, ShapeSpec
from restshape.scene.panels import frames_of
from restshape.scene.pattern_packing import PanelFrame, turned
from restshape.scene.plain_values import Table, table_in
from restshape.shape.outline import Outline

PLACES = ("through", "polygon", "circle", "center")
"""Keys of edges and loops that hold places, or a table with one."""


def panel_tables(outline: Outline, scene: Scene) -> Table:
    """The tables of all panels of a scene with the shape that edits have given them; those on the fold are opened.

    Args:
        outline: of all panels in the pattern plane; scene: of the same frame.
    """
    found: Table = {}
    for name, shape in panel_shapes(outline, scene).items():
        raw = table_in(table_in(scene.raw, "panels"), name)
        found[name] = shape | {
            key: value for key, value in raw.items() if key not in (*ShapeSpec.model_fields, "mirror")
        }
    return found


def panel_shapes(outline: Outline, scene: Scene) -> dict[str, Table]:
    """The plain tables of the shapes of all panels alone, by name; arguments as of `panel_tables`."""
    whole = shape_tables(outline)
    around = {loop.name: [outline.edges[e].name for e, _ in loop.edges] for loop in outline.loops}
    return {
        name: {"outline": [_part(edge, f"{name}.") for edge in around[name]], **_own(f"{name}.", whole, frame)}
        for name, frame in frames_of(scene).items()
    }


def _own(before: str, whole: Mapping[str, object], frame: PanelFrame) -> Table:
    """What one panel has of the tables of the whole shape."""
    found: Table = {}
    for key in ShapeSpec.named:
        places = key in ("vertices", "points")
        own = {
            _part(name, before): _moved(value, frame) if places else _inner(value, before, frame)
            for name, value in table_in(whole, key).items()
            if name.startswith(before)
        }
        if own:
            found[key] = own
    return found


def _inner(value: object, before: str, frame: PanelFrame) -> object:
    """What an edge, a loop or a group holds, in names and coordinates of the panel."""
    if isinstance(value, dict):
        return {
            key: _moved(inner, frame) if key in PLACES and isinstance(inner, list) else _inner(inner, before, frame)
            for key, inner in value.items()
        }
    if isinstance(value, list):
        return [_inner(one, before, frame) for one in value]
    return _part(value, before) if isinstance(value, str) else value


def _moved(value: object, frame: PanelFrame) -> object:
    """A place, or a list of them, in coordinates of the panel."""
    assert isinstance(value, list), "places are pairs"
    if value and isinstance(value[0], list):
        return [_moved(one, frame) for one in value]
    x, y = value
    return list(turned((x - frame.x, y - frame.y), -frame.angle))


def _part(name: str, before: str) -> str:
    return name.removeprefix(before)
