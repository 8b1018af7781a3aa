"""What accuracy costs in furniture: ranges, their ends, searches, and what no accuracy settles."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from matplotlib.ticker import LogLocator, MaxNLocator, NullLocator, ScalarFormatter

from restshape.outputs.picture_files import save_picture
from restshape.report.style import FAINT, INK, REFUSED, new_figure

Rows = Sequence[Mapping[str, Any]]
FULL, BARE = "#0072b2", "#d55e00"
ABOVE = 0.35
"""Room above points for the legend, in parts of how far they spread."""


def draw_plank_precision(
    ranges: Rows, ends: Rows, searches: Rows, ratios: Rows, name: str, usual: int, path: Path
) -> None:
    """Writes the picture as a PNG, a panel a question.

    Args:
        ranges, ends, searches, ratios: rows of a study.
        name: of the scene.
        usual: samples of a range where nobody says otherwise.
        path: of the picture.
    """
    figure = new_figure(10.0, 7.4)
    (first, second), (third, fourth) = figure.subplots(2, 2)
    _ranges(first, ranges, usual)
    _ends(second, ends)
    _searches(third, searches)
    _ratios(fourth, ratios)
    for axes in (first, second, third, fourth):
        axes.grid(True, which="major", color="#e6e6e6", linewidth=0.6)
        axes.set_axisbelow(True)
        axes.title.set(fontsize=10, color=INK)
    figure.suptitle(f"{name}: what accuracy costs, one core", x=0.01, ha="left", color=INK)
    save_picture(figure, path)


def _ranges(axes: Any, rows: Rows, usual: int) -> None:
    """The part of a range that is reported wrongly, over its time; a point a number of samples."""
    axes.set_title("samples of a range (their number beside each point)")
    if not any(row["worst"] for row in rows):
        _nothing(axes, "nothing is wrong")
        return
    for hints, colour, label in ((True, FULL, "with ends that derivatives expect"), (False, BARE, "samples alone")):
        chosen = [row for row in rows if row["hints"] is hints]
        axes.plot([row["ms"] for row in chosen], [100.0 * row["worst"] for row in chosen], "o-", c=colour, label=label)
        for k, row in enumerate(chosen if hints else []):
            _number(axes, (row["ms"], 100.0 * row["worst"]), row["samples"], k, row["samples"] == usual)
    axes.set(xscale="log", yscale="log", xlabel="time of a range, median [ms]", ylabel="wrong, worst way [%]")
    axes.margins(0.18)
    low, high = axes.get_ylim()
    axes.set_ylim(low, high * (high / low) ** ABOVE)
    for axis in (axes.xaxis, axes.yaxis):
        _plain_ticks(axis)
    axes.legend(fontsize=8, loc="upper right")


def _plain_ticks(axis: Any) -> None:
    """Give a logarithmic axis over less than two decades round numbers, as people write them."""
    low, high = axis.get_view_interval()
    if high / low >= 100.0:
        return
    if high / low >= 10.0:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(lambda value, _: f"{value:g}")
    else:
        axis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        numbers = ScalarFormatter(useOffset=False, useMathText=True)
        numbers.set_powerlimits((-3, 4))
        axis.set_major_formatter(numbers)
    axis.set_minor_locator(NullLocator())


def _nothing(axes: Any, words: str) -> None:
    """Says in an empty panel why it is empty."""
    axes.text(0.5, 0.5, words, ha="center", transform=axes.transAxes)


def _number(axes: Any, place: tuple[float, float], number: int, k: int, bold: bool = False) -> None:
    """Writes a number beside the k-th point of a line, above and below by turns."""
    away, weight = (8 if k % 2 else -15), ("bold" if bold else "normal")
    axes.annotate(str(number), place, (0, away), textcoords="offset points", ha="center", fontsize=8, weight=weight)


def _ends(axes: Any, rows: Rows) -> None:
    """How far ends are from where they are, over the tolerance, and the time that a range takes."""
    axes.set_title("ends of a range")
    tolerances = [row["tolerance"] for row in rows]
    if not any(row["worst"] for row in rows):
        _nothing(axes, "no range has an end")
        return
    axes.plot(tolerances, [row["worst"] for row in rows], "o-", c=FULL)
    axes.plot(tolerances, tolerances, "--", c=FAINT, lw=1)
    axes.set(xscale="log", yscale="log", xlabel="tolerance, in parts of the way", ylabel="error of an end, worst")
    axes.yaxis.label.set_color(FULL)
    times = axes.twinx()
    times.plot(tolerances, [row["ms"] for row in rows], "s-", c=BARE, ms=4)
    times.set_ylabel("time of a range, median [ms]", color=BARE)
    times.set_ylim(0.0, 1.6 * max(row["ms"] for row in rows))


def _searches(axes: Any, rows: Rows) -> None:
    """Suggestions that are found, over the time of the search; a point a limit of what is tested."""
    axes.set_title("search of suggestions (combinations tested beside each point)")
    if not rows:
        _nothing(axes, "no piece asks for any")
        return
    usual, *efforts = rows
    axes.plot([row["ms"] for row in efforts], [row["found"] for row in efforts], "o-", c=FULL)
    axes.plot([usual["ms"]], [usual["found"]], "D", c=INK, label="as it is")
    for k, row in enumerate(efforts):
        _number(axes, (row["ms"], row["found"]), row["tested"], k)
    axes.set(xscale="log", xlabel="time of a search [ms]", ylabel="suggestions found")
    axes.set_ylim(0.0, 1.15 * max(row["all"] for row in rows))
    axes.margins(x=0.3)
    _plain_ticks(axes.xaxis)
    axes.legend(fontsize=8, loc="lower right")


def _ratios(axes: Any, rows: Rows) -> None:
    """The largest utilisation over the ratio of compliances, and how far that of any joint goes from the usual."""
    ratios = [row["ratio"] for row in rows]
    axes.plot(ratios, [row["utilisation"] for row in rows], "o-", c=FULL, label="largest utilisation of a joint")
    axes.plot(ratios, [row["worst"] for row in rows], "s--", c=BARE, ms=4, label="largest change of a joint's use")
    axes.axhline(1.0, c=REFUSED, lw=1)
    axes.axvline(1.0, c=FAINT, lw=1)
    axes.set(xscale="log", xlabel="compliance in rotation, of the usual one", ylabel="use, in parts of the strength")
    axes.set_ylim(bottom=0.0)
    axes.set_title("a choice of the model: no accuracy settles it")
    axes.legend(fontsize=8)
