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


def parts_of_edits(scene: Scene, outline: Outline) -> dict[str, str]:
    """Names that the shape has and the scene does not give, since edits have made them, with what they are."""
    kinds = {name: kind for kind in ("vertex", "edge", "hole", "region") for name in outline.names(kind)}
    given = scene.shape.kinds()
    return {name: kind for name, kind in kinds.items() if name not in given}


def _ends(outline: Outline, parent: str | None = None) -> dict[str, set[str]]:
    """The names of the vertices at both ends of each edge, or of each that was cut from one edge."""
    names = outline.vertex_names
    return {e.name: {names[e.start], names[e.end]} for e in outline.edges if parent in (None, e.parent)}


def _kept(name: str, former: Outline, outline: Outline) -> bool:
    """Whether other parts of the edge that an edge was cut from stand where it was, as it was cut, or has joined one.

    What it was cut into has new names, and meets its ends. What it has joined met it at a vertex that is gone.
    """
    parent = next((edge.parent for edge in former.edges if edge.name == name), None)
    if parent is None:
        return False
    before, now = _ends(former, parent), _ends(outline, parent)
    left = before[name] & set(outline.vertex_names)
    deleted = before[name] - left
    if not deleted:
        return left <= set().union(*(ends for other, ends in now.items() if other not in before))
    beside = [other for other, ends in before.items() if other != name and deleted & ends]
    return len(deleted) == 1 and any(left <= now.get(other, set()) for other in beside)


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
            # What a key names itself has to have its name.
            if former is not None and part != name and _kept(part, former, outline):
                continue
            lost.setdefault(part, []).append(key)
    if lost:
        part, keys = next(iter(lost.items()))
        by = ", ".join(dict.fromkeys(keys))
        if former is None:
            raise outline.unknown(part, where=by)
        raise UserError(f"{part} is needed by {by}", do=_without(list(dict.fromkeys(keys))))


def _without(keys: list[str]) -> str:
    """What to do so that keys of a scene need a part of its shape no more: an edit can set some, others it cannot."""
    free = [f"{key}.on" for key in keys if key.startswith(("supports.", "loads."))]
    fixed = [key for key in keys if not key.startswith(("supports.", "loads."))]
    ways = [f"set {', '.join(free)} to another place first"] if free else []
    return ", and ".join([*ways, f"name another place in {', '.join(fixed)} of the scene"] if fixed else ways)
