"""Materials that scenes may name, from `materials.toml` beside this module."""

import tomllib
from importlib.resources import files
from typing import Any

MATERIALS: dict[str, dict[str, Any]] = tomllib.loads((files(__package__) / "materials.toml").read_text("utf-8"))
"""Keys of a material by its name, as a scene would hold them, and the source of their values."""

NAMES = tuple(MATERIALS)


def named(raw: Any) -> Any:
    """The tables of a material with the values of the material that they name; values of their own come first."""
    if not isinstance(raw, dict) or raw.get("name") not in MATERIALS:
        return raw
    known = {key: value for key, value in MATERIALS[raw["name"]].items() if key != "source"}
    ours, theirs = raw.get("orthotropic"), known.get("orthotropic")
    if isinstance(ours, dict) and isinstance(theirs, dict):
        return known | raw | {"orthotropic": theirs | ours}
    return known | raw
