"""The outline of a drape seen from above, as it was measured: from a drawing or a table of points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from restshape_apps.couture.fitting.outline_crossing import refuse_crossing
from restshape_apps.couture.fitting.outline_table import FEWEST, read_table

from restshape.errors import UserError, one_line
from restshape.mesh.regions import signed_area
from restshape.outputs.si_numbers import counted
from restshape.shape.drawings.loose_curve import LooseCurves
from restshape.shape.drawings.named_points import chain_of_curve

READ = (".svg", ".dxf", ".csv")
CLOSES = 1e-2
"""Share of the size of a drawing by which ends may be apart and still meet."""
POINTS = 20_000
"""Most points of an outline."""


@dataclass(frozen=True, eq=False)
class MeasuredOutline:
    """A closed outline.

    Args:
        points: (m, 2) [m], counter-clockwise, the first one not repeated.
        notes: what was taken, and what was left out.
        doubt: what the file does not say of its unit, and what is taken; "": it says its unit.
    """

    points: np.ndarray
    notes: tuple[str, ...] = ()
    doubt: str = ""

    @property
    def area(self) -> float:
        """Its area [m^2]."""
        return signed_area(self.points)

    @property
    def middle(self) -> np.ndarray:
        """The centroid (2,) [m] of its area."""
        return middle_of_area(self.points)

    def spread(self, count: int) -> np.ndarray:
        """So many places (count, 2) [m], evenly along it."""
        closed = np.vstack([self.points, self.points[:1]])
        along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
        at = along[-1] / count * np.arange(count)
        return np.stack([np.interp(at, along, closed[:, k]) for k in range(2)], axis=1)


def middle_of_area(points: np.ndarray) -> np.ndarray:
    """The centroid (2,) [m] of the area within a closed line of points (m, 2) [m]."""
    a, b = points, np.roll(points, -1, axis=0)
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return ((a + b) * cross[:, None]).sum(axis=0) / (3.0 * cross.sum())


def read_outline(path: Path) -> MeasuredOutline:
    """The outline of a file: of several closed lines the one with the largest area.

    An SVG drawing is in metres by its width, height and viewBox, a DXF drawing by its unit. A table (CSV) has a point
    a row, x and y, in the unit that its first row names, as in ``x [mm],y [mm]``.

    Raises:
        UserError: it cannot be read, or has no closed line.
    """
    kind = path.suffix.lower()
    if kind not in READ:
        raise UserError(f"no outline can be read from {one_line(path.name)}", "--outline", f"use {', '.join(READ)}")
    if not path.is_file():
        raise UserError(f"there is no file {one_line(path)}", "--outline", "name one that is there")
    if kind == ".csv":
        return _of_table(path)
    found = _drawing(path)
    lines = [chain_of_curve(curve) for curve in found.curves]
    if not lines:
        raise UserError("the drawing has no curve", path.name, "draw the outline of the drape as one closed path")
    points, notes = largest_closed(lines, path.name)
    return MeasuredOutline(points, (*found.notes, *notes), found.doubt)


def _drawing(path: Path) -> LooseCurves:
    """The curves of a drawing."""
    # Late: each reader takes longer to import than a table takes to read.
    if path.suffix.lower() == ".svg":
        from restshape.shape.drawings.svg import read_svg

        return read_svg(path, {})
    from restshape.shape.drawings.dxf import read_dxf

    return read_dxf(path)


def largest_closed(lines: Sequence[np.ndarray], where: str) -> tuple[np.ndarray, tuple[str, ...]]:
    """The closed line (m, 2) with the largest area that lines (k, 2) make, counter-clockwise, and what to note.

    Raises:
        UserError: none is closed.
    """
    every = np.concatenate(lines)
    size = float(np.ptp(every, axis=0).max())
    joined = _joined(lines, CLOSES * size)
    gaps = [float(np.hypot(*(line[-1] - line[0]))) for line in joined]
    closed = [line for line, gap in zip(joined, gaps) if gap <= CLOSES * size and len(line) > FEWEST]
    if not closed:
        longest = max(range(len(joined)), key=lambda k: len(joined[k]))
        what = f"the outline is not closed: its ends are {1e3 * gaps[longest]:.3g} mm apart"
        if gaps[longest] <= CLOSES * size:
            what = (
                f"a closed line of {len(joined[longest])} points is no outline of a drape, which has more than {FEWEST}"
            )
        raise UserError(what, where, "draw the outline of the drape as one closed path")
    best = max(closed, key=lambda line: abs(signed_area(line)))
    left, notes = len(joined) - 1, []
    if gap := float(np.hypot(*(best[-1] - best[0]))):
        notes.append(f"the outline is closed over a gap of {1e3 * gap:.2g} mm")
    if left:
        notes.append(f"left out: {counted(left, 'other line')}; the outline is the closed one with the largest area")
    return _plain(best, where), tuple(notes)


def _joined(lines: Sequence[np.ndarray], near: float) -> list[np.ndarray]:
    """Lines that meet at their ends, in one."""
    waiting = list(lines)
    found: list[np.ndarray] = []
    while waiting:
        parts = [waiting.pop(0)]
        while waiting and np.hypot(*(parts[-1][-1] - parts[0][0])) > 1e-9:
            ends = np.array([[one[0], one[-1]] for one in waiting])
            away = np.hypot(*np.moveaxis(ends - parts[-1][-1], -1, 0))
            k, side = np.unravel_index(int(away.argmin()), away.shape)
            home = float(np.hypot(*(parts[-1][-1] - parts[0][0]))) if len(parts) > 1 else np.inf
            if away[k, side] > min(near, home):
                break
            one = waiting.pop(int(k))
            parts.append(one[::-1] if side else one)
        # The other end of an open line may go on, too.
        whole = np.concatenate(parts)
        again = next((k for k, one in enumerate(found) if _meets(one, whole, near)), None)
        found.append(whole if again is None else _together(found.pop(again), whole, near))
    return found


def _meets(one: np.ndarray, other: np.ndarray, near: float) -> bool:
    """Whether two open lines meet at an end."""
    if any(np.hypot(*(line[-1] - line[0])) <= near for line in (one, other)):
        return False
    return any(np.hypot(*(one[i] - other[j])) <= near for i in (0, -1) for j in (0, -1))


def _together(one: np.ndarray, other: np.ndarray, near: float) -> np.ndarray:
    """Two lines that meet at an end, in one."""
    for first in (one, one[::-1]):
        for second in (other, other[::-1]):
            if np.hypot(*(first[-1] - second[0])) <= near:
                return np.concatenate([first, second])
    return one


def _plain(points: np.ndarray, where: str) -> np.ndarray:
    """Points (m, 2) counter-clockwise, none twice in a row.

    Raises:
        UserError: too many, too few, without an area, or of a line that crosses itself.
    """
    if len(points) > POINTS:
        raise UserError(f"the outline has {len(points)} points", where, f"give at most {POINTS}")
    apart = np.hypot(*(points - np.roll(points, 1, axis=0)).T) > 1e-12
    points = points[apart]
    if len(points) < FEWEST:
        do = f"draw the whole outline: {FEWEST} points at least"
        raise UserError(f"the outline has {len(points)} points apart from each other", where, do)
    if signed_area(points) == 0.0:
        raise UserError(f"an outline of {len(points)} points has no area", where, "draw the outline of the drape")
    refuse_crossing(points, where)
    return points if signed_area(points) > 0.0 else points[::-1].copy()


def _of_table(path: Path) -> MeasuredOutline:
    """The outline of a table."""
    points, doubt = read_table(path)
    return MeasuredOutline(*_closed_table(points, path.name), doubt)


def _closed_table(points: np.ndarray, where: str) -> tuple[np.ndarray, tuple[str, ...]]:
    """Points of a table, which are closed without their first one again where the gap is as wide as others are.

    Raises:
        UserError: the gap is wider.
    """
    steps = np.hypot(*np.diff(points, axis=0).T)
    gap, size = float(np.hypot(*(points[-1] - points[0]))), float(np.ptp(points, axis=0).max())
    if gap > max(2.0 * float(steps.max()), CLOSES * size):
        what = f"the outline is not closed: its ends are {1e3 * gap:.3g} mm apart"
        raise UserError(what, where, "give the points all the way round")
    return _plain(points, where), ()
