"""The picture of a rasping plan: what a tenth of a millimetre does, along the outline and underneath."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.tri import Triangulation
from restshape_apps.metallophone.rasping.densities import Densities
from restshape_apps.metallophone.rasping.plan import RaspingPlan
from restshape_apps.metallophone.rasping.tolerances import CENTS, TENTH

from restshape.analysis.modal import ModalAnalysis
from restshape.mesh.mesh import Mesh
from restshape.outputs.picture_files import save_picture
from restshape.report.style import new_figure
from restshape.sensitivity.outline_density import OutlineDensity, edge_densities

PER_CENTIMETRE = 1e-2
"""Of outline [m], that a tenth of a millimetre comes off; its square underneath."""
MARGIN = 0.13
"""Of the larger side of the bar, around it: depths are written there."""


def draw_plan(path: Path, analysis: ModalAnalysis, plan: RaspingPlan, tone: str) -> None:
    """Draw the maps, and the depths of the way that takes the least material at its places.

    Args:
        path: picture file.
        analysis: of the bar before rasping.
        plan: of it; tone: that it is to have.
    """
    X = 1e3 * analysis.state.space.mesh.X
    width, height = np.ptp(X, axis=0)
    figure = new_figure(8.5, 2.6 + 6.5 * min(1.2, height / width + 2.0 * MARGIN))
    axes = figure.subplots()
    draw_maps(figure, axes, analysis, plan.densities)
    _write_depths(axes, plan, X)
    axes.set_aspect("equal")
    beyond = MARGIN * max(width, height)
    axes.set_xlim(X[:, 0].min() - beyond, X[:, 0].max() + beyond)
    axes.set_ylim(X[:, 1].min() - beyond, X[:, 1].max() + beyond)
    axes.set_xlabel("x [mm]")
    axes.set_ylabel("y [mm]")
    axes.set_title(_title(plan, tone))
    save_picture(figure, path)


def draw_maps(figure: Figure, axes: Axes, analysis: ModalAnalysis, densities: Densities) -> None:
    """Draw in millimetres what 0.1 mm off does to the first tone: underneath, and as the colour of the outline."""
    rate = -CENTS * TENTH / float(analysis.frequencies[0])
    for thickness in densities.underneath[:1]:
        _draw_underneath(figure, axes, analysis.state.space.mesh, rate * PER_CENTIMETRE**2 * thickness.density)
    _draw_outline(figure, axes, analysis, densities.outline[0], rate * PER_CENTIMETRE)


def _draw_underneath(figure: Figure, axes: Axes, mesh: Mesh, values: np.ndarray) -> None:
    size = float(np.percentile(np.abs(values), 98))
    triangles = Triangulation(*(1e3 * mesh.X).T, mesh.cells)
    face = axes.tripcolor(triangles, values, shading="gouraud", cmap="RdBu_r", clim=(-size, size))
    label = "underneath: cents by 0.1 mm off each cm²"
    figure.colorbar(face, ax=axes, orientation="horizontal", aspect=50, label=label)


def _draw_outline(figure: Figure, axes: Axes, analysis: ModalAnalysis, found: OutlineDensity, rate: float) -> None:
    mesh, densities = analysis.state.space.mesh, edge_densities(analysis, found)
    segments, values = [], []
    for number, edge in enumerate(mesh.outline.edges):
        if edge.name in densities:
            facets = mesh.facets[mesh.facet_edge == number]
            of_node = dict(zip(np.unique(facets).tolist(), densities[edge.name].density.tolist()))
            segments += list(1e3 * mesh.X[facets])
            values += [0.5 * (of_node[a] + of_node[b]) for a, b in facets.tolist()]
    shown = rate * np.array(values)
    size = float(np.percentile(np.abs(shown), 95))
    lines = LineCollection(segments, array=shown, cmap="PuOr_r", clim=(-size, size), linewidths=7)
    axes.add_collection(lines)
    label = "outline: cents by 0.1 mm off each cm"
    figure.colorbar(lines, ax=axes, orientation="horizontal", aspect=50, label=label)


def _write_depths(axes: Axes, plan: RaspingPlan, X: np.ndarray) -> None:
    """Write the depths of the first way beside its places, out of the bar where they are on the outline."""
    way = plan.ways[0] if plan.ways else plan.nearest
    if way is None:
        return
    beyond = 0.6 * MARGIN * float(np.ptp(X, axis=0).max())
    for place, depth in zip(way.places, way.depths):
        at, out = place.mark * ((1e3,), (1.0,))
        box = {"boxstyle": "round,pad=0.2", "fc": "white", "ec": "black", "lw": 0.6}
        arrow = {"arrowstyle": "->", "lw": 0.8}
        text = f"{1e3 * depth:.2f} mm"
        axes.annotate(text, at, at + beyond * out, ha="center", va="center", fontsize=8, bbox=box, arrowprops=arrow)


def _title(plan: RaspingPlan, tone: str) -> str:
    first = f"{plan.wish.measured:.1f} Hz measured, {tone} is {plan.wish.target:.2f} Hz: {plan.wish.cents:+.0f} cents"
    if plan.in_tune:
        return f"{first}\nin tune: nothing to rasp"
    if not plan.ways:
        return f"{first}\nout of reach; depths are of the nearest" if plan.nearest else f"{first}\nout of reach"
    way = plan.ways[0]
    return f"{first}\n{way.name}: {1e9 * way.volume:.0f} mm³ off, {way.solved[0]:+.1f} cents by a solve"
