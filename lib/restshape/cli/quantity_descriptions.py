"""What a scene asks for, in words."""

from pydantic import BaseModel

from restshape.scene.descriptions import keys_in_words
from restshape.scene.model import Scene
from restshape.scene.quantity import Quantity, limit_in_unit


def quantity_rows(scene: Scene) -> list[tuple[str, str]]:
    """A row a quantity of a scene: its name, and what it is of."""
    return [(f"quantity {name}", quantity_descriptions(quantity)) for name, quantity in scene.quantities.items()]


def quantity_descriptions(quantity: Quantity) -> str:
    """What a quantity is of, where, and within which limits it holds."""
    kind, value = quantity.kind, getattr(quantity, quantity.kind)
    said = keys_in_words(value) if isinstance(value, BaseModel) else value
    what = kind.replace("_", " ") if value is True else f"{kind.replace('_', ' ')} {said}"
    place = what if quantity.kinds[kind].whole else f"{quantity.reduce} of {what} at {quantity.at or 'all'}"
    limit = f", holds up to {limit_in_unit(quantity.unit, quantity.max)}" if quantity.max is not None else ""
    limit += f", holds from {limit_in_unit(quantity.unit, quantity.min)} on" if quantity.min is not None else ""
    return f"{place}{limit}"
