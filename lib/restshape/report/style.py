"""How pictures look: colours that colour-blind readers can distinguish, numbers with SI prefixes."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from math import floor, isfinite, log10

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

DPI = 150
COLOURS, SIGNED = "viridis", "RdBu_r"
INK, FAINT, REFUSED = "#222222", "#9a9a9a", "#c0392b"
GOAL, RESTLESS = "#d62728", "#e69f00"
MARK = "#ff00aa"
BODY, MESH = "#c9d3dc", "#ffffff"
VALUES = -1
"""Stands for level 0 where values were changed and the system was solved."""
LEVELS = {0: "#b5b5b5", VALUES: "#009e73", 1: "#0072b2", 2: "#e69f00", 3: "#d55e00"}
LEVEL_MARKS = {0: "o", VALUES: "D", 1: "o", 2: "^", 3: "s"}
LEVEL_NAMES = {
    0: "idle",
    VALUES: "values changed",
    1: "level 1, relocated",
    2: "level 2, reconnected",
    3: "level 3, rebuilt",
}
STAGES = {
    "edit": "#332288",
    "relocate": "#88ccee",
    "map": "#44aa99",
    "flip": "#117733",
    "mesh": "#999933",
    "pattern": "#ddcc77",
    "values": "#cc6677",
    "factor": "#882255",
    "krylov": "#aa4499",
    "observe": "#6699cc",
    "other": "#dddddd",
}
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T"}
_SETTINGS = {
    "font.size": 9,
    "axes.titlesize": 9,
    "figure.titlesize": 11,
    "axes.edgecolor": "#666666",
    "axes.labelcolor": INK,
    "text.color": INK,
    "xtick.color": "#444444",
    "ytick.color": "#444444",
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "svg.hashsalt": "restshape",
}


_RESOLUTION = ContextVar("resolution", default=DPI)


@contextmanager
def resolution(dpi: int) -> Iterator[None]:
    """Has figures that are made inside it so many pixels an inch."""
    before = _RESOLUTION.set(dpi)
    try:
        yield
    finally:
        _RESOLUTION.reset(before)


def new_figure(width: float, height: float) -> Figure:
    """An empty figure in the house's style.

    Args:
        width, height: inches.
    """
    plt.rcParams.update(_SETTINGS | dict.fromkeys(("figure.dpi", "savefig.dpi"), _RESOLUTION.get()))
    return Figure(figsize=(width, height), layout="constrained")


def prefix(size: float) -> tuple[float, str]:
    """The factor and SI prefix that bring a number of this size between 1 and 1000."""
    if not isfinite(size) or size == 0:
        return 1.0, ""
    power = min(max(3 * floor(log10(abs(float(f"{size:.5g}"))) / 3 + 1e-12), -12), 12)
    return 10.0**-power, _PREFIXES[power]


def scaled_unit(size: float, unit: str) -> tuple[float, str]:
    """The factor and unit in which such a number reads well, such as 1e-6 and "MPa"; m² and kg stay as they are."""
    if not unit or unit in ("1", "m²", "kg"):
        return 1.0, unit
    factor, letter = prefix(size)
    return factor, letter + unit


def length_unit(size: float) -> tuple[float, str]:
    """The factor and unit for axes of a part of this size [m]."""
    return (1.0, "m") if size >= 1 else (1e3, "mm") if size >= 1e-3 else (1e6, "µm")


def si(value: float, unit: str = "", digits: int = 3, like: float | None = None) -> str:
    """A number with its unit, e.g. ``si(2.1e-4, "m") == "210 µm"``; the prefix is that of ``like``, if given."""
    if not isfinite(value):
        return "–"
    factor, shown = scaled_unit(value if like is None else like, unit)
    text = f"{value * factor:.{digits}g}"
    if "e" in text and 1 <= abs(value * factor) < 1e5:
        text = f"{value * factor:.0f}"
    return f"{text} {shown}".rstrip()
