"""Names of the shape that the rest of a scene relies on."""

from __future__ import annotations

from collections.abc import Iterator

from restshape.errors import UserError
from restshape.scene.effect_places import effect_places
from restshape.scene.load import revise
from restshape.scene.model import Scene
from restshape.shape.outline import Outline


def uses(scene: Scene) -> Iterator[tuple[str, str]]:
    """Pairs (key of the scene, entity that it cannot do without)."""
    for table in ("supports", "loads"):
        for name, entry in getattr(scene, table).items():
            yield from ((f"{table}.{name}", entity) for entity in entry.on)
    for name, quantity in scene.quantities.items():
        if quantity.at is not None:
            yield f"quantities.{name}", quantity.at
    for key, entities in effect_places(scene):
        yield from ((".".join(key), entity) for entity in entities)
    for name, material in scene.material.items():
        yield from ((f"material.{name}", region) for region in material.region or ())


def without_lost_sizes(scene: Scene, outline: Outline, former: Outline) -> Scene:
    """The scene without the mesh sizes at what is in the shape no more: a hint is no reason to keep it."""
    there = {*outline.layout.entities, *outline.groups}
    kept = {name: size for name, size in scene.mesh.near.items() if not members(former, name) - there}
    return scene if len(kept) == len(scene.mesh.near) else revise(scene, "mesh.near", kept)


def members(outline: Outline, name: str) -> set[str]:
    """The name itself and, for a group, the names in it."""
    return {name, *outline.groups.get(name, ())}


def refuse_lost_names(scene: Scene, outline: Outline, former: Outline | None = None) -> None:
    """Makes sure that all names that a scene relies on are there.

    Args:
        scene: that names entities.
        outline: the shape as it would be.
        former: the shape before; members of a named group count too.

    Raises:
        UserError: naming what is missing, and which keys of the scene rely on it.
    """
    there = {*outline.layout.entities, *outline.groups}
    lost: dict[str, list[str]] = {}
    # A cut takes the mesh sizes at what it removes away with it.
    sizes = [("mesh.near", name) for name in scene.mesh.near] if former is None else []
    for key, name in [*uses(scene), *sizes]:
        for part in members(former or outline, name) - there:
            lost.setdefault(part, []).append(key)
    if lost:
        part, keys = next(iter(lost.items()))
        verb = "is needed" if former is not None else "is not in the shape, but named"
        raise UserError(f"{part} {verb} by {', '.join(dict.fromkeys(keys))}")
