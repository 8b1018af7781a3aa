"""Marks at the places where quantities that are extremes have their values, and words of limits that are reached."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from math import isfinite, nan
from typing import TYPE_CHECKING

import numpy as np

from restshape.analysis.row_values import number
from restshape.application import application_of
from restshape.errors import UserError
from restshape.findings import OMITTED, Finding
from restshape.live.shown_marks import Meaning, NodeValue, Words
from restshape.replay.columns import error_column, quantity_column
from restshape.replay.constraints import LIMIT, UNCERTAINTY, formatted_constraint, value_and_bound
from restshape.replay.rounding import cleared
from restshape.report.extreme_words import EXTREMES, extreme_words
from restshape.report.field import IN_CELLS

if TYPE_CHECKING:
    from restshape.arrays import Indices, Reals
    from restshape.live.seen_frame import SeenFrame
    from restshape.scene.quantity import Quantity

SAME = 1e-9
"""Relative difference between a quantity and the value of the field at its place, at most."""
SIZES = ("absmax", "peak")
"""Reductions of the size of values."""
AXES = {"x": 0, "y": 1, "z": 2}


@dataclass(frozen=True, eq=False)
class LookedAt:
    """What a quantity is taken from.

    Args:
        name: of the quantity, empty of a field that none is taken from; unit: its SI unit.
        columns: of its values and their errors.
        field: in which it is an extreme; empty where it is no extreme of a field.
        column: of vectors in that field; None: their size, or of numbers.
        reduce: which extreme.
        nodes: (k,) among which it is; None: all.
    """

    name: str
    unit: str
    field: str
    column: int | None
    reduce: str
    nodes: Indices | None
    columns: tuple[str, str]


class ExtremeMarks:
    """Finds where quantities of each frame are; what they are taken from stays as long as entities keep their nodes."""

    def __init__(self) -> None:
        self._bound: tuple[object, object, object] = (None, None, None)
        self._looked_at: list[LookedAt] = []
        self._last: list[Words | NodeValue] = []
        self._values: dict[LookedAt, NodeValue] = {}

    def __call__(self, seen: SeenFrame) -> list[Words | NodeValue]:
        """The words of extremes and of limits of a frame; nothing where it shows no answer."""
        if not seen.solved:
            return []
        # Edits of other tables leave the quantities as they are.
        quantities, space = seen.scene.quantities, seen.space
        if quantities is not self._bound[0] or space is not self._bound[1] or space.facets is not self._bound[2]:
            self._bound = quantities, space, space.facets
            self._looked_at, self._values = [*_looked_at(seen)], {}
        row, drawn = seen.frame.row, seen.all_nodes_drawn
        findings = _found_on_limits(seen) if row["findings"] else {}
        marks: list[Words | NodeValue] = []
        for one in self._looked_at:
            found = findings.pop(one.name, None) if findings else None
            if found is not None:
                marks.append(_words(_limit_words(found), _meaning(found), self._node(one, seen), seen))
            elif one.field and (node := self._node(one, seen)) is not None:
                marks.append(self._value(one, node) if drawn and one.name else _said(one, seen, node))
        if findings:
            marks += [_words(_limit_words(one), _meaning(one), None, seen) for one in findings.values()]
        # What is said again is the same object: it is not sent to the page again.
        for place, (mark, last) in enumerate(zip(marks, self._last)):
            if mark is not last and mark == last:
                marks[place] = last
        self._last = marks
        return marks

    def _value(self, one: LookedAt, node: int) -> NodeValue:
        """The value of a quantity at a node, which the page writes: the last mark where it is at the same node."""
        known = self._values.get(one)
        if known is None or known.node != node:
            known = self._values[one] = NodeValue(one.name, one.unit, node)
        return known

    def _node(self, one: LookedAt, seen: SeenFrame) -> int | None:
        """The node at which a quantity has its value, or the middle one of the place where it is taken."""
        if not one.field:
            return None if one.nodes is None or not len(one.nodes) else int(one.nodes[len(one.nodes) // 2])
        values, nodes = values_of(one, seen)
        if one.reduce in SIZES:
            values = np.abs(values)
        place = int(values.argmin() if one.reduce == "min" else values.argmax())
        if not isfinite(found := float(values[place])):
            # Some are not known: the extreme is among the others.
            known = np.flatnonzero(np.isfinite(values))
            if not len(known):
                return None
            place = int(known[values[known].argmin() if one.reduce == "min" else values[known].argmax()])
            found = float(values[place])
        value = number(seen.frame.row, one.columns[0]) if one.name else nan
        # A peak over the time steps of a frame may be nowhere at its end.
        if abs(found - value) > SAME * abs(value):
            return None
        return int(place if nodes is None else nodes[place])


def _looked_at(seen: SeenFrame) -> Iterator[LookedAt]:
    """What the quantities of a frame's scene are taken from; where none is an extreme, the first field drawn."""
    pictured = {key: look for one in application_of(seen.scene).physics for key, look in one.pictured.items()}
    looks, marked = {look.quantity: key for key, look in pictured.items()}, False
    for name, quantity in seen.scene.quantities.items():
        nodes = None
        if quantity.at is not None:
            try:
                nodes = seen.space.nodes_of(quantity.at)
            except UserError:
                continue
        field, column = _field_of(quantity, looks) if quantity.reduce in EXTREMES else ("", None)
        field, marked = _present(field, seen), marked or bool(_present(field, seen))
        columns = quantity_column(name), error_column(name)
        yield LookedAt(name, quantity.unit, field, column, str(quantity.reduce), nodes, columns)
    if marked:
        return
    for key, look in pictured.items():
        if look.quantity is not None and (field := _present(key, seen)):
            yield LookedAt("", look.unit, field, None, "max", None, ("", ""))
            return


