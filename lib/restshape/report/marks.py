"""Where the extremes of a field are: those that quantities report, else those of the whole body."""

from dataclasses import dataclass

import numpy as np

from restshape.outputs.si_numbers import digits_apart, si
from restshape.replay.recording.recording import Recording
from restshape.replay.rounding import cleared
from restshape.report.extreme_words import DIGITS, EXTREMES, extreme_words
from restshape.report.field import ShownField
from restshape.report.recorded_quantities import quantity_specs
from restshape.report.tables import places_of_frame

SYMBOLS = (("o", "○"), ("s", "□"), ("^", "△"), ("D", "◇"))
"""Markers, and letters that look like them."""
CROSS, CROSS_LETTER = "x", "×"
"""Of a singular place."""
SAME = 1e-9
"""Relative difference up to which a value of the field is that of a quantity."""


@dataclass(frozen=True)
class Mark:
    """A place where a field has a value that is reported.

    Args:
        node: of frame's mesh.
        text: what it is, with its value.
        marker, letter: how it is drawn, and written.
    """

    node: int
    text: str
    marker: str
    letter: str


def marks(recording: Recording, i: int, field: ShownField, cells: np.ndarray) -> list[Mark]:
    """The places of frame i that are marked, as many as there are `SYMBOLS` at most.

    A quantity that is an extreme of the field is where the field has its value, also where it looks at one edge only.
    One that looks at a part of the body is not marked where several nodes have its value: the recording does not say
    which of them are of the part. Without any it is the largest value of the field, and the smallest where colours do
    not begin at 0, but none where the field is the same everywhere.

    Args:
        recording: of a shape in the plane.
        i: the frame.
        field: that is shown.
        cells: (ne, k) of the frame.
    """
    values = field.values(recording, i, cells)
    known = np.flatnonzero(np.isfinite(values.ravel()))
    if not len(known):
        return []
    flat, nodes = values.ravel()[known], cells.ravel()[known]
    found = _of_quantities(recording, i, field, flat, nodes) or _of_field(field, flat)
    return [Mark(int(nodes[place]), text, marker, letter) for (place, text), (marker, letter) in zip(found, SYMBOLS)]


def singular_points(recording: Recording, i: int) -> np.ndarray:
    """Singular places (k, 2) of frame i, of its shape at rest [m]."""
    return places_of_frame(recording, i).points


def singular_words(recording: Recording, i: int) -> list[str]:
    """What is said of the crosses of frame i."""
    found = places_of_frame(recording, i)
    if not len(found.points) and not found.more_points:
        return []
    names = ", ".join(found.exponents) + f" and {found.more_quantities} more" * bool(found.more_quantities)
    crossed = f"{CROSS_LETTER} singular places: {names}"
    count, all_of_them = len(found.points), len(found.points) + found.more_points
    return [f"{crossed} ({count} of {all_of_them} are crossed)" if found.more_points else crossed]


def _of_quantities(
    recording: Recording, i: int, field: ShownField, flat: np.ndarray, nodes: np.ndarray
) -> list[tuple[int, str]]:
    found, digits = [], digits_apart([float(flat.min()), float(flat.max())], DIGITS)
    for name, spec in quantity_specs(recording.header).items():
        value = float(recording.table.get(f"q_{name}", np.full(recording.n, np.nan))[i])
        reduce = spec.get("reduce", spec.get("take", "max"))
        if not (np.isfinite(value) and field.quantity_of(recording, name)) or reduce not in EXTREMES:
            continue
        far = np.abs((np.abs(flat) if reduce in EXTREMES[2:] else flat) - value)
        place = int(far.argmin())
        same = far <= SAME * abs(value)
        of_all = spec.get("at", "all") == "all"
        if same[place] and (of_all or (nodes[same] == nodes[place]).all()):
            error = float(recording.table.get(f"{name}_error", np.full(recording.n, np.nan))[i])
            words = extreme_words(name, value, cleared(error, value), field.look.unit, digits)
            found.append((place, words))
    return found


def _of_field(field: ShownField, flat: np.ndarray) -> list[tuple[int, str]]:
    if not np.ptp(flat):
        return []
    unit = field.look.unit
    ends = [(int(flat.argmax()), "max")]
    if field.look.signed or not field.look.from_zero:
        ends.append((int(flat.argmin()), "min"))
    digits = digits_apart([float(flat[place]) for place, _ in ends], DIGITS)
    return [(place, f"{name} {si(float(flat[place]), unit, digits)}") for place, name in ends]
