"""Recorded accelerations of the ground: CSV files with units, and the AT2 files of published records."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np

from restshape.bounds import NUMBER, RECORD_BYTES, RECORD_POINTS
from restshape.errors import UserError
from restshape.scene.source import read_text
from restshape.scene.units import UnitError, quantity

STANDARD_GRAVITY = 9.80665
"""What ``g`` stands for in records [m/s^2]."""
SUFFIXES = (".csv", ".at2")
COLUMN = re.compile(r"\s*([^\[\]]*?)\s*\[\s*([^\[\]]+?)\s*\]\s*")
COUNTS = (
    re.compile(r"NPTS\s*=\s*(?P<count>\d+)\s*,?\s*DT\s*=\s*(?P<step>[-+.\dEe]+)", re.IGNORECASE),
    re.compile(r"^\s*(?P<count>\d+)\s+(?P<step>[-+.\dEe]+)\s+NPTS\s*,\s*DT", re.IGNORECASE),
)
"""Forms of the fourth line of an AT2 file, new and old."""
AT2_HEADER = 4
DO_CSV = "let the first line be: time [s],acceleration [m/s^2]"


@dataclass(frozen=True, eq=False)
class GroundRecord:
    """Acceleration of the ground along one direction: linear between its samples, 0 before the first and after all.

    Args:
        times: (n,) rising [s].
        accelerations: (n,) [m/s^2].
    """

    times: np.ndarray
    accelerations: np.ndarray

    def __call__(self, t: float) -> float:
        """The acceleration [m/s^2] at a time [s] of the record."""
        return float(np.interp(t, self.times, self.accelerations, left=0.0, right=0.0))

    @property
    def step(self) -> float:
        """The shortest time between two samples [s]."""
        return float(np.diff(self.times).min())

    @property
    def peak(self) -> float:
        """The largest size of the acceleration [m/s^2]."""
        return float(np.abs(self.accelerations).max())


def read_record(path: Path) -> GroundRecord:
    """The record in a file, which is read once as long as it does not change.

    A ``.csv`` has a first line that names the two columns with their units, such as ``time [s],acceleration [g]``, and
    a sample a line after it; lines that begin with ``#`` are comments. An ``.at2`` is one of PEER's: four lines of
    header, of which the last has NPTS and DT [s], then the accelerations in g, the first at time 0.

    Raises:
        UserError: the file is none of these; names the line.
    """
    if path.suffix.lower() not in SUFFIXES:
        raise UserError("a record of the ground is a .csv or an .at2 file", str(path), "name such a file")
    try:
        written = path.stat().st_mtime_ns
    except (OSError, ValueError):
        written = 0
    return _read(path, written)


@lru_cache(maxsize=8)
def _read(path: Path, _: int) -> GroundRecord:
    lines = read_text(path, "record of the ground", RECORD_BYTES).splitlines()
    return (_of_csv if path.suffix.lower() == ".csv" else _of_at2)(lines, path)


def _of_csv(lines: list[str], path: Path) -> GroundRecord:
    """The record of a table with two columns."""
    numbered = [(k, line) for k, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not numbered:
        raise UserError("the record is empty", str(path), DO_CSV)
    factors = _factors(*numbered[0], path)
    samples = np.empty((len(numbered) - 1, 2))
    for row, (number, line) in enumerate(numbered[1:]):
        cells = line.split(",")
        if len(cells) != len(factors):
            what = f"there are {len(cells)} values in this line, and two are wanted"
            raise UserError(what, f"{path}: line {number}", "write a time and an acceleration, with a comma between")
        samples[row] = [_number(cell, path, number) for cell in cells]
    times, accelerations = (samples * factors).T
    order = np.flatnonzero(np.diff(times) <= 0)
    if len(order):
        what = "the time is not later than that of the line before"
        raise UserError(what, f"{path}: line {numbered[2 + order[0]][0]}", "let times rise from line to line")
    return _checked(times, accelerations, path)


def _factors(number: int, line: str, path: Path) -> list[float]:
    """SI values of the units of time and acceleration, which the first line names."""
    found = [COLUMN.fullmatch(cell) for cell in line.split(",")]
    if len(found) != 2 or not all(found):
        raise UserError("this line does not say the units of two columns", f"{path}: line {number}", DO_CSV)
    factors = []
    for match, dimension in zip(found, ("time", "acceleration")):
        unit = match[2] if match else ""
        if dimension == "acceleration" and unit == "g":
            factors.append(STANDARD_GRAVITY)
            continue
        try:
            factors.append(quantity(f"1 {unit}", dimension))
        except UnitError as error:
            raise UserError(f"{unit!r} is no unit of {dimension}: {error}", f"{path}: line {number}", DO_CSV) from error
    return factors


def _of_at2(lines: list[str], path: Path) -> GroundRecord:
    """The record of a file of PEER's."""
    header = lines[:AT2_HEADER]
    where = f"{path}: line {AT2_HEADER}"
    last = header[-1] if len(header) == AT2_HEADER else ""
    match = next(filter(None, (form.search(last) for form in COUNTS)), None)
    if match is None:
        do = "such as NPTS= 4000, DT= .0050 SEC; a table of times is a .csv"
        raise UserError("the fourth line of an AT2 file has the number of points and the step", where, do)
    if re.search(r"VELOCITY|DISPLACEMENT", header[2], re.IGNORECASE):
        raise UserError("this is no record of accelerations", f"{path}: line 3", "name the .AT2 file of the record")
    count, step = int(match["count"]), _number(match["step"], path, AT2_HEADER)
    if not step > 0.0:
        raise UserError("the step is not positive", where, "check the file")
    values = [
        _number(word, path, number)
        for number, line in enumerate(lines[AT2_HEADER:], AT2_HEADER + 1)
        for word in line.split()
    ]
    if len(values) != count:
        raise UserError(f"there are {len(values)} values, and NPTS is {count}", where, "download the record again")
    return _checked(step * np.arange(count), STANDARD_GRAVITY * np.array(values), path)


def _number(text: str, path: Path, line: int) -> float:
    try:
        value = float(text)
    except ValueError:
        raise UserError(f"{text.strip()[:40]!r} is no number", f"{path}: line {line}", "write a number there") from None
    if not abs(value) <= NUMBER:
        raise UserError(
            f"{text.strip()[:40]!r} is no finite number below {NUMBER:g}", f"{path}: line {line}", "mend it"
        )
    return value


def _checked(times: np.ndarray, accelerations: np.ndarray, path: Path) -> GroundRecord:
    if not 2 <= len(times) <= RECORD_POINTS:
        what = f"the record has {len(times)} samples, and 2 to {RECORD_POINTS} are read"
        raise UserError(what, str(path), "name another file")
    return GroundRecord(times, accelerations)
