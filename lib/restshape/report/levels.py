"""Time a level, stacked by stage: the thesis's figure 4.2 for any recording."""

from math import ceil
from pathlib import Path
from textwrap import shorten

import numpy as np

from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import counted, three_digits
from restshape.replay.recording.recording import Recording
from restshape.report.frames import scene_name
from restshape.report.stacked_panels import stack_panels
from restshape.report.style import FAINT, INK, LEVEL_LABELS, STAGES, new_figure
from restshape.report.tables import column, level_table

COLUMNS = 6
"""Of the legend."""


def stage_shares(recording: Recording, level: int) -> dict[str, float]:
    """Share of each stage, and of "other", in the time of a level's frames (the first frame left out); sums to 1."""
    chosen = (column(recording, "level") == level) & (np.arange(recording.n) > 0)
    total = float(np.nansum(column(recording, "ms")[chosen]))
    stages = {name: float(np.nansum(column(recording, f"ms_{name}")[chosen])) for name in STAGES if name != "other"}
    whole = max(total, sum(stages.values()))
    if whole <= 0:
        return {"other": 1.0}
    stages["other"] = whole - sum(stages.values())
    return {name: value / whole for name, value in stages.items()}


def draw_levels(recording: Recording, path: Path) -> None:
    """Writes the picture as a PNG: a bar a level, as long as its median, with a whisker to the 95th percentile."""
    figure = new_figure(9.0, 3.9)
    axes = figure.subplots()
    rows = [row for row in level_table(recording) if row["level"] in ("1", "2", "3")]
    shown = [row for row in rows if row["frames"] and row["p50"] is not None]
    drawn: dict[str, object] = {}
    longest = max((row["p95"] for row in shown), default=1.0) or 1.0
    for row in shown:
        place, start = int(row["level"]), 0.0
        for name, share in stage_shares(recording, place).items():
            length = share * row["p50"]
            bar = axes.barh(place, length, left=start, height=0.56, color=STAGES[name], linewidth=0)
            if share >= 0.01:
                drawn.setdefault(name, bar)
            start += length
        axes.plot([row["p50"], row["p95"]], [place, place], color=INK, linewidth=1.2, marker="|", markersize=7)
        times = ", ".join(f"{name} {three_digits(row[name])} ms" for name in ("p50", "p95"))
        text = f"{times}   ({counted(row['frames'], 'frame')})"
        axes.text(row["p95"] + 0.012 * longest, place, text, va="center", color=INK)
    for row in rows:
        if row not in shown:
            axes.text(0.012 * longest, int(row["level"]), "no frames", va="center", color=FAINT, style="italic")
    axes.set(yticks=(1, 2, 3), yticklabels=[LEVEL_LABELS[k] for k in (1, 2, 3)], ylim=(3.6, 0.4))
    axes.set(xlim=(0, 1.65 * longest), xlabel="time a frame [ms]")
    name = shorten(scene_name(recording), 70, placeholder=" …")
    figure.suptitle(f"{name}: time a level, stages by their share of it", x=0.01, ha="left", color=INK)
    if drawn:
        order = [name for name in STAGES if name in drawn]
        figure.legend([drawn[name] for name in order], order, loc="lower center", ncols=COLUMNS)
    stack_panels(figure, [axes], [1], [0.0], ceil(len(drawn) / COLUMNS))
    save_picture(figure, path)
