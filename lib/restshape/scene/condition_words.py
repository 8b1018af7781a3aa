"""Supports and loads in words."""

from collections.abc import Mapping

from pydantic import BaseModel

from restshape.scene.descriptions import keys_in_words, listing, with_symbol
from restshape.scene.model import Load, Support


def support_words(support: Support, parameters: Mapping[str, float] | None = None) -> str:
    """What a support prescribes; with parameters of the scene, formulas of them have their values."""
    of = support.boundary
    parts = [
        f"{key} = {listing(v) if v == 0 else with_symbol(v, of[key], parameters)}" for key, v in support.fix.items()
    ]
    others = {key: getattr(support, key) for key in type(support).model_fields if key not in ("on", "fix")}
    parts += [f"{key} {listing(value)}" for key, value in others.items() if value is not None]
    return " and ".join(parts)


def load_words(load: Load, parameters: Mapping[str, float] | None = None) -> str:
    """Kind and value of a load with its unit; with parameters of the scene, formulas of them have their values."""
    value, meaning = getattr(load, load.kind), load.kinds[load.kind].meaning
    of_keys = isinstance(value, BaseModel)
    words = keys_in_words(value, (), parameters) if of_keys else with_symbol(value, meaning, parameters)
    return f"{load.kind} {words}"
