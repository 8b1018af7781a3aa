"""Formulas of a scene's shape that still give what edits have made of it, in place of its numbers."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from restshape.export.shape_tables import ROUNDING
from restshape.scene.given_numbers import Key, given_numbers
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table, table_in, tables_in
from restshape.shape.build import unchecked_outline
from restshape.shape.outline import Outline

PLACES = np.array([0.0, 0.5, 1.0])
"""Parameters of points by which an arc is known."""


def with_formulas(shape: Table, scene: Scene, outline: Outline, panel: str = "") -> Table:
    """The tables of an outline, with the scene's own formulas where they give its numbers, to rounding error.

    Args:
        shape: plain tables, as `shape_tables` gives them, or `panel_tables` of a panel.
        scene: whose formulas they are.
        outline: as edits have left it.
        panel: name of the panel; "": the tables are of the whole shape.
    """
    of = ("panels", panel) if panel else ("shape",)
    numbers = [one for one in given_numbers(scene) if one.key[: len(of)] == of]
    given = {one.key[len(of) :]: (one.formula.text, one.value) for one in numbers}
    if not given:
        return shape
    found = {key: _replaced(value, (key,), given, outline.size) for key, value in shape.items()}
    edges, written = table_in(found, "edges"), tables_in(_below(scene.raw, of), "edges")
    first = unchecked_outline(scene.shape, scene.folder)
    for name in edges:
        # The bulge of such an arc is in no formula.
        through = "arc" in written.get(name, {}) and any(key[:3] == ("edges", name, "through") for key in given)
        if through and _same_arc(f"{panel}.{name}" if panel else name, outline, first):
            edges[name] = written[name]
    return found


def _below(raw: Mapping[str, object], keys: Key) -> Table:
    """The table at a key of tables."""
    found = dict(raw)
    for key in keys:
        found = table_in(found, key)
    return found


def _replaced(value: object, key: Key, given: Mapping[Key, tuple[str, float]], size: float) -> object:
    """Plain values in whose place formulas stand that give the same numbers."""
    if isinstance(value, dict):
        return {name: _replaced(one, (*key, name), given, size) for name, one in value.items()}
    if isinstance(value, list):
        return [_replaced(one, (*key, str(place)), given, size) for place, one in enumerate(value)]
    if key in given and isinstance(value, float) and abs(given[key][1] - value) <= ROUNDING * size:
        return given[key][0]
    return value


def _same_arc(name: str, outline: Outline, first: Outline) -> bool:
    """Whether two outlines have the same arc under a name."""
    (place,), (old,) = (one.entity(name).edges for one in (outline, first))
    apart = np.abs(outline.point(place, PLACES) - first.point(old, PLACES)).max()
    return bool(outline.edges[place].kind == "arc" and apart <= ROUNDING * outline.size)
