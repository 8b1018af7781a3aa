"""Pictures of modes with their nodal lines, and of what moving the outline does to a tone."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.tri import Triangulation

from restshape.report.style import INK, length_unit, new_figure

ACROSS = 3
"""Most pictures side by side."""


def draw_modes(
    path: Path,
    X: np.ndarray,
    triangles: np.ndarray,
    shapes: np.ndarray,
    names: Sequence[str],
    title: str,
    bend: float = 0.0,
) -> None:
    """Draw the deflection of each mode in colour and, in black, the lines where it is still.

    Modes that move in the plane are drawn by the size of their motion.

    Args:
        path: picture file.
        X: (n, 2) nodes [m]; triangles: (ne, 3) corners.
        shapes: (k, n, 3) displacements of the nodes.
        names: (k,) captions; title: of the whole.
        bend: displacement [m] of the largest motion in the plane with which bodies are drawn; 0: as they rest.
    """
    across = min(ACROSS, len(shapes))
    down = -(-len(shapes) // across)
    width, height = np.ptp(X, axis=0)
    factor, unit = length_unit(float(max(width, height)))
    each = 10.0 / across
    figure = new_figure(10.0, 0.5 + down * (0.75 + each * min(1.4, height / width)))
    grid = np.atleast_1d(figure.subplots(down, across)).ravel()
    for axes, shape, name in zip(grid, shapes, names):
        normal = np.abs(shape[:, 2]).max() > 0.0
        values = shape[:, 2] if normal else np.hypot(shape[:, 0], shape[:, 1])
        largest = np.abs(values).max()
        colours, low = ("RdBu_r", -largest) if normal else ("viridis", 0.0)
        triangulation = Triangulation(*(factor * (X + bend / largest * shape[:, :2])).T, triangles)
        axes.tripcolor(triangulation, values, shading="gouraud", cmap=colours, vmin=low, vmax=largest)
        if normal:
            axes.tricontour(triangulation, values, levels=[0.0], colors=INK, linewidths=1.2)
        axes.set_title(name)
        axes.set_aspect("equal")
        axes.set_xlabel(f"x [{unit}]")
        axes.set_ylabel(f"y [{unit}]")
    for axes in grid[len(shapes) :]:
        axes.set_visible(False)
    figure.suptitle(title)
    figure.savefig(path)


def draw_outline_density(
    path: Path, X: np.ndarray, triangles: np.ndarray, facets: np.ndarray, density: np.ndarray, title: str
) -> None:
    """Draw the outline in the colour of a density on it: red where taking material away raises the tone.

    Args:
        path: picture file.
        X: (n, 2) nodes [m]; triangles: (ne, 3) corners; facets: (nf, 2) ends of the outline's pieces.
        density: (n,) change of the frequency a unit of area that is added there [Hz/m^2].
        title: of the picture.
    """
    width, height = np.ptp(X, axis=0)
    factor, unit = length_unit(float(max(width, height)))
    # Beside a flat body the scale would be shorter than its label.
    flat = height < 0.5 * width
    figure = new_figure(8.0, (1.9 if flat else 1.6) + 7.0 * min(1.4, height / width))
    axes = figure.subplots()
    axes.triplot(Triangulation(*(factor * X).T, triangles), color="#dddddd", lw=0.4)
    # Corners have no normal, and sharp ones outshine all else.
    values = -1e-6 * np.nanmean(density[facets], axis=1)
    size = np.nanpercentile(np.abs(values), 95)
    lines = LineCollection(factor * X[facets], array=values, cmap="RdBu_r", clim=(-size, size), linewidths=5)
    axes.add_collection(lines)
    axes.set_aspect("equal")
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
    way = {"orientation": "horizontal", "aspect": 40} if flat else {"shrink": 0.8}
    figure.colorbar(lines, ax=axes, label="change of the tone by what is rasped off [Hz/mm²]", **way)
    axes.set_title(title)
    figure.savefig(path)
