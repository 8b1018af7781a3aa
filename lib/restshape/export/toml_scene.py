"""A scene as TOML."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

import tomlkit
from tomlkit.items import InlineTable, Item

from restshape.errors import UserError
from restshape.export.edited_frame import EditedFrame, plain_scene
from restshape.export.kept_formulas import with_formulas
from restshape.export.panel_tables import panel_tables
from restshape.export.shape_tables import shape_tables
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.scene.given_numbers import given_numbers
from restshape.scene.load import remade
from restshape.scene.model import Scene, ShapeSpec
from restshape.scene.panels import frames_of, panels_of
from restshape.scene.plain_values import Table, table_in
from restshape.shape.build import outline_of

DEPTHS = {"shape": 1, "panels": 2}
"""Depths of tables within one that have headers of their own."""


def write_toml(frame: EditedFrame, path: Path) -> list[str]:
    """Writes the scene of a frame, its shape as it was edited, from which edits go on; what there is to note.

    Numbers that formulas of parameters still give stay these formulas, but in panels that are cut on the fold or have
    darts: their other half and the parts of darts have no formulas, so that all of them are numbers.

    Raises:
        UserError: a name of the shape, such as one that a mesh file gave, cannot stand in a scene.
        OSError: it cannot be written.
    """
    notes = []
    if frames_of(frame.scene):
        panels, numbers = panel_tables(frame.outline, frame.scene), _in_numbers(frame.scene)
        for name in panels.keys() - numbers:
            panels[name] = with_formulas(table_in(panels, name), frame.scene, frame.outline, name)
        shape: Table = {"panels": panels}
        notes = _numbers_noted(frame.scene, numbers)
    else:
        shape = {"shape": with_formulas(shape_tables(frame.outline), frame.scene, frame.outline)}
    tables = plain_scene(frame, shape)
    again = remade(frame.scene, tables)
    write_whole(path, f"# {EXPORT_MARK}\n{toml_text(tables)}")
    try:
        outline_of(again)
    except UserError as error:
        # What may be close is a share of the size that a shape begins with, and edits may have made it larger.
        near = any(words in error.what for words in ("closer than", "shorter than"))
        why = ", for distances are measured by its size now" if near else ""
        do = f"; {error.do}" if error.do and not near else ""
        notes.append(f"a scene of this shape is refused{why}: {error.what}{do}")
    return notes


def _in_numbers(scene: Scene) -> set[str]:
    """The panels that are written in numbers: those cut on the fold, and those with darts."""
    folded = {name for name, panel in panels_of(scene).items() if panel.mirror is not None}
    parts = {part for dart in scene.shape.darts for part in dart.kinds()}
    return folded | {name for name in panels_of(scene) if any(part.startswith(f"{name}.") for part in parts)}


def _numbers_noted(scene: Scene, panels: Collection[str]) -> list[str]:
    """Notes of formulas of such panels, and of darts, which are numbers from now on."""
    keys = [one.key for one in given_numbers(scene) if one.key[0] == "panels"]
    lost = [name for name in dict.fromkeys(key[1] for key in keys if key[2] in ShapeSpec.named) if name in panels]
    notes = [
        f"in numbers, for it is cut on the fold or has darts, so that parameters no longer give its shape: panel {name}"
        for name in lost
    ]
    darts = list(dict.fromkeys(dart.where for dart in scene.shape.darts))
    return [*notes, *([f"part of the shape from now on, with seams: {', '.join(darts)}"] if darts else [])]


def toml_text(tables: Table) -> str:
    """Plain tables as TOML: a header a table, those of shape and panels one a kind, all within in one line each."""
    document = tomlkit.document()
    for key, value in tables.items():
        if not isinstance(value, dict):
            document.add(key, tomlkit.item(value))
    for key, value in tables.items():
        if isinstance(value, dict):
            document.add(key, _table(value, DEPTHS.get(key, 0)))
    return tomlkit.dumps(document)


def _table(values: Table, depth: int) -> Item:
    """A table with a header, and so many depths of tables with headers of their own in it."""
    table = tomlkit.table()
    inner = {key: value for key, value in values.items() if depth and isinstance(value, dict)}
    for key, value in values.items():
        if key not in inner:
            table.add(key, _inline(value))
    for key, value in inner.items():
        table.add(key, _table(value, depth - 1))
    return table


def _inline(value: object) -> Item:
    """A value in one line."""
    if not isinstance(value, dict):
        return tomlkit.item(value)
    table: InlineTable = tomlkit.inline_table()
    for key, inner in value.items():
        table.add(key, _inline(inner))
    return table
