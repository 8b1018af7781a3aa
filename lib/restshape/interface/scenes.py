"""Scenes for programs: read, made of tables, changed, and written."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import cast

from restshape.errors import UserError
from restshape.interface.plain import plain
from restshape.interface.saved import save_text
from restshape.interface.scripts import refuse_names
from restshape.scene.load import load_scene, revise, scene_of_tables
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table
from restshape.scene.units import article


def load(path: str | Path, *overrides: str) -> Scene:
    """The scene of a TOML file, validated.

    Args:
        path: the file.
        overrides: ``"material.steel.E='70 GPa'"`` and the like, as after ``--set``.

    Raises:
        UserError: naming file, key and line of what is wrong, and what to do.
    """
    for override in overrides:
        if not isinstance(override, str):
            what = f"an override is a text, not {article(type(override).__name__)}"
            raise UserError(what, do="""write load("scene.toml", "mesh.size='1 cm'", ...), or a star before a list""")
    return load_scene(path, overrides)


def new_scene(tables: Mapping[str, object], path: str | Path = "scene.toml") -> Scene:
    """The scene of plain tables, validated as those of a file are.

    Args:
        tables: as TOML would give them; they are copied. NumPy arrays count as lists.
        path: where such a file would be: its name is for messages, and files that the scene names are beside it.

    Raises:
        UserError: naming the key of what is wrong, and what to do.
    """
    return scene_of_tables(cast("Table", plain(tables)), Path(path))


def changed(scene: Scene, key: str, value: object) -> Scene:
    """A scene with one key changed, validated again; the one given stays as it is.

    Args:
        scene: any.
        key: dotted, such as ``material.steel.E``.
        value: as it would stand in the file.

    Raises:
        UserError: there is no such key, or the value does not suit it.
    """
    refuse_names(scene, "load")
    return revise(scene, key, plain(value, key))


def save_scene(scene: Scene, path: str | Path, force: bool = False) -> None:
    """Writes a scene as TOML that `load` reads; comments of a file that it was read from are not in it.

    Args:
        scene: any; path: of the file; force: replace a file that is there.

    Raises:
        UserError: there is a file already, or it cannot be written.
    """
    from restshape.export.toml_scene import toml_text

    refuse_names(scene, "load")
    save_text(Path(path), toml_text(scene.raw), force)
