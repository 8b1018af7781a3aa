"""The picture of a sweep: each quantity over the values, with limits and the runs that have none."""

# More than 15 modules: a panel shows a quantity of all runs with all that is known of them.

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from textwrap import fill, shorten

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes

from restshape.application import application_of
from restshape.arrays import Reals
from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import counted, scaled_unit
from restshape.replay.constraints import MAX, MIN
from restshape.replay.rounding import without_rounding
from restshape.replay.singular_notes import marked
from restshape.report.quantity_panels import EACH, FRAMED, MOST, draw_limits, least_span
from restshape.report.recorded_quantities import kind_units
from restshape.report.style import COLOURS, INK, REFUSED, new_figure
from restshape.scene.given_numbers import unit_at
from restshape.scene.model import Scene
from restshape.scene.plain_values import table_in
from restshape.scene.source import split_key
from restshape.scene.units import SYMBOLS
from restshape.variation.swept_key import SweptKey, combinations
from restshape.variation.swept_run import SweptRun, run_scales

LINES = 12
"""Lines of a panel that the legend names."""
LABEL = 18
"""Letters of a value on the axis, where values are no numbers."""


def draw_sweep(
    scene: Scene,
    swept: Sequence[SweptKey],
    runs: Sequence[SweptRun],
    path: Path,
    several: bool,
    singular: Mapping[str, float],
    notes: Sequence[str] = (),
) -> None:
    """Writes the picture, in the format that the path's suffix names.

    The last key that is swept goes along the axis; each combination of the others is a line.

    Args:
        scene: of one of the runs.
        swept: the keys, and their values.
        runs: in the order of `combinations`; the last ones may be missing.
        path: of the picture.
        several: runs have several frames: the values between least and largest are shaded.
        singular: quantities at singular places, whose panels are marked.
        notes: lines that stand under the axis.

    Raises:
        UserError: a file is there that restshape has not drawn.
        OSError: it cannot be written.
    """
    columns = [*dict.fromkeys(name for one in runs for name in one.quantities)]
    limits = {column: known for column in columns if (known := _limits(runs, column.removeprefix("q_")))}
    sizes = run_scales(scene, runs)
    columns.sort(key=lambda column: column not in limits)
    shown = columns[:MOST]
    figure = new_figure(8.0, FRAMED + EACH * 1.3 * max(len(shown), 1))
    panels = figure.subplots(max(len(shown), 1), 1, sharex=True, squeeze=False)[:, 0]
    for axes, column in zip(panels, shown):
        name = column.removeprefix("q_")
        _panel(axes, swept, runs, column, limits.get(column, {}), _unit(scene, name), several, sizes[column])
        axes.set_title(marked(name, singular), loc="left", pad=2)
    _name_axis(panels[-1], swept[-1], key_unit(scene, swept[-1]), notes)
    title = _title(scene, runs, len(columns))
    figure.suptitle(shorten(title, 95, placeholder=" …"), x=0.01, ha="left", color=INK)
    keys = shorten(", ".join(one.key for one in swept[:-1]), 90, placeholder="…")
    beyond = any(np.isfinite(_beyond(one, column)) for one in runs for column in shown)
    tied = any(len(_lines(one, len(swept[-1].values))) > 1 for known in limits.values() for one in known.values())
    limited = "limit, in the colour of its line" if tied else "limit" if limits else ""
    _legend(panels[0], keys, limited, beyond, not all(one.frames for one in runs), several)
    figure.align_ylabels()
    save_picture(figure, path)


def _title(scene: Scene, runs: Sequence[SweptRun], columns: int) -> str:
    """The scene, how many runs there are, and how many runs and columns the picture does not show."""
    words = [scene.title or scene.path.stem, counted(len(runs), "run")]
    failed = sum(not one.frames for one in runs)
    words += [f"{failed} without a result"] * bool(failed)
    words += [f"quantities not shown: {columns - MOST}"] * (columns > MOST)
    return ", ".join(words)


def _limits(runs: Sequence[SweptRun], name: str) -> dict[str, Reals]:
    """The limits (n,) of a quantity in each run, those alone that there are; not numbers in runs that are not valid."""
    own = [one.limits.get(name, {}) for one in runs]
    return {
        key: np.array([one.get(key, np.nan) for one in own]) for key in (MIN, MAX) if any(key in one for one in own)
    }


def _unit(scene: Scene, name: str) -> str:
    """The SI unit of a quantity of the scene; empty of a column that an application has by itself."""
    units, given = kind_units(), table_in(table_in(scene.raw, "quantities"), name)
    return next((units[key] for key in given if key in units), "") if name in scene.quantities else ""


def key_unit(scene: Scene, swept: SweptKey) -> str:
    """The unit of the numbers of a key: as it was written, else the SI unit, in which plain numbers are."""
    if swept.unit or not swept.numbers:
        return swept.unit
    app, key = application_of(scene), split_key(swept.key)
    match key:
        case ("effects", name, *rest) if name in app.effects:
            found = unit_at(app.effects[name].model.model_validate(scene.effects.get(name, {})), tuple(rest))
        case ("supports", _, "fix", axis):
            dimensions = {axis: dimension for one in app.physics for axis, dimension in one.boundary.items()}
            found = SYMBOLS.get(dimensions.get(axis, ""), "")
        case _:
            found = unit_at(scene, key)
    return found.replace("^2", "²").replace("^3", "³")


