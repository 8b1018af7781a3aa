"""Supports and loads in words."""

from pydantic import BaseModel

from restshape.scene.descriptions import keys_in_words, listing, with_symbol
from restshape.scene.model import Load, Support


def support_words(support: Support) -> str:
    """What a support prescribes."""
    of = support.boundary
    parts = [f"{key} = {listing(v) if v == 0 else with_symbol(v, of[key])}" for key, v in support.fix.items()]
    others = {key: getattr(support, key) for key in type(support).model_fields if key not in ("on", "fix")}
    parts += [f"{key} {listing(value)}" for key, value in others.items() if value is not None]
    return " and ".join(parts)


def load_words(load: Load) -> str:
    """Kind and value of a load with its unit."""
    value = getattr(load, load.kind)
    words = keys_in_words(value) if isinstance(value, BaseModel) else with_symbol(value, load.kinds[load.kind].meaning)
    return f"{load.kind} {words}"
