"""Materials that scenes may name: their values come from what the physics of a scene know."""

from collections.abc import Collection, Mapping


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
