"""The picture of a design session: score and status against edit time, for two ways of running the analysis."""

from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

import numpy as np
from matplotlib.axes import Axes

from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import scaled_unit
from restshape.report.style import FAINT, INK, LEVELS, REFUSED, UNTRUSTED, new_figure

COLOURS = (LEVELS[1], LEVELS[2])
PLAIN = ("every frame", "on demand")


class SessionCourse(Protocol):
    """What one way reports, by frames (n,): edit time [s], area [m^2], stress [Pa], statuses, best area so far
    [m^2]."""

    t: np.ndarray
    score: np.ndarray
    stress: np.ndarray
    holds: np.ndarray
    uncertain: np.ndarray
    fails: np.ndarray
    best: np.ndarray


def draw_score(path: Path, ways: Mapping[str, SessionCourse], limit: float) -> None:
    """Draw the area above, and the stress against its limit below, both against edit time.

    Args:
        path: picture file.
        ways: "every frame" and "on demand", of the same edits.
        limit: of the stress [Pa].
    """
    figure = new_figure(8.0, 7.2)
    top, bottom = figure.subplots(2, 1, sharex=True, height_ratios=(3, 2))
    always, asked = (ways[name] for name in PLAIN)
    moments = _moments(asked)
    _draw_areas(top, always, asked, moments)
    factor, unit = scaled_unit(limit, "Pa")
    bottom.plot(always.t, factor * always.stress, color=COLOURS[0], lw=1.2)
    _mark(bottom, asked, moments, factor * asked.stress)
    highest = 1.12 * factor * max(limit, float(np.nanmax(always.stress)))
    bottom.axhline(factor * limit, color=REFUSED, lw=1, ls="--")
    bottom.text(0.0, factor * limit * 1.01, f"limit {factor * limit:g} {unit}", color=REFUSED, va="bottom")
    bottom.set(xlabel="edit time [s]", ylabel=f"largest von Mises stress [{unit}]", ylim=(0.0, highest))
    for axes in (top, bottom):
        axes.grid(alpha=0.25)
    figure.legend(loc="outside lower center", ncols=2)
    figure.suptitle(
        "The same edits of a bridge, analysed in every frame or on demand\n"
        "illustration with one scripted designer, after figure 4.14 of the thesis; no user study"
    )
    save_picture(figure, path)


def _draw_areas(axes: Axes, always: SessionCourse, asked: SessionCourse, moments: np.ndarray) -> None:
    """The area of the design, where it fails, and the smallest area that each way knows to hold."""
    axes.plot(always.t, always.score, color=FAINT, lw=1, label="area of the design")
    for frames, colour, what in (
        (always.fails, REFUSED, "fails"),
        (always.uncertain, UNTRUSTED, "is uncertain"),
    ):
        there = np.where(frames, always.score, np.nan)
        axes.plot(always.t, there, color=colour, lw=3, alpha=0.6, label=f"the design {what}, seen in every frame")
    for way, colour, name in zip((always, asked), COLOURS, PLAIN, strict=True):
        best = np.where(np.isfinite(way.best), way.best, np.nan)
        label = f"smallest known to hold, {name}: {best[-1]:.2f} m²"
        axes.step(way.t, best, where="post", color=colour, lw=1.8, label=label)
    _mark(axes, asked, moments, asked.score, labelled=True)
    axes.set_ylabel("score: area [m²], less is better")


def _moments(asked: SessionCourse) -> np.ndarray:
    """Frames in which a status appears: the analyses."""
    known = asked.holds | asked.uncertain | asked.fails
    return np.flatnonzero(known & ~np.concatenate([[False], known[:-1]]))


def _mark(axes: Axes, asked: SessionCourse, moments: np.ndarray, values: np.ndarray, labelled: bool = False) -> None:
    """Marks the analyses on demand: rings where the design holds, crosses where it fails, diamonds between."""
    looks = (
        ("holds", asked.holds, "o", INK, "none", 8),
        ("uncertain", asked.uncertain, "D", UNTRUSTED, "none", 7),
        ("fails", asked.fails, "x", REFUSED, None, 9),
    )
    for what, frames, marker, colour, face, size in looks:
        there = moments[frames[moments]]
        label = f"analysed on demand, {what}" if labelled else None
        axes.plot(asked.t[there], values[there], marker, mfc=face, mec=colour, ms=size, mew=1.5, ls="", label=label)
