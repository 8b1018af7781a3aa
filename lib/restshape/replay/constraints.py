"""Constraint status: whether the quantities of a frame keep the limits that the scene gives them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from restshape.analysis.row_values import findings_in, text
from restshape.findings import Finding
from restshape.scene.model import Quantity, Scene
from restshape.scene.plain_values import table_in
from restshape.scene.quantity import in_unit, limit_digits
from restshape.scene.units import reads_as_quantity

if TYPE_CHECKING:
    from restshape.analysis.analysis import RowValues

HOLDS, UNCERTAIN, FAILS = "holds", "uncertain", "fails"
"""Uncertain: a value is nearer to its limit, on either side, than errors and jumps of the mesh may move it."""
UNSURE = "but uncertain:"
"""In the note of an uncertain value, before its numbers."""
LIMIT, MIN, MAX = "limit", "min", "max"
"""Kind of a finding on a quantity, and its details: below the least value, above the largest one."""
UNCERTAINTY = "uncertainty"
"""Kind of a finding on a quantity that is nearer to a limit than it is known; details as of `LIMIT`."""


@dataclass(frozen=True)
class Limit:
    """The smallest and the largest value of a quantity that holds, in its SI unit."""

    least: float = -math.inf
    most: float = math.inf
    unit: str = ""


Limits = Mapping[str, Limit]
"""By quantity."""


def limits_of(quantities: Mapping[str, Quantity]) -> Limits:
    """The limits that a scene gives its quantities."""
    return {
        name: Limit(
            -math.inf if q.min is None else q.min,
            math.inf if q.max is None else q.max,
            q.unit,
        )
        for name, q in quantities.items()
        if q.max is not None or q.min is not None
    }


class MovingLimits:
    """The limits of the frames of a session, whose parameters may move them."""

    def __init__(self) -> None:
        self._of: Mapping[str, Quantity] | None = None
        self._limits: Limits = {}

    def __call__(self, quantities: Mapping[str, Quantity]) -> Limits:
        """The limits of the quantities of a frame's scene, found again where these are others."""
        if quantities is not self._of:
            self._of, self._limits = quantities, limits_of(quantities)
        return self._limits


def moving_limits(scene: Scene) -> list[tuple[str, str]]:
    """The limits that formulas of parameters give: of which quantity, and `min` or `max`."""
    written = table_in(scene.raw, "quantities")
    return [
        (name, key)
        for name, one in scene.quantities.items()
        for key in (MIN, MAX)
        for raw in (table_in(written, name).get(key, table_in(written, name).get(one.renamed[key])),)
        if isinstance(raw, str) and not reads_as_quantity(raw)
    ]


def recorded_limits(quantities: Mapping[str, Quantity]) -> dict[str, dict[str, float]]:
    """The limits as the header of a recording has them: `min` and `max` in SI units, those alone that there are."""
    both = {name: {MIN: limit.least, MAX: limit.most} for name, limit in limits_of(quantities).items()}
    return {name: {key: v for key, v in one.items() if math.isfinite(v)} for name, one in both.items()}


def constraint_status(limits: Limits, quantities: Mapping[str, float]) -> str:
    """ "holds" or "fails"; empty where there is no limit, or a limited quantity has no number.

    Args:
        limits: by quantity.
        quantities: values by name.
    """
    if not limits or any(math.isnan(quantities[name]) for name in limits):
        return ""
    return FAILS if violated_constraints(limits, quantities) else HOLDS


def violated_constraints(limits: Limits, quantities: Mapping[str, float]) -> tuple[Finding, ...]:
    """The quantities beyond their limits; arguments as in `constraint_status`."""
    found = []
    for name, limit in limits.items():
        value = quantities[name]
        if value < limit.least or value > limit.most:
            detail, bound = (MIN, limit.least) if value < limit.least else (MAX, limit.most)
            found.append(Finding(LIMIT, detail, (name,), value, bound, limit.unit))
    return tuple(found)


def uncertain_constraints(
    limits: Limits, quantities: Mapping[str, float], errors: Mapping[str, float]
) -> tuple[Finding, ...]:
    """The quantities nearer to a limit than they are known, within it or beyond.

    Args:
        limits, quantities: as in `constraint_status`.
        errors: by quantity, in its unit; infinite where it is at a singular place, whose value is that of the mesh.
            There a value beyond its limit is certainly so: it grows where the mesh is refined.
    """
    found = []
    for name, limit in limits.items():
        value, error = quantities[name], errors.get(name, math.nan)
        least = -error if math.isfinite(error) else 0.0
        for detail, bound, left in ((MIN, limit.least, value - limit.least), (MAX, limit.most, limit.most - value)):
            if least < left < error or left == 0.0 < error:
                found.append(Finding(UNCERTAINTY, detail, (name,), value, bound, limit.unit))
    return tuple(found)


def value_and_bound(finding: Finding) -> tuple[str, str]:
    """A value beyond a limit and the limit, with units and as many digits as give the limit and distinguish the two."""
    value, bound, unit = finding.value, finding.bound, finding.unit
    if value is None or bound is None:
        raise ValueError("the finding has no value or no bound")
    texts = ((in_unit(unit, value, n), in_unit(unit, bound, n)) for n in (limit_digits(bound), 8, 16))
    return next((pair for pair in texts if pair[0] != pair[1]), (str(value), str(bound)))


def formatted_constraint(finding: Finding, worst: bool = False) -> str:
    """A violated constraint, such as ``sag is 3.2 mm, at most 3 mm``.

    Args:
        finding: of `violated_constraints`.
        worst: the value is the worst of several.
    """
    value, bound = value_and_bound(finding)
    far = {MIN: "down to ", MAX: "up to "}[finding.detail] if worst else ""
    return f"{finding.subjects[0]} is {far}{value}, {'at least' if finding.detail == MIN else 'at most'} {bound}"


OF_BOTH = frozenset(("constraint_status", "violated_constraints", "note", "findings"))
"""Columns that an application and all frames have a part in."""


def joined(row: RowValues, own: RowValues) -> RowValues:
    """The columns of an application, with its constraint status, findings and notes before those that a row has."""
    if OF_BOTH.isdisjoint(own):
        return own
    known = [status for one in (own, row) if (status := text(one, "constraint_status"))]
    worst = next((status for status in (FAILS, UNCERTAIN) if status in known), "".join(known[:1]))
    both: RowValues = {"constraint_status": worst}
    for name in ("violated_constraints", "note"):
        both[name] = "; ".join(filter(None, (text(one, name) for one in (own, row))))
    both["findings"] = (*findings_in(own), *findings_in(row))
    return {**own, **both}
