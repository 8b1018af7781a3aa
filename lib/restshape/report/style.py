"""How pictures look: colours that colour-blind readers can distinguish, numbers with SI prefixes."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

import matplotlib

matplotlib.use("Agg")
from matplotlib.figure import Figure

from restshape.replay.level_names import MOVES

DPI = 150
COLOURS, SIGNED = "viridis", "RdBu_r"
INK, FAINT, REFUSED = "#222222", "#9a9a9a", "#c0392b"
GOAL, RESTLESS = "#d62728", "#e69f00"
UNTRUSTED = "#b8560f"
"""Words of what is not to be trusted: an orange that is dark enough to be read on white."""
MARK = "#ff00aa"
BODY, MESH = "#c9d3dc", "#ffffff"
VALUES = -1
"""Stands for level 0 where values were changed and the system was solved."""
SOLVED = -3
"""Stands for level 0 where the system was solved without an edit, as in time."""
LEVELS = {0: "#b5b5b5", SOLVED: "#56b4e9", VALUES: "#009e73", 1: "#0072b2", 2: "#e69f00", 3: "#d55e00"}
LEVEL_MARKS = {0: "o", SOLVED: "o", VALUES: "D", 1: "o", 2: "^", 3: "s"}
LEVEL_LABELS = {
    0: "idle",
    SOLVED: "solved",
    VALUES: "values changed",
    **{level: f"level {level}, {move}" for level, move in MOVES.items()},
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
    "text.parse_math": False,
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
    matplotlib.rcParams.update(_SETTINGS | dict.fromkeys(("figure.dpi", "savefig.dpi"), _RESOLUTION.get()))
    return Figure(figsize=(width, height), layout="constrained")
