"""The picture of a tone beside the edit that changes it: shapes with their first mode above, the frequency below."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.ticker import NullFormatter, NullLocator
from matplotlib.tri import Triangulation

from restshape.analysis.modal.pitch import A4, frequency_of, note, tuned
from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import length_unit
from restshape.replay.recording.recording import Recording
from restshape.report.fitted_title import fitted
from restshape.report.outlines import border, chains
from restshape.report.style import FAINT, INK, LEVELS, SIGNED, new_figure

QUARTERS = ([0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5])
"""Nodes of the four triangles that a second-order one is drawn as."""
ACROSS, WIDTH = 5, 11.0
"""Shapes side by side at most, and width of the figure [inch]."""
ROOM = 0.015
"""Room around a shape, over the size of the largest."""
SEMITONES = 16
"""Up to so many semitones each has a line, beyond only the white keys."""
PAPER = {"boxstyle": "square,pad=0.05", "fc": "white", "ec": "none", "alpha": 0.8}
ENDING = ("insert", "press", "pull", "release", "idle", "undo", "redo", "analyse", "start")
"""Events that change nothing by themselves, or whose frames are those of another one."""


@dataclass(frozen=True, eq=False)
class Pitches:
    """What is shown of a recording.

    Args:
        times: (n,) edit times [s]; frequencies: (n,) of the first mode [Hz], not numbers where there is none.
        a4: frequency of A4 [Hz].
        shown: frames whose shapes are drawn.
    """

    times: list[float]
    frequencies: list[float]
    a4: float
    shown: list[int]

    def words(self, frame: int) -> str:
        """The tone of a frame."""
        name, cents = note(self.frequencies[frame], self.a4)
        return f"{name} {cents:+.0f} cents".replace("-", "\N{MINUS SIGN}") if name else "no tone"


def pitches_of(recording: Recording, frames: Sequence[int], most: int) -> Pitches:
    """What is shown of a recording: these frames, or where its gestures end, evenly chosen of more than `most`."""
    table, frequencies = recording.table, [float(f) for f in recording.table["f_1"]]
    known = [k for k, f in enumerate(frequencies) if np.isfinite(f)]
    lines, events = [int(line) for line in table["line"]], [str(event) for event in table["event"]]
    ends = [k for k in known if events[k] not in ENDING and (k + 1 == recording.n or lines[k + 1] != lines[k])]
    ends = sorted({*known[:1], *ends})
    if len(ends) > most:
        ends = [ends[k] for k in np.unique(np.linspace(0, len(ends) - 1, most).round().astype(int))]
    name, cents = (table[key][known[0]] for key in ("tone", "cents")) if known else ("", 0.0)
    a4 = tuned(frequencies[known[0]], str(name), float(cents)) if name else A4
    return Pitches([float(t) for t in recording.times], frequencies, a4, list(frames) or ends)


def draw_pitches(path: Path, recording: Recording, found: Pitches) -> None:
    """Draw the shapes with their numbers, and the tone over the edit time with the same numbers."""
    down = -(-len(found.shown) // ACROSS)
    across = min(ACROSS, len(found.shown))
    extents = np.array([[X.min(axis=0), X.max(axis=0)] for X, _ in map(recording.mesh, found.shown)])
    low, high = extents[:, 0].min(axis=0), extents[:, 1].max(axis=0)
    wide, margin = float((high - low)[0]), ROOM * float((high - low).max())
    each = min(1.4, 0.35 + 2.1 * float((high - low)[1] / (high - low)[0])) + 0.35
    figure = new_figure(WIDTH, 3.6 + down * each)
    grid = figure.add_gridspec(2, 1, height_ratios=(down * each, 3.4))
    above = grid[0].subgridspec(down, across)
    for number, frame in enumerate(found.shown):
        axes = figure.add_subplot(above[number // across, number % across])
        _shape(axes, recording, frame)
        axes.set(xlim=(low[0] - margin, high[0] + margin), ylim=(low[1] - margin, high[1] + margin), aspect="equal")
        axes.set_title(f"{number + 1}: {found.frequencies[frame]:.1f} Hz, {found.words(frame)}", fontsize=8)
    _curve(figure.add_subplot(grid[1]), found)
    factor, unit = length_unit(float((high - low).max()))
    title = str(recording.header.get("title") or Path(str(recording.header.get("scene") or path)).stem)
    width = f"{factor * wide:.0f} {unit}"
    said = f" (all to one scale, {width} wide; colour: deflection of mode 1; +: hanging points)"
    figure.suptitle(fitted(title, WIDTH, said))
    save_picture(figure, path)


def _shape(axes: Axes, recording: Recording, frame: int) -> None:
    """Draw the shape of a frame in the colour of its first mode, with nodal lines and hanging points."""
    X, cells = recording.mesh(frame)
    shape = np.asarray(recording.field(frame, "mode_1"))
    axes.set_axis_off()
    axes.add_collection(LineCollection(chains(X, border(cells)), colors=INK, linewidths=0.9))
    triangles = cells if cells.shape[1] == 3 else np.concatenate([cells[:, part] for part in QUARTERS])
    values = shape[:, 2] if np.abs(shape[:, 2]).max() > 0.0 else np.hypot(shape[:, 0], shape[:, 1])
    largest = float(np.abs(values).max()) or 1.0
    # The sign of a mode is arbitrary: its middle goes down.
    middle = int(np.argmin(np.linalg.norm(X - X.mean(axis=0), axis=1)))
    values = values / largest * (-1.0 if values[middle] > 0.0 else 1.0)
    drawn = Triangulation(*X.T, triangles)
    axes.tripcolor(drawn, values, shading="gouraud", cmap=SIGNED, vmin=-1.0, vmax=1.0)
    axes.tricontour(drawn, values, levels=[0.0], colors=FAINT, linewidths=0.8)
    for k in (1, 2):
        place = [recording.table.get(f"hang_{k}_{axis}") for axis in "xy"]
        if place[0] is not None and place[1] is not None:
            axes.plot(place[0][frame], place[1][frame], "+", color=INK, ms=7)


def _curve(axes: Axes, found: Pitches) -> None:
    """Draw the first frequency over the edit time, between lines of tones."""
    times, frequencies = np.array(found.times), np.array(found.frequencies)
    axes.set_yscale("log")
    axes.plot(times, frequencies, color=LEVELS[1], lw=1.6)
    seen = frequencies[np.isfinite(frequencies)]
    low, high = float(seen.min()) / 1.03, float(seen.max()) * 1.05
    axes.set_ylim(low, high)
    names = _tones(low, high, found.a4)
    axes.set_yticks(list(names), list(names.values()))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_minor_formatter(NullFormatter())
    axes.grid(axis="y", color="#dddddd", lw=0.7)
    for number, frame in enumerate(found.shown, 1):
        axes.plot(times[frame], frequencies[frame], "o", color=LEVELS[3], ms=4)
        where = {"xytext": (0, 6), "textcoords": "offset points", "ha": "center", "bbox": PAPER}
        axes.annotate(str(number), (times[frame], frequencies[frame]), **where)
    aside = 0.015 * float(np.ptp(times)) or 0.5
    axes.set(xlabel="edit time [s]", ylabel="first tone", xlim=(times.min() - aside, times.max() + aside))


def _tones(low: float, high: float, a4: float) -> dict[float, str]:
    """The tones between two frequencies [Hz], by their frequencies: their names with them."""
    found: dict[float, str] = {}
    first = int(np.ceil(12.0 * np.log2(low / a4)))
    last = int(np.floor(12.0 * np.log2(high / a4)))
    for step in range(first, last + 1):
        name, _ = note(a4 * 2.0 ** (step / 12.0), a4)
        if last - first <= SEMITONES or "#" not in name:
            frequency = frequency_of(name, a4)
            found[frequency] = f"{name}  {frequency:.1f} Hz"
    return found
