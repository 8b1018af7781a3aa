"""Names of entities that settings of effects hold."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from restshape.scene.model import Scene


def effect_places(scene: Scene) -> Iterator[tuple[tuple[str, ...], Sequence[str]]]:
    """Keys of ``[effects]`` and the entities that they name: those called `at` in a table of an effect's."""
    for name, keys in scene.effects.items():
        for key, table in keys.items():
            if isinstance(table, dict) and isinstance(table.get("at"), list | tuple):
                yield ("effects", name, key, "at"), table["at"]
