"""What all frames of a recording of a plane shape hold: their extent, their deformation, and the range of a field."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from restshape.replay.columns import SIMULATED
from restshape.replay.recording.recording import Recording
from restshape.report.field import ShownField
from restshape.report.tables import column, refused

USUAL = 99.5
"""Percentile of a frame's values that a range shows in any case."""
FAR = 3.0
"""Values beyond this multiple of usual ones lie above the range: a singular corner must not darken all the rest."""
START = 20
"""The first of so many frames may lie above the range likewise: the pressure of a flow that is set off at once."""


@dataclass(frozen=True)
class Survey:
    """Arrays (n,) of all frames, not numbers where a frame was refused or has no solution.

    Args:
        low, high: (n, 2) corners of each shape at rest [m].
        largest: displacement [m].
        bottom, top: least and largest value of the field.
        usual: its `USUAL` percentile, of sizes where the field is signed.
        solved: the frame has a solution of its own.
        start: how many frames may be those of a motion that is set off at once; 0 without a motion.
    """

    low: np.ndarray
    high: np.ndarray
    largest: np.ndarray
    bottom: np.ndarray
    top: np.ndarray
    usual: np.ndarray
    solved: np.ndarray
    start: int = 0


def survey(recording: Recording, field: ShownField | None) -> Survey:
    """Looks at every frame of a recording of a shape in the plane."""
    n, stopped = recording.n, refused(recording)
    low, high = np.empty((n, 2)), np.empty((n, 2))
    largest, bottom, top, usual = np.full((4, n), np.nan)
    solved = ~stopped
    for i in range(n):
        X, u = recording.points(i), displacement(recording, i)
        low[i], high[i] = X.min(axis=0), X.max(axis=0)
        if stopped[i]:
            continue
        if u is not None:
            size = np.hypot(u[:, 0], u[:, 1])
            solved[i] = np.isfinite(size).any()
            largest[i] = size.max() if solved[i] else np.nan
        if field:
            values = field.values(recording, i)
            values = values[np.isfinite(values)]
            solved[i] &= bool(len(values)) or u is not None
            if len(values):
                bottom[i], top[i] = values.min(), values.max()
                sizes = np.abs(values) if field.look.signed else values
                place = int(USUAL / 100.0 * (len(sizes) - 1))
                usual[i] = np.partition(sizes, place)[place]
    start = n // START if np.nanmax(column(recording, SIMULATED), initial=0.0) > 0.0 else 0
    return Survey(low, high, largest, bottom, top, usual, solved, start)


def displacement(recording: Recording, i: int) -> np.ndarray | None:
    """Displacement (n, 2) of frame i [m], not numbers where none is known; None where the recording has none."""
    return recording.field(i, "displacement")[:, :2] if "displacement" in recording.fields else None


def known_displacement(recording: Recording, i: int) -> np.ndarray:
    """Displacement (n, 2) of frame i [m]; zero where none is known."""
    u = displacement(recording, i)
    return np.zeros_like(recording.points(i)) if u is None else np.nan_to_num(u, posinf=0.0, neginf=0.0)


def colour_range(field: ShownField, seen: Survey, frames: Sequence[int] = ()) -> tuple[float, float]:
    """The values at the bottom and at the top of the colours of these frames; by default of all."""
    known = np.isfinite(seen.top)
    if frames:
        known &= np.isin(np.arange(len(known)), frames)
    if not known.any():
        return 0.0, 1.0
    known = np.flatnonzero(known)
    start, then = known[known < seen.start], known[known >= seen.start]
    if seen.usual[start].max(initial=0.0) > FAR * seen.usual[then].max(initial=0.0) > 0.0:
        known = then
    bottom, top, usual = float(seen.bottom[known].min()), float(seen.top[known].max()), float(seen.usual[known].max())
    if field.look.signed:
        size = max(-bottom, top)
        size = usual if 0.0 < FAR * usual < size else size
        return (-size, size) if size else (-1.0, 1.0)
    if field.look.from_zero:
        bottom = min(0.0, bottom)
        top = usual if 0.0 < FAR * usual < top else top
    return bottom, top if top > bottom else bottom + 1.0