def _present(field: str, seen: SeenFrame) -> str:
    """The name by which a frame has a field; empty where it has none."""
    return next((key for key in (field, field + IN_CELLS) if field and key in seen.frame.fields), "")


def _field_of(quantity: Quantity, looks: dict[tuple[str, object] | None, str]) -> tuple[str, int | None]:
    """The field that an extreme is taken from, and its column; no name where there is none."""
    if quantity.kind == "displacement":
        return "displacement", AXES.get(str(quantity.displacement))
    return looks.get((quantity.kind, getattr(quantity, quantity.kind)), ""), None


def values_of(one: LookedAt, seen: SeenFrame) -> tuple[Reals, Indices | None]:
    """The values (k,) among which a quantity is the extreme, and their nodes (k,); None: those of all nodes."""
    field, nodes = seen.frame.fields[one.field], one.nodes
    if one.field.endswith(IN_CELLS):
        flat, cells = field.ravel(), seen.space.cells.ravel()
        chosen = np.ones(len(cells), dtype=bool) if nodes is None else np.isin(cells, nodes)
        return flat[chosen], cells[chosen]
    field = field if nodes is None else field[nodes]
    if field.ndim == 1:
        return field, nodes
    return (np.linalg.norm(field, axis=1) if one.column is None else field[:, one.column]), nodes


def _said(one: LookedAt, seen: SeenFrame, node: int) -> Words:
    """A quantity with its value, and its estimated error if there is one; without a quantity the field's largest."""
    if one.name:
        row, (of_values, of_errors) = seen.frame.row, one.columns
        value = number(row, of_values)
        error = cleared(number(row, of_errors), value) if of_errors in row else nan
        return _words(extreme_words(one.name, value, error, one.unit), "guide", node, seen)
    values, nodes = values_of(one, seen)
    largest = float(np.nanmax(values if nodes is None else values[nodes == node]))
    return _words(extreme_words("max", largest, nan, one.unit), "guide", node, seen)


def _found_on_limits(seen: SeenFrame) -> dict[str, Finding]:
    """What a frame says of the limits of quantities, by their names."""
    said = (one for one in seen.frame.findings if one.kind in (LIMIT, UNCERTAINTY) and one.detail != OMITTED)
    return {one.subjects[0]: one for one in said if one.subjects}


def _limit_words(finding: Finding) -> str:
    """A limit that does not hold, or of which that is not known."""
    if finding.kind == LIMIT:
        return formatted_constraint(finding)
    value, bound = value_and_bound(finding)
    return f"{finding.subjects[0]} {value}, limit {bound}: uncertain"


def _meaning(finding: Finding) -> Meaning:
    return "limit" if finding.kind == LIMIT else "uncertain"


def _words(text: str, meaning: Meaning, node: int | None, seen: SeenFrame) -> Words:
    """A line of text at a node; at no place without one."""
    if node is None:
        return Words(text, None, meaning)
    at, deformed = seen.space.X[node].tolist(), seen.deformed
    if deformed is None or not seen.solved:
        return Words(text, at, meaning)
    moved = deformed[node].tolist()
    if len(moved) > len(at):
        at += [0.0] * (len(moved) - len(at))
    return Words(text, at, meaning, moved)
