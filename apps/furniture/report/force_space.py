"""Pictures of force space: where forces are allowed, how design modes move them, and where a design is valid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from restshape.report.style import FAINT, INK, REFUSED

VALID, WEAK, FALLS, LOST = "#9ecae1", "#fdd9b5", "#d9c2e3", "#ededed"
RAYS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
LINEARISED = "#111111"


@dataclass(frozen=True)
class Ray:
    """A way through force space.

    Args:
        name: what is edited.
        linear: (k, 2) forces as the derivative at the start has them.
        true: (k, 2) forces that the full model finds; nan where there are none.
        valid: (k,) the full test holds there.
    """

    name: str
    linear: np.ndarray
    true: np.ndarray
    valid: np.ndarray


@dataclass(frozen=True)
class Region:
    """What the full test and the linearised one say over two design parameters.

    Args:
        x, y: (m,), (n,) the parameters.
        x_name, y_name: what they are, with units.
        kind: (n, m) 0 valid, 1 a joint breaks, 2 it falls, 3 its geometry is lost.
        inside: (n, m) how far the linearised forces are inside their box, 0 at its sides.
    """

    x: np.ndarray
    y: np.ndarray
    x_name: str
    y_name: str
    kind: np.ndarray
    inside: np.ndarray


def draw_forces(
    axes: Axes,
    rays: Sequence[Ray],
    low: Sequence[float],
    high: Sequence[float],
    names: Sequence[str],
    others: Sequence[np.ndarray] = (),
    title: str = "",
) -> None:
    """Draw a force space of two forces with its box and rays.

    Args:
        axes: to draw in.
        rays: shown in colour, with the way that the full model takes.
        low, high: (2,) sides of the box; may be infinite.
        names: of the two forces, with units.
        others: (k, 2) linearised ways of further modes, drawn faintly.
        title: over the picture.
    """
    start = rays[0].linear[0]
    shown = np.concatenate([start[None], *(ray.linear for ray in rays), *(ray.true for ray in rays)])
    finite = np.array([v for v in (*low, *high) if np.isfinite(v)])
    for k, limits in enumerate((axes.set_xlim, axes.set_ylim)):
        values = np.concatenate([shown[:, k][np.isfinite(shown[:, k])], finite])
        # What leads far away is cut off.
        reach = 1.35 * max(abs(start[k]), np.abs(finite).max(initial=0.0), 0.5 * np.abs(start).max())
        bottom, top = max(values.min(), -reach), min(values.max(), reach)
        room = 0.12 * (top - bottom)
        limits(bottom - room, top + room)
    (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
    corner = max(low[0], left), max(low[1], bottom)
    wide, tall = min(high[0], right) - corner[0], min(high[1], top) - corner[1]
    axes.add_patch(Rectangle(corner, wide, tall, facecolor=VALID, alpha=0.45, edgecolor="#3182bd", lw=1.2, zorder=0))
    for way in others:
        axes.plot(*way.T, color=FAINT, lw=0.7, zorder=1)
    for k, (ray, colour) in enumerate(zip(rays, RAYS)):
        # Thinner and thinner: rays may lie on each other.
        axes.plot(*ray.linear.T, color=colour, lw=max(3.4 - 0.8 * k, 1.0), zorder=3, solid_capstyle="butt")
        axes.plot(*ray.true.T, color=colour, lw=1.3, ls=(0, (2, 1.6)), zorder=4)
        good = np.flatnonzero(ray.valid)
        if len(good):
            axes.plot(*ray.true[good[0]], "o", ms=5, color=colour, mec="white", mew=0.8, zorder=6)
    axes.plot(*start, "X", ms=9, color=REFUSED, mec="white", mew=0.8, zorder=7)
    axes.axhline(0.0, color=FAINT, lw=0.5, zorder=0)
    axes.axvline(0.0, color=FAINT, lw=0.5, zorder=0)
    axes.set(xlabel=names[0], ylabel=names[1])
    axes.set_title(title, fontsize=9, loc="left")
    marks = [
        Line2D([], [], color=REFUSED, marker="X", ls="", ms=8, label="the piece as it is"),
        Patch(facecolor=VALID, alpha=0.45, edgecolor="#3182bd", label="allowed"),
        *(Line2D([], [], color=colour, lw=1.6, label=ray.name) for ray, colour in zip(rays, RAYS)),
        Line2D([], [], color=INK, lw=1.3, ls=(0, (2, 1.6)), label="the same by the full model"),
        Line2D([], [], color=INK, marker="o", ls="", ms=5, label="first valid design on it"),
    ]
    if len(others):
        marks.append(Line2D([], [], color=FAINT, lw=0.7, label="other modes"))
    axes.legend(handles=marks, fontsize=7, loc="upper left", bbox_to_anchor=(0.0, -0.2))


def draw_region(axes: Axes, region: Region, title: str = "") -> None:
    """Draw where a piece is valid over two design parameters, and where its linearised forces say so."""
    colours = ListedColormap([VALID, WEAK, FALLS, LOST])
    axes.pcolormesh(region.x, region.y, region.kind, cmap=colours, vmin=-0.5, vmax=3.5, shading="nearest", zorder=0)
    axes.contour(
        region.x, region.y, (region.kind == 0).astype(float), levels=[0.5], colors=["#3182bd"], linewidths=1.2, zorder=2
    )
    if region.inside.min() < 0.0 < region.inside.max():
        style = {"colors": [LINEARISED], "linewidths": 1.6, "linestyles": [(0, (4, 2))]}
        axes.contour(region.x, region.y, region.inside, levels=[0.0], zorder=3, **style)
    axes.plot(0.0, 0.0, "X", ms=9, color=REFUSED, mec="white", mew=0.8, zorder=5, clip_on=False)
    axes.set(xlabel=region.x_name, ylabel=region.y_name)
    axes.set_title(title, fontsize=9, loc="left")


def region_marks(kinds: Sequence[int]) -> list[Patch | Line2D]:
    """Marks of a legend for regions in which there are such kinds."""
    names = ("valid, by the full test", "a joint breaks", "it falls", "a joint is lost, or planks overlap")
    return [
        *(Patch(facecolor=(VALID, WEAK, FALLS, LOST)[k], edgecolor=FAINT, label=names[k]) for k in sorted(set(kinds))),
        Line2D([], [], color=LINEARISED, lw=1.6, ls=(0, (4, 2)), label="limit of the linearised forces"),
        Line2D([], [], color=REFUSED, marker="X", ls="", ms=8, label="the piece as it is"),
    ]
