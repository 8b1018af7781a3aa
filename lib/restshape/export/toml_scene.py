"""A scene as TOML."""

from __future__ import annotations

from pathlib import Path

import tomlkit
from tomlkit.items import InlineTable, Item

from restshape.export.edited_frame import EditedFrame, plain_scene
from restshape.export.kept_formulas import with_formulas
from restshape.export.panel_tables import panel_tables
from restshape.export.shape_tables import shape_tables
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.scene.load import remade
from restshape.scene.panels import frames_of
from restshape.scene.plain_values import Table

DEPTHS = {"shape": 1, "panels": 2}
"""Depths of tables within one that have headers of their own."""


def write_toml(frame: EditedFrame, path: Path) -> None:
    """Writes the scene of a frame, its shape as it was edited, from which edits go on.

    Numbers of the shape that formulas of parameters still give stay these formulas; those of panels are numbers.

    Raises:
        UserError: a name of the shape, such as one that a mesh file gave, cannot stand in a scene.
        OSError: it cannot be written.
    """
    if frames_of(frame.scene):
        shape: Table = {"panels": panel_tables(frame.outline, frame.scene)}
    else:
        shape = {"shape": with_formulas(shape_tables(frame.outline), frame.scene, frame.outline)}
    tables = plain_scene(frame, shape)
    remade(frame.scene, tables)
    write_whole(path, f"# {EXPORT_MARK}\n{toml_text(tables)}")


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
