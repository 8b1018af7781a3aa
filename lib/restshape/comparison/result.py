"""Results that can be compared: recordings, and what `replay --json` wrote."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from restshape import bounds
from restshape.arrays import AnyArray, Flags, Reals
from restshape.errors import UserError
from restshape.outputs.si_numbers import unit_of
from restshape.replay.columns import SIMULATED, quantity_names
from restshape.replay.recording.recording import Recording
from restshape.report.recorded_quantities import quantity_units
from restshape.report.tables import column, refused, singular

RESULT_BYTES = bounds.SCRIPT_BYTES
"""Text of a result that is read."""
HDF5 = b"\x89HDF\r\n\x1a\n"
TIME = "ms"
"""Column of the time of a frame; those of its parts begin with it and an underscore."""
SAID = ("policy", "guess", "ranks", "preconditioners", "unknowns", "elements", "singular", "status")
"""What a JSON file says of how its result was made."""


@dataclass
class Result:
    """A result, whatever file it comes from.

    Args:
        path: of the file.
        n: frames.
        header: how it was made.
        quantities: name -> (n,) SI units; not a number where there is no value.
        units: of quantities, where they are known.
        refused: (n,) frames that were refused; None where the file does not say.
        status: (n,) constraint status of frames as text; None likewise.
        ms: (n,) time of each frame; None likewise.
        percentiles: p50, p95, p99 of the frames that moved [ms], where no time of each frame is known.
        recording: None of a JSON file.
        simulated: (n,) simulated time at the end of each frame [s]; None of what is at rest.
    """

    path: Path
    n: int
    header: dict[str, Any]
    quantities: dict[str, Reals]
    units: dict[str, str] = field(default_factory=dict)
    refused: Flags | None = None
    status: AnyArray | None = None
    ms: Reals | None = None
    percentiles: dict[str, float] = field(default_factory=dict)
    recording: Recording | None = None
    simulated: Reals | None = None

    @property
    def singular(self) -> dict[str, float]:
        """Quantities at singular places, with the exponent of displacements there."""
        if self.recording:
            return singular(self.recording)
        known = self.header.get("singular")
        return {name: float(value) for name, value in known.items()} if isinstance(known, dict) else {}

    def close(self) -> None:
        """Closes the file."""
        if self.recording:
            self.recording.close()


def is_time(name: str) -> bool:
    """Whether a column holds a time that was measured."""
    return name == TIME or name.startswith(f"{TIME}_")


def read_result(path: Path) -> Result:
    """The result in a file.

    Raises:
        UserError: it is not there, or is neither a recording nor JSON of `replay --json`.
    """
    if not path.is_file():
        what = "this is a folder" if path.is_dir() else "there is no such file"
        raise UserError(what, str(path), "name a recording (.vtkhdf), or a file that replay --json wrote")
    with path.open("rb") as file:
        head = file.read(len(HDF5))
    return _recorded(path) if head == HDF5 else _written(path)


def _recorded(path: Path) -> Result:
    """The result in a recording, which stays open."""
    recording = Recording(path)
    table = recording.table
    names = quantity_names(table)
    stopped = refused(recording)
    quantities = {name: np.where(stopped, np.nan, column(recording, f"q_{name}")) for name in names}
    status = table.get("constraint_status")
    header = {**recording.header, "status": recording.status}
    ms = column(recording, TIME) if TIME in table else None
    units = quantity_units(recording.header)
    simulated = column(recording, SIMULATED) if SIMULATED in table else None
    return Result(path, recording.n, header, quantities, units, stopped, status, ms, {}, recording, simulated)


def _written(path: Path) -> Result:
    """The result in a JSON file."""
    do = "name a recording (.vtkhdf), or a file that replay --json wrote"
    if path.stat().st_size > RESULT_BYTES:
        raise UserError(f"this file has more than {RESULT_BYTES >> 20} MB", str(path), do)
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError):
        raise UserError("this is neither a recording nor JSON", str(path), do) from None
    if not isinstance(data, dict) or not isinstance(n := data.get("frames"), int) or n < 0:
        raise UserError("this JSON is no result of a replay: it has no number of frames", str(path), do)
    given = data.get("quantities")
    if not isinstance(given, dict):
        raise UserError("this JSON is no result of a replay: it has no quantities", str(path), do)
    try:
        quantities = {name: np.array(values, dtype=float) for name, values in given.items()}
    except (TypeError, ValueError):
        raise UserError("its quantities are no lists of numbers", str(path), do) from None
    if any(values.shape != (n,) for values in quantities.values()):
        raise UserError(f"a quantity has not {n} values, one a frame", str(path), do)
    stale = data.get("stale")
    stopped = np.array(stale, dtype=bool) if isinstance(stale, list) and len(stale) == n else None
    times = data.get("ms")
    moved = times.get("all") if isinstance(times, dict) else None
    known = moved.items() if isinstance(moved, dict) else ()
    percentiles = {key: float(value) for key, value in known if isinstance(value, int | float)}
    if not any(percentiles.values()):
        # No frame moved.
        percentiles = {}
    header = {key: data[key] for key in SAID if key in data}
    origin = data.get("origin")
    origin = dict(origin) if isinstance(origin, dict) else {}
    units = origin.pop("units", {})
    known_units = {k: unit_of(str(v)) for k, v in units.items()} if isinstance(units, dict) else {}
    simulated = _simulated(data.get(SIMULATED), n)
    return Result(
        path, n, origin | header, quantities, known_units, stopped, percentiles=percentiles, simulated=simulated
    )


def _simulated(given: object, n: int) -> Reals | None:
    """The simulated times of frames, where a JSON file has one for each."""
    try:
        found = np.array(given, dtype=float)
    except (TypeError, ValueError):
        return None
    return found if found.shape == (n,) else None
