"""Materials that scenes may name: one library with sources, of which each physics knows those it has values of."""

import tomllib
from collections.abc import Collection, Mapping
from importlib.resources import files

LIBRARY: dict[str, dict[str, object]] = tomllib.loads((files(__package__) / "materials.toml").read_text("utf-8"))
"""Keys of a material by its name, as a scene would hold them, and the source of their values."""
FABRIC = "bending"
"""The key that fabrics have and no other material: their numbers are by area, and thickness stands for it."""


def library(*keys: str) -> dict[str, dict[str, object]]:
    """The materials of the library that have one of these keys; fabrics only where their own is among them."""
    return {
        name: values
        for name, values in LIBRARY.items()
        if not values.keys().isdisjoint(keys) and (FABRIC in keys or FABRIC not in values)
    }


def named(raw: object, known: Mapping[str, Mapping[str, object]], keys: Collection[str]) -> object:
    """The tables of a material with the values of the material that they name; values of their own come first.

    Args:
        raw: what a scene holds.
        known: values by name.
        keys: that the material may have: other values are left out.
    """
    if not isinstance(raw, dict):
        return raw
    name = raw.get("name")
    if not isinstance(name, str) or name not in known:
        return raw
    values = {key: value for key, value in known[name].items() if key in keys}
    inner = {
        key: value | raw[key]
        for key, value in values.items()
        if isinstance(value, dict) and isinstance(raw.get(key), dict)
    }
    return values | raw | inner


def sources(names: Mapping[str, str | None]) -> list[tuple[str, str, str]]:
    """Materials of a scene that take values by a name, with that name and the source of the values.

    Args:
        names: the names that they take values by, None of those that take none.
    """
    return [(own, name, str(LIBRARY[name]["source"])) for own, name in names.items() if name is not None]
