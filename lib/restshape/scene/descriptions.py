"""What a scene holds, in words."""

from collections.abc import Mapping

from pydantic import BaseModel

from restshape.scene.expressions import Expression
from restshape.scene.units import SYMBOLS, in_si
from restshape.scene.values import annotation_of, dimension_of


def listing(value: object) -> str:
    """A number, the text of a formula, or several of them in parentheses."""
    if isinstance(value, tuple | list):
        return f"({', '.join(map(listing, value))})"
    if isinstance(value, Expression):
        return value.text
    return str(value) if isinstance(value, bool | str) else f"{value:.6g}"


def with_symbol(value: object, dimension: object) -> str:
    """A value, as in `listing`, with the SI unit of its dimension; a formula that has units of its own without."""
    symbol = SYMBOLS.get(dimension, "") if isinstance(dimension, str) else ""
    parts = value if isinstance(value, tuple | list) else (value,)
    formulas = [part.text for part in parts if isinstance(part, Expression)]
    if not symbol or any(in_si(text) != text for text in formulas):
        return listing(value)
    return (
        f"({listing(value)}) {symbol}"
        if isinstance(value, Expression) and value.is_sum
        else f"{listing(value)} {symbol}"
    )


def keys_in_words(model: BaseModel, without: tuple[str, ...] = ()) -> str:
    """The keys of a model that have values, with their units, and those inside them.

    Args:
        model: of a scene.
        without: keys that are left out.
    """
    return ", ".join(f"{key} {words}" for key, words in _keys(model, "") if key not in without)


def _keys(model: BaseModel, prefix: str) -> list[tuple[str, str]]:
    found = []
    for key, info in type(model).model_fields.items():
        value = getattr(model, key)
        if isinstance(value, BaseModel):
            found += _keys(value, f"{prefix}{key}.")
        elif value is not None and not isinstance(value, Mapping):
            found.append((f"{prefix}{key}", with_symbol(value, dimension_of(annotation_of(info)))))
    return found
