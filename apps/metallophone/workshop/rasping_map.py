"""The map on the sheet of a bar: what a tenth of a millimetre rasped off does to the first tone, place by place."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.ticker import MaxNLocator
from matplotlib.tri import Triangulation
from restshape_apps.metallophone.rasping.tolerances import CENTS, TENTH
from restshape_apps.metallophone.workshop.bar import Bar
from restshape_apps.metallophone.workshop.sheet_page import EDGE, SIZE, SMALL, SheetPage

from restshape.sensitivity.frequency_derivative import stands_alone
from restshape.sensitivity.outline_density import outline_density
from restshape.sensitivity.thickness_density import thickness_density

HIGH, WIDE = 56.0, 50.0
"""Height of the map, and width of its scales [mm]."""
CENTIMETRE = 1e-2
PAIR = "The first tone is one of a pair: what rasping does depends on where else one rasps."


def draw_map(page: SheetPage, bar: Bar, y: float) -> float:
    """Draw the map below a height [mm]; the height at which it ends."""
    analysis = bar.analysis
    page.text(EDGE, y, "Where a tenth of a millimetre is rasped off: cents of the first tone", weight="bold")
    if not stands_alone(analysis, int(analysis.state.modes.chosen[0])):
        page.text(EDGE, y - 6.0, PAIR, SMALL)
        return y - 14.0
    axes = page.inner((EDGE, y - HIGH + 10.0), (SIZE[0] - 2.0 * EDGE - WIDE - 10.0, HIGH - 14.0))
    axes.set_aspect("equal")
    axes.set_axis_off()
    if "z" in analysis.state.body.axes:
        _scale(page, _underneath(axes, bar), y - 14.0, "underneath, by each cm²")
    _scale(page, _outline(axes, bar), y - 32.0, "outline, by each cm")
    axes.autoscale_view()
    return y - HIGH


def _rate(bar: Bar) -> float:
    """Cents [1/Hz m] by a tenth of a millimetre that comes off, of a change of the first frequency."""
    return -CENTS * TENTH / float(bar.analysis.frequencies[0])


def _underneath(axes: Axes, bar: Bar) -> ScalarMappable:
    mesh, first = bar.analysis.state.space.mesh, int(bar.analysis.state.modes.chosen[0])
    values = _rate(bar) * CENTIMETRE**2 * thickness_density(bar.analysis, first).density
    size = float(np.percentile(np.abs(values), 98)) or 1.0
    triangles = Triangulation(*(1e3 * mesh.X).T, mesh.cells)
    look = {"shading": "gouraud", "cmap": "RdBu_r", "rasterized": True}
    return axes.tripcolor(triangles, values, clim=(-size, size), **look)


def _outline(axes: Axes, bar: Bar) -> ScalarMappable:
    mesh, found = bar.analysis.state.space.mesh, outline_density(bar.analysis, int(bar.analysis.state.modes.chosen[0]))
    density = np.full(len(mesh.X), np.nan)
    density[found.nodes] = found.density
    values = _rate(bar) * CENTIMETRE * np.nanmean(density[mesh.facets], axis=1)
    size = float(np.nanpercentile(np.abs(values), 95)) or 1.0
    lines = LineCollection(1e3 * mesh.X[mesh.facets], array=values, cmap="PuOr_r", clim=(-size, size), linewidths=4)
    axes.add_collection(lines)
    return lines


def _scale(page: SheetPage, drawn: ScalarMappable, y: float, text: str) -> None:
    """Draw the colours of what is drawn at the right, below their text at a height [mm]."""
    x = SIZE[0] - EDGE - WIDE - 2.0
    axes = page.inner((x, y - 6.0), (WIDE, 3.0))
    page.figure.colorbar(drawn, cax=axes, orientation="horizontal")
    axes.xaxis.set_major_locator(MaxNLocator(5))
    axes.xaxis.get_offset_text().set_fontsize(SMALL - 1.0)
    axes.tick_params(labelsize=SMALL - 1.0, length=2.0)
    page.text(x, y, text, SMALL)
