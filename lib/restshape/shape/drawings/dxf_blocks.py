"""The entities of a DXF drawing with its blocks put in place."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from ezdxf.upright import upright

from restshape.bounds import NESTING, OUTLINE_PIECES
from restshape.errors import UserError

BY_BLOCK = "0"
"""The layer whose entities take that of the INSERT that puts them in place."""


def placed(space: Iterable[Any], blocks: Any, where: str) -> Iterator[tuple[Any, str]]:
    """Entities with their layers: those of model space, and those of blocks moved, turned and scaled to their places.

    Args:
        space: entities of model space.
        blocks: of the drawing.
        where: the file, for messages.

    Raises:
        UserError: blocks within each other deeper than `bounds.NESTING`, or more entities than `bounds.OUTLINE_PIECES`.
    """
    entities = list(space)
    count = _Count(blocks, where)
    total = sum(count.of(entity, 0) for entity in entities)
    if total > OUTLINE_PIECES:
        what = f"the drawing has {total:.6g} entities with those of its blocks, more than {OUTLINE_PIECES}"
        raise UserError(what, where, "draw less, or read a drawing of the part alone")
    for entity in entities:
        yield from _expanded(entity, entity.dxf.layer)


def _expanded(entity: Any, layer: str) -> Iterator[tuple[Any, str]]:
    if entity.dxftype() != "INSERT":
        upright(entity)
        yield entity, layer
        return
    for one in entity.multi_insert() if entity.mcount > 1 else (entity,):
        for part in one.virtual_entities():
            yield from _expanded(part, layer if part.dxf.layer == BY_BLOCK else part.dxf.layer)


class _Count:
    """How many entities there will be, counted before any block is put in place.

    Args:
        blocks: of the drawing.
        where: the file, for messages.
    """

    def __init__(self, blocks: Mapping[str, Any], where: str) -> None:
        self.blocks, self.where = blocks, where
        self.known: dict[str, int] = {}

    def of(self, entity: Any, depth: int) -> int:
        """Entities that one stands for."""
        if entity.dxftype() != "INSERT":
            return 1
        name = str(entity.dxf.name)
        if depth > NESTING:
            what = f"blocks within each other are deeper than {NESTING}, at {name!r}"
            raise UserError(what, self.where, "explode the block; no block may hold itself")
        if name not in self.blocks:
            return 0
        if name not in self.known:
            self.known[name] = sum(self.of(part, depth + 1) for part in self.blocks[name])
        return max(int(entity.mcount), 1) * self.known[name]
