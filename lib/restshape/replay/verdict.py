"""Verdicts: whether the quantities of a frame keep the limits that the scene gives them."""

from collections.abc import Iterable, Mapping
from typing import Any

HOLDS, FAILS = "holds", "fails"


def verdict(limits: Mapping[str, float], quantities: Mapping[str, float]) -> str:
    """ "holds" or "fails"; empty where there is no limit, or a limited quantity has no number.

    Args:
        limits: by quantity, in its unit.
        quantities: values by name.
    """
    values = [(quantities[name], limit) for name, limit in limits.items()]
    if not values or any(value != value for value, _ in values):
        return ""
    return HOLDS if all(value <= limit for value, limit in values) else FAILS


def counted(rows: Iterable[Mapping[str, Any]]) -> dict[str, Any]:
    """How many frames hold and fail, and the verdict of the last frame that has one; empty where none has."""
    verdicts = [row["verdict"] for row in rows if row["verdict"]]
    return {"holds": verdicts.count(HOLDS), "fails": verdicts.count(FAILS), "last": verdicts[-1]} if verdicts else {}
