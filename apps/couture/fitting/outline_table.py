"""Points of an outline from a table: separators, titles and units as spreadsheets write them."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from restshape.errors import UserError, one_line
from restshape.outputs.si_numbers import counted

FEWEST = 8
"""Points of an outline."""
BYTES = 1 << 24
"""Of a table."""
UNITS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
EXAMPLE = "x [mm],y [mm]"


def read_table(path: Path) -> tuple[np.ndarray, str]:
    """Points (m, 2) [m] of a table, and what is in doubt of its unit ("": nothing).

    A row is a point, with "," between x and y, or ";" where decimals may have commas. The first row may be a title.

    Raises:
        UserError: it cannot be read, or its unit is not one of `UNITS`.
    """
    if path.stat().st_size > BYTES:
        raise UserError(f"the table is longer than {BYTES} bytes", path.name, "give fewer points")
    text = path.read_text(encoding="utf-8-sig", errors="replace")
    rows = [(number, row) for number, row in enumerate(text.splitlines(), 1) if row.strip()]
    titled = bool(rows) and all(_number(cell) is None for cell in _cells(rows[0][1]))
    unit = _unit(rows[0][1], path.name) if titled else None
    points = [_point(row, f"{path.name}, line {number}") for number, row in rows[titled:]]
    if len(points) < FEWEST:
        do = f"give the whole outline: {FEWEST} points at least"
        raise UserError(f"the table has {counted(len(points), 'point')}", path.name, do)
    doubt = "" if unit else f"the table has no unit in its first row, such as {EXAMPLE}, and is read in millimetres"
    return np.array(points) * UNITS[unit or "mm"], doubt


def _cells(row: str) -> list[str]:
    if ";" in row:
        return [cell.replace(",", ".").strip() for cell in row.strip().rstrip(";").split(";")]
    return [cell.strip() for cell in row.strip().rstrip(",").split(",")]


def _number(cell: str) -> float | None:
    try:
        return float(cell)
    except ValueError:
        return None


def _point(row: str, where: str) -> list[float]:
    found = [_number(cell) for cell in _cells(row)]
    numbers = [one for one in found if one is not None and np.isfinite(one)]
    if len(found) != 2 or len(numbers) != 2:
        raise UserError("a row is not of two numbers", where, "write x and y, a point a row; with decimal commas x;y")
    return numbers


def _unit(title: str, where: str) -> str | None:
    """The unit that a title names in brackets; None: it names none."""
    named = list(dict.fromkeys(one.strip() for one in re.findall(r"[\[(]([^\])]*)[\])]", title)))
    if not named:
        return None
    if len(named) > 1:
        what = f"x and y are in unlike units: {one_line(' and '.join(named))}"
    elif named[0] not in UNITS:
        what = f"{one_line(named[0])!r} is no unit of a table"
    else:
        return named[0]
    raise UserError(what, f"{where}, first row", f"write {EXAMPLE}; units are {', '.join(UNITS)}")
