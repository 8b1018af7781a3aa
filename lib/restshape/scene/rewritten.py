"""A scene's file with other values: comments and all other keys stay as they are."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

import tomlkit
from tomlkit.exceptions import TOMLKitError

from restshape.errors import UserError
from restshape.scene.plain_values import Key, named_files, tables_in


def rewritten(scene: Path, changes: Iterable[tuple[Key, object]], target: Path) -> str:
    """The text of a scene with other values, which names files as they lie beside another place.

    Args:
        scene: its file.
        changes: dotted keys with plain values; tables on the way to a key are made.
        target: where the text is to be written.

    Raises:
        UserError: the file cannot be read in a way that keeps its comments.
    """
    try:
        document = tomlkit.parse(scene.read_text(encoding="utf-8-sig"))
    except TOMLKitError as error:
        raise UserError(f"the scene cannot be rewritten: {error}", str(scene), "write it more plainly") from error
    for key, value in changes:
        put(document, key, value)
    for key, name in [*named_files(document), *_meshes_of_bodies(document)]:
        if not Path(name).is_absolute():
            put(document, key, os.path.relpath(scene.parent / name, target.parent))
    text = tomlkit.dumps(document)
    tomllib.loads(text)
    return text


def _meshes_of_bodies(document: Any) -> list[tuple[Key, str]]:
    """The files of bodies, by key."""
    bodies: dict[str, Any] = tables_in(document, "bodies")
    meshes = {name: body["mesh"] for name, body in bodies.items() if "mesh" in body}
    return [(("bodies", name, "mesh", "file"), str(mesh["file"])) for name, mesh in meshes.items() if "file" in mesh]


def put(document: Any, key: Key, value: Any) -> None:
    """Set one dotted key, making the tables on the way to it."""
    here = document
    for part in key[:-1]:
        if isinstance(here, list):
            here = here[int(part)]
            continue
        if part not in here:
            here[part] = tomlkit.table()
        here = here[part]
    last = int(key[-1]) if isinstance(here, list) else key[-1]
    if not isinstance(here, list) and last in here and here[last] == value:
        return
    here[last] = value
