"""Elastic materials that scenes may name, from `elastic_materials.toml` beside this module."""

import tomllib
from importlib.resources import files

ELASTIC_MATERIALS: dict[str, dict[str, object]] = tomllib.loads(
    (files(__package__) / "elastic_materials.toml").read_text("utf-8")
)
"""Keys of a material by its name, as a scene would hold them, and the source of their values."""
