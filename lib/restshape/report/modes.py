"""Pictures of modes with their nodal lines."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.tri import Triangulation

from restshape.analysis.modal.nodal_lines import linear_triangles
from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import length_unit
from restshape.report.fitted_title import fitted
from restshape.report.outlines import border, chains
from restshape.report.style import COLOURS, INK, SIGNED, new_figure

ACROSS, WIDTH = 3, 10.8
"""Most pictures side by side, and width of the figure [inch]."""
LABELLED, BAR = 3.9, 0.6
"""Height of a figure with room for the label of a bar beside its pictures, and of a bar below them [inch]."""


def draw_modes(
    path: Path,
    X: np.ndarray,
    cells: np.ndarray,
    shapes: np.ndarray,
    names: Sequence[str],
    title: str,
    bend: float = 0.0,
    marks: np.ndarray | None = None,
) -> None:
    """Draw the deflection of each mode in colour and, in black, the lines where it is still.

    Modes that move in the plane are drawn by the size of their motion; bent ones over the outline at rest, dashed. The
    amplitude of a mode is arbitrary: colours go to its largest deflection.

    Args:
        path: picture file.
        X: (n, 2) nodes [m]; cells: (ne, 3) or (ne, 6) nodes of triangles of first or second order.
        shapes: (k, n, 3) displacements of the nodes.
        names: (k,) captions; title: of the whole; its first line is cut where it is too long.
        bend: displacement [m] of the largest motion in the plane with which bodies are drawn; 0: as they rest.
        marks: (m, 2) [m] places marked by rings in each picture, such as those at which a plate is hung.
    """
    triangles = linear_triangles(cells)
    across = min(ACROSS, len(shapes))
    down = -(-len(shapes) // across)
    width, height = np.ptp(X, axis=0)
    factor, unit = length_unit(float(max(width, height)))
    each = 10.0 / across
    kinds = {_bent(shape) for shape in shapes}
    high = 0.5 + down * (0.75 + each * min(1.4, height / width))
    # The label of a bar is as long as a bar beside high pictures is; bars of low ones lie below.
    beside = high >= LABELLED
    figure = new_figure(WIDTH, high if beside else high + BAR * len(kinds))
    drawn: dict[bool, ScalarMappable] = {}
    grid = np.atleast_1d(figure.subplots(down, across)).ravel()
    rest = chains(factor * X, border(cells)) if bend else ()
    for axes, shape, name in zip(grid, shapes, names):
        normal = _bent(shape)
        drawn[normal] = _draw_mode(axes, factor * X, factor * bend, triangles, shape)
        axes.add_collection(LineCollection(rest, colors=INK, linewidths=0.7, linestyles="--"))
        if marks is not None:
            axes.plot(*(factor * marks).T, "o", ms=7, mfc="white", mec=INK, mew=1.4)
        # Beside modes out of the plane, those in it are named: other colours alone would say that to few.
        named = f"{name}, in the plane" if not normal and len(kinds) > 1 else name
        axes.set(title=named, aspect="equal", xlabel=f"x [{unit}]", ylabel=f"y [{unit}]")
    for normal, picture in drawn.items():
        way = {"fraction": 0.05, "aspect": 30} if beside else {"location": "bottom", "shrink": 0.5, "aspect": 40}
        bar = figure.colorbar(picture, ax=list(grid), **way)
        bar.set_label(f"{'deflection' if normal else 'size of the motion'} / its largest, amplitude arbitrary")
        bar.outline.set_visible(False)
    for axes in grid[len(shapes) :]:
        axes.set_visible(False)
    name, *lines = title.split("\n")
    lines += ["dashed: shape at rest"] if bend else []
    figure.suptitle("\n".join([fitted(name, WIDTH), *lines]))
    save_picture(figure, path)


def _bent(shape: np.ndarray) -> bool:
    """Whether a mode (n, 3) moves out of the plane more than in it."""
    return bool(np.linalg.norm(shape[:, 2]) > np.linalg.norm(shape[:, :2]))


def _draw_mode(axes: Axes, X: np.ndarray, bend: float, triangles: np.ndarray, shape: np.ndarray) -> ScalarMappable:
    """Draw one mode (n, 3) in colour, and its nodal lines where it moves out of the plane.

    Args:
        axes: of the mode; X: (n, 2) nodes, and `bend` as of `draw_modes`, in the unit of the axes.
        triangles: (m, 3) nodes; shape: displacements of the nodes.
    """
    normal = _bent(shape)
    values = shape[:, 2] if normal else np.hypot(shape[:, 0], shape[:, 1])
    largest = np.abs(values).max()
    look = {"cmap": SIGNED, "vmin": -1.0, "vmax": 1.0} if normal else {"cmap": COLOURS, "vmin": 0.0, "vmax": 1.0}
    triangulation = Triangulation(*(X + bend / largest * shape[:, :2]).T, triangles)
    picture = axes.tripcolor(triangulation, values / largest, shading="gouraud", **look)
    if normal:
        axes.tricontour(triangulation, values, levels=[0.0], colors=INK, linewidths=1.2)
    return picture
