"""What the header of a frame says besides its picture: columns, errors, limits, and what the hand holds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import inf, isfinite, isnan
from typing import TYPE_CHECKING

from restshape.analysis.row_values import number as number_in
from restshape.application import application_of
from restshape.findings import decode_findings
from restshape.replay.columns import error_column
from restshape.replay.constraints import FAILS, HOLDS, LIMIT, UNCERTAIN, UNCERTAINTY

if TYPE_CHECKING:
    from restshape.analysis.row_values import RowValues
    from restshape.scene.model import Scene


def columns_of(row: RowValues) -> dict[str, object]:
    """The columns of a row that say something: no empty texts, and no numbers that are none."""
    return {name: value for name, value in row.items() if value == value and value != "" and type(value) is not tuple}


def errors_of(row: RowValues, quantities: Iterable[str]) -> dict[str, float]:
    """Estimated errors of quantities, of those alone that have one; infinite where mesh refinement finds no limit."""
    return _errors_in(row, ((name, error_column(name)) for name in quantities))


def _errors_in(row: RowValues, columns: Iterable[tuple[str, str]]) -> dict[str, float]:
    """The numbers of columns that have one, by the quantities that they are of."""
    found = {}
    for name, column in columns:
        if column in row and isinstance(error := row[column], float) and not isnan(error):
            found[name] = float(error)
    return found


def limits_of_frame(row: RowValues, limited: Sequence[str]) -> dict[str, str]:
    """Whether the limits of quantities hold, of those that have one."""
    if not limited or row["refused"]:
        return {}
    found = dict.fromkeys(limited, HOLDS)
    for one in decode_findings(str(row["findings"])):
        status = {LIMIT: FAILS, UNCERTAINTY: UNCERTAIN}.get(one.kind)
        if status:
            found |= {name: status for name in one.subjects if name in found}
    return found


def limits_of_columns(row: RowValues, scene: Scene) -> dict[str, str]:
    """Whether the limits of the columns hold that are shown as quantities, of those that have a value."""
    found: dict[str, str] = {}
    if row["refused"]:
        return found
    for one in application_of(scene).shown_columns(scene):
        value = number_in(row, one.name)
        if isfinite(value) and (one.least is not None or one.most is not None):
            low, high = (-inf if one.least is None else one.least), (inf if one.most is None else one.most)
            found[one.name] = HOLDS if low <= value <= high else FAILS
    return found


class FrameHeaders:
    """Makes the header of each frame; what its scene has to say of columns stays as long as the scene does."""

    def __init__(self) -> None:
        self._scene: Scene | None = None
        self._limited: list[str] = []
        self._errors: list[tuple[str, str]] = []
        self._limits_columns = False

    def __call__(self, row: RowValues, scene: Scene, hand: Mapping[str, object] | None) -> dict[str, object]:
        """The header of a frame, but its parts and marks, and the message that it answers.

        Args:
            row: of the frame; scene: with the values that hold in it.
            hand: what it holds, and where it is; None: it holds nothing.
        """
        if scene is not self._scene:
            self._bind(scene)
        limits = limits_of_frame(row, self._limited) if self._limited else {}
        if self._limits_columns:
            limits |= limits_of_columns(row, scene)
        return {
            "type": "frame",
            "number": row["index"],
            "columns": columns_of(row),
            "errors": _errors_in(row, self._errors),
            "limits": limits,
            "held": hand,
        }

    def _bind(self, scene: Scene) -> None:
        self._scene = scene
        self._limited = [name for name, one in scene.quantities.items() if one.min is not None or one.max is not None]
        self._errors = [(name, error_column(name)) for name in scene.quantities]
        self._limits_columns = bool(application_of(scene).shown_columns(scene))


def header_of(row: RowValues, scene: Scene, hand: Mapping[str, object] | None) -> dict[str, object]:
    """The header of one frame; as of `FrameHeaders`."""
    return FrameHeaders()(row, scene, hand)
