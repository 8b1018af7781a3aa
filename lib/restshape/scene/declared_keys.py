"""Keys that physics declare, by the table that they stand in: what is theirs, and what they mean."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cache

from pydantic import BaseModel

from restshape.scene.model import Load, Material, Scene, Support
from restshape.scene.physics import Physics
from restshape.scene.quantity import CORE, Quantity
from restshape.scene.values import Strict, annotation_of, dimension_of

Meanings = Mapping[str, object]
"""What each key of a table means: two of one meaning go together."""


@cache
def declared_keys(physics: Physics) -> dict[str, Meanings]:
    """The keys that a physics adds, by what they are: "table", "material key", "component", "load", "quantity"."""
    return {
        "table": {key: "shared" if section.shared else section for key, section in physics.sections.items()},
        **{
            f"key of [{key}]": _keys(section.model, Strict)
            for key, section in physics.sections.items()
            if section.shared
        },
        "key of materials": _keys(physics.material, Material),
        "key of supports": _keys(physics.support, Support),
        "direction": physics.boundary,
        "load of the kind": {key: kind.meaning for key, kind in physics.loads.items()},
        "quantity of the kind": {key: kind.meaning for key, kind in physics.quantities.items()},
        "value of the material": {
            f"{name}.{key}": value for name, values in physics.materials.items() for key, value in values.items()
        },
    }


def core_keys() -> dict[str, frozenset[str]]:
    """The keys that all scenes have, by what they are, as in `declared_keys`."""
    return {
        "table": frozenset(Scene.model_fields),
        "key of materials": frozenset(Material.model_fields),
        "key of supports": frozenset(Support.model_fields),
        "direction": frozenset(),
        "load of the kind": frozenset(Load.model_fields),
        "quantity of the kind": frozenset([*Quantity.model_fields, *CORE]),
        "value of the material": frozenset(),
    }


@cache
def known_keys(physics: tuple[Physics, ...]) -> dict[str, frozenset[str]]:
    """All keys of scenes of these physics, by what they are, as in `declared_keys`."""
    return {what: core.union(*(declared_keys(one)[what] for one in physics)) for what, core in core_keys().items()}


def names_of(physics: Iterable[Physics], what: str) -> list[str]:
    """The keys of one sort that several physics add, each once."""
    return list(dict.fromkeys(key for one in physics for key in declared_keys(one)[what]))


def written_keys(raw: Mapping[str, object]) -> Iterator[tuple[str, str, tuple[str, ...]]]:
    """Of plain tables of a scene all keys that may be those of physics: what they are, the key, and its place."""
    yield from (("table", key, (key,)) for key in raw)
    for table, what in (
        ("material", "key of materials"),
        ("supports", "key of supports"),
        ("loads", "load of the kind"),
        ("quantities", "quantity of the kind"),
    ):
        for name, keys in _tables(raw.get(table)):
            yield from ((what, key, (table, name, key)) for key in keys)
    for name, keys in _tables(raw.get("supports")):
        fix = keys.get("fix")
        if isinstance(fix, list | dict):
            yield from (("direction", key, ("supports", name, "fix")) for key in fix if isinstance(key, str))


def _tables(named: object) -> Iterator[tuple[str, Mapping[str, object]]]:
    """The tables of a table of names."""
    entries = named.items() if isinstance(named, dict) else ()
    yield from ((name, keys) for name, keys in entries if isinstance(keys, dict))


def _keys(model: type[BaseModel] | None, core: type[BaseModel]) -> Meanings:
    """The keys that a model adds to the core's, each with its dimension, or what else it may hold."""
    if model is None:
        return {}
    return {
        key: dimension_of(annotation_of(info))
        for key, info in model.model_fields.items()
        if key not in core.model_fields
    }
