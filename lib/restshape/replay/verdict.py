"""Verdicts: whether the quantities of a frame keep the limits that the scene gives them."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

from restshape.scene.model import Quantity

HOLDS, FAILS = "holds", "fails"


Limits = Mapping[str, tuple[float, float]]
"""The smallest and the largest value that holds, by quantity."""


def limits_of(quantities: Mapping[str, Quantity]) -> Limits:
    """The limits that a scene gives its quantities, in their units."""
    return {
        name: (-math.inf if q.at_least is None else q.at_least, math.inf if q.limit is None else q.limit)
        for name, q in quantities.items()
        if q.limit is not None or q.at_least is not None
    }


def verdict(limits: Limits, quantities: Mapping[str, float]) -> str:
    """ "holds" or "fails"; empty where there is no limit, or a limited quantity has no number.

    Args:
        limits: by quantity.
        quantities: values by name.
    """
    values = [(least, quantities[name], most) for name, (least, most) in limits.items()]
    if not values or any(value != value for _, value, _ in values):
        return ""
    return HOLDS if all(least <= value <= most for least, value, most in values) else FAILS


def counted(rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """How many frames hold and fail, and the verdict of the last frame that has one; empty where none has."""
    verdicts = [row["verdict"] for row in rows if row["verdict"]]
    return {"holds": verdicts.count(HOLDS), "fails": verdicts.count(FAILS), "last": verdicts[-1]} if verdicts else {}
