"""The picture of a rasping plan: what a tenth of a millimetre does, along the outline and underneath."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from restshape_apps.metallophone.rasping.maps import draw_maps
from restshape_apps.metallophone.rasping.places import Place
from restshape_apps.metallophone.rasping.plan import RaspingPlan
from restshape_apps.metallophone.rasping.report import out_of_reach

from restshape.analysis.modal.modal import ModalAnalysis
from restshape.outputs.picture_files import save_picture
from restshape.report.style import new_figure

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


def _write_depths(axes: Axes, plan: RaspingPlan, X: np.ndarray) -> None:
    """Write the depths of the first way beside its places, out of the bar."""
    way = plan.ways[0] if plan.ways else plan.nearest
    if way is None:
        return
    beyond = 0.6 * MARGIN * float(np.ptp(X, axis=0).max())
    for place, depth in zip(way.places, way.depths):
        at, out = place.mark * ((1e3,), (1.0,))
        rim = 0.0
        if place.underneath:
            out = _across(place)
            rim = -0.6 * beyond + float((X[place.off > 0.0] @ out).max() - at @ out)
        box = {"boxstyle": "round,pad=0.2", "fc": "white", "ec": "black", "lw": 0.6}
        arrow = {"arrowstyle": "->", "lw": 0.8}
        text = f"{1e3 * depth:.2f} mm"
        axes.annotate(
            text, at, at + (rim + beyond) * out, ha="center", va="center", fontsize=8, bbox=box, arrowprops=arrow
        )


def _across(place: Place) -> np.ndarray:
    """The direction (2,) across a strip, to its right."""
    along = place.ends[1] - place.ends[0]
    return np.array([along[1], -along[0]]) / np.linalg.norm(along) if along.any() else np.array([0.0, -1.0])


def _title(plan: RaspingPlan, tone: str) -> str:
    first = f"{plan.wish.measured:.1f} Hz measured, {tone} is {plan.wish.target:.2f} Hz: {plan.wish.cents:+.0f} cents"
    if plan.in_tune:
        return f"{first}\nin tune: nothing to rasp"
    if not plan.ways:
        return "\n".join([first, out_of_reach(plan, tone), *(["depths are of the nearest"] if plan.nearest else [])])
    way = plan.ways[0]
    return f"{first}\n{way.name}: {1e9 * way.volume:.0f} mm³ off, {way.solved[0]:+.1f} cents by a solve"
