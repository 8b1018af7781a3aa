"""Verdicts: whether the quantities of a frame keep the limits that the scene gives them."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

from restshape.scene.model import Quantity
from restshape.scene.quantity import with_unit

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
    if not limits or any(math.isnan(quantities[name]) for name in limits):
        return ""
    return FAILS if broken(limits, quantities) else HOLDS


def broken(limits: Limits, quantities: Mapping[str, float]) -> list[str]:
    """Names of the quantities beyond their limits; arguments as in `verdict`."""
    return [name for name, (least, most) in limits.items() if quantities[name] < least or quantities[name] > most]


def breaches(limits: Limits, quantities: Mapping[str, float], dimensions: Mapping[str, str]) -> list[str]:
    """What each quantity beyond its limits is, and what it may be, such as ``sag is 3.2 mm, at most 3 mm``.

    Args:
        limits, quantities: as in `verdict`.
        dimensions: of the quantities, by name.
    """
    told = []
    for name in broken(limits, quantities):
        least, most = limits[name]
        word, bound = ("at least", least) if quantities[name] < least else ("at most", most)
        # As many digits as tell the two apart.
        of = dimensions[name]
        texts = ((with_unit(of, quantities[name], n), with_unit(of, bound, n)) for n in (4, 8, 16))
        value, limit = next((pair for pair in texts if pair[0] != pair[1]), (quantities[name], bound))
        told.append(f"{name} is {value}, {word} {limit}")
    return told


def both(row: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """The columns of an application, with its verdict, its reasons and its notes beside those that a row has."""
    verdicts = [one["constraint_status"] for one in (own, row) if one.get("constraint_status")]
    joined = {"constraint_status": FAILS if FAILS in verdicts else "".join(verdicts[:1])}
    for name in ("violated_constraints", "note"):
        joined[name] = "; ".join(filter(None, (one.get(name, "") for one in (own, row))))
    return {**own, **joined}


def counted(rows: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """How many frames hold and fail, the verdict of the last frame that has one, and the quantities that broke their
    limits there; empty where no frame has one."""
    verdicts = [row["constraint_status"] for row in rows if row["constraint_status"]]
    if not verdicts:
        return {}
    told = {"holds": verdicts.count(HOLDS), "fails": verdicts.count(FAILS), "last": verdicts[-1]}
    return told | {
        "violated_constraints": next(row["violated_constraints"] for row in reversed(rows) if row["constraint_status"])
    }
