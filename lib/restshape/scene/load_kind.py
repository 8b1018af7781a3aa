"""Kinds of loads: what each says, and which parts of a shape it may act on."""

from collections.abc import Sequence
from dataclasses import dataclass

from restshape.scene.values import dimension_of

CURVES = ("edge", "hole", "region", "outline", "group")
"""Kinds of entities that have a length."""
POINTS = ("vertex", "point")
AREAS = ("region", "all", "group")
ENTITIES = {
    "vertex": "a vertex",
    "point": "a point",
    "edge": "an edge",
    "hole": "a hole",
    "region": "a region",
    "group": "a group",
    "outline": "the outline",
    "all": "the whole shape",
}
"""Kinds of entities in words."""


@dataclass(frozen=True)
class LoadKind:
    """A kind of loads: a key of ``[loads.NAME]``.

    Args:
        value: annotation of what the key may hold: a number, a list of numbers, a model of keys.
        on: kinds of entities that it may act on.
        summary: what it is, for people.
    """

    value: object
    on: tuple[str, ...]
    summary: str = ""

    @property
    def meaning(self) -> object:
        """What it is in all physics that have it."""
        return dimension_of(self.value)


def any_of(kinds: Sequence[str]) -> str:
    """Kinds of entities to choose from, such as ``an edge, a hole or the outline``."""
    *first, last = (ENTITIES[kind] for kind in kinds)
    return f"{', '.join(first)} or {last}" if first else last