def _name_axis(axes: Axes, along: SweptKey, unit: str, notes: Sequence[str]) -> None:
    """The key along the axis and its unit, with notes under them; values that are no numbers beside their places."""
    label = f"{along.key} [{unit}]" if unit else along.key
    axes.set_xlabel("\n".join([label, *(fill(note, 110) for note in notes)]))
    if not along.numbers:
        labels = [shorten(value.strip('"'), LABEL, placeholder="…") for value in along.values]
        axes.set_xticks(range(len(labels)), labels)


def _panel(
    axes: Axes,
    swept: Sequence[SweptKey],
    runs: Sequence[SweptRun],
    column: str,
    limit: Mapping[str, Reals],
    unit: str,
    several: bool,
    size: float,
) -> None:
    """One quantity: a line for each combination of the keys but the last, marks where there is no value."""
    values = without_rounding(np.array([_extent(one, column) for one in runs]).reshape(-1, 3), size)
    known = values[np.isfinite(values)]
    factor, text = scaled_unit(float(np.abs(known).max(initial=0.0)), unit)
    count, lines = len(swept[-1].values), -(-len(runs) // len(swept[-1].values))
    places, x = list(combinations(swept)), np.array(swept[-1].numbers or range(count))
    _grid(axes, text)
    colours = [INK if lines == 1 else colormaps[COLOURS](0.9 * line / (lines - 1)) for line in range(lines)]
    for line, colour in enumerate(colours):
        part = slice(line * count, (line + 1) * count)
        own = values[part] * factor
        at, name = x[: len(own)], _line_name(swept, places[line * count]) if lines <= LINES else None
        axes.plot(at, own[:, 0], color=colour, lw=1.1, marker="o", ms=3, zorder=3, label=name or None)
        if several:
            axes.fill_between(at, own[:, 1], own[:, 2], color=colour, alpha=0.15, linewidth=0, zorder=1)
        beyond = factor * np.array([_beyond(one, column) for one in runs[part]])
        axes.plot(at, beyond, ls="", marker="x", color=REFUSED, ms=6, zorder=4)
    for place in {places[one.index][-1] for one, value in zip(runs, values) if not np.isfinite(value[0])}:
        axes.axvline(x[place], color=REFUSED, alpha=0.35, lw=2.0, zorder=0)
    if len(known):
        low, high = float(known.min()), float(known.max())
        least_span(axes, factor * low, factor * high)
        order, rows = np.argsort(x), {key: _lines(one, count)[:, np.argsort(x)] for key, one in limit.items()}
        draw_limits(axes, factor, low, high, rows, text, x[order], colours if lines > 1 else ())


def _grid(axes: Axes, unit: str) -> None:
    """The unit of a panel, lines across it and a margin."""
    axes.set_ylabel(f"[{unit}]" if unit else "")
    axes.grid(True, axis="y", color="#e6e6e6", linewidth=0.6)
    axes.set_axisbelow(True)
    axes.margins(y=0.12)
    axes.ticklabel_format(axis="y", useOffset=False)


def _lines(values: Reals, count: int) -> Reals:
    """Values (n,) of runs as (lines, count), one row where all are the same; not numbers where runs are missing."""
    rows = np.append(values, np.full(-len(values) % count, np.nan)).reshape(-1, count)
    same = all(np.array_equal(row, rows[0], equal_nan=True) for row in rows)
    return rows[:1] if same else rows


def _extent(run: SweptRun, column: str) -> tuple[float, float, float]:
    """The value at the end of a run, the least and the largest one; not numbers without a result."""
    found = run.quantities.get(column)
    return (found.last, found.least, found.most) if found else (np.nan, np.nan, np.nan)


def _beyond(run: SweptRun, column: str) -> float:
    """The value of a run that is farthest beyond its limit; not a number where none is."""
    return run.quantities[column].beyond if column in run.quantities else np.nan


def _line_name(swept: Sequence[SweptKey], places: Sequence[int]) -> str:
    """The values of all keys but the last."""
    words = [one.values[place].replace('"', "") for one, place in zip(swept[:-1], places)]
    return shorten(", ".join(words), 2 * LABEL, placeholder="…")


def _legend(axes: Axes, keys: str, limited: str, beyond: bool, failed: bool, several: bool) -> None:
    """The legend below all panels: of the lines, whose keys are its title, and of what occurs."""
    if limited:
        axes.plot([], [], color=REFUSED if limited == "limit" else INK, lw=1.0, ls="--", label=limited)
    if beyond:
        axes.plot([], [], ls="", marker="x", color=REFUSED, ms=6, label="beyond its limit")
    if several:
        axes.fill_between([], [], [], color=INK, alpha=0.15, label="least to largest over the edit")
    if failed:
        axes.plot([], [], color=REFUSED, alpha=0.35, lw=2.0, label="no result")
    handles, names = axes.get_legend_handles_labels()
    if names:
        axes.figure.legend(handles, names, loc="outside lower center", ncols=min(len(names), 4), title=keys or None)
