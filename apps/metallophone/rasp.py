"""The picture of what rasping the outline of a plate does to a tone."""

from pathlib import Path

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.tri import Triangulation

from restshape.outputs.picture_files import save_picture
from restshape.outputs.si_numbers import length_unit
from restshape.report.style import new_figure


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
    save_picture(figure, path)
