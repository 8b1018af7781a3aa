"""A mesh under the drag of a part of its shape, by each linear map of its nodes, alone and with flips."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from restshape_studies.bench.maps import table

from restshape.outputs.picture_files import save_picture
from restshape.report.style import BODY, FAINT, INK, REFUSED, new_figure, resolution

LOW, GOOD = "#e69f00", BODY
COLOURS = {"mvc": "#d55e00", "pmvc": "#0072b2", "harmonic": "#009e73"}
LINES = {"alone": "--", "with flips": "-"}
FEWER_DOTS = 120
"""Pixels an inch: thin lines make large files."""
WORDS = {"mvc": "plain mean values", "pmvc": "positive mean values", "harmonic": "stiffened harmonic map"}


def draw_maps(name: str, found: Mapping[str, Any], path: Path) -> None:
    """Writes the picture as a PNG: the mesh at the press, and after the drag by each map; quality along the way.

    Args:
        name: of the shape.
        found: what `restshape_studies.bench.maps.compared` finds.
        path: of the picture.
    """
    kinds = found["kinds"]
    with resolution(FEWER_DOTS):
        figure = new_figure(3.1 * (1 + len(kinds)), 7.2)
    panels = figure.subplots(2, 1 + len(kinds))
    _mesh(panels[0, 0], found, found["floor"])
    panels[0, 0].set_title(f"(a) at the press\nleast quality {found['quality']:.2f}\n", loc="left")
    _qualities(panels[1, 0], found)
    for column, (kind, ways) in enumerate(kinds.items(), start=1):
        for row, (way, one) in enumerate(ways.items()):
            axes = panels[row, column]
            _mesh(axes, one, found["floor"])
            letter = "bcdefg"[row * len(kinds) + column - 1]
            axes.set_title(f"({letter}) {WORDS[kind]}, {way}\n{_ends(one)}", loc="left")
    meshes = [*panels[0], *panels[1, 1:]]
    low, high = _box(found)
    for axes in meshes:
        axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xlabel="x [m]")
    panels[0, 0].set_ylabel("y [m]")
    figure.suptitle(
        f"{name[:1].upper()}{name[1:]}: {found['on']} dragged by {1e3 * found['ways'][-1]:.3g} mm on one mesh\n"
        f"triangles: inverted red, of quality below {found['floor']:.2g} orange",
        x=0.01,
        ha="left",
        color=INK,
    )
    save_picture(figure, path)


def _box(found: Mapping[str, Any]) -> tuple[np.ndarray, np.ndarray]:
    """The corners of the box around all meshes, with a margin."""
    ends = [one["X"] for ways in found["kinds"].values() for one in ways.values()]
    X = np.concatenate([table(text) for text in (found["X"], *ends)])
    margin = 0.03 * np.ptp(X, axis=0).max()
    return X.min(axis=0) - margin, X.max(axis=0) + margin


def _ends(one: Mapping[str, Any]) -> str:
    """What a mesh has come to, for people."""
    way = "no new mesh wanted" if one["way"] is None else f"new mesh wanted at {1e3 * one['way']:.3g} mm"
    return f"least quality {one['quality']:.2f}, {one['inverted']} inverted\n{way}"


def _mesh(axes: Axes, one: Mapping[str, Any], floor: float) -> None:
    """Draws triangles, those of low quality and inverted ones over the others."""
    corners = table(one["X"])[table(one["cells"]).astype(int)]
    quality = qualities(corners)
    for chosen, colour, edge in (
        (quality >= floor, GOOD, "#8795a1"),
        ((quality > 0.0) & (quality < floor), LOW, "#8a5a00"),
        (quality <= 0.0, REFUSED, "#7b241c"),
    ):
        axes.add_collection(PolyCollection(corners[chosen], facecolors=colour, edgecolors=edge, linewidths=0.4))


def qualities(corners: np.ndarray) -> np.ndarray:
    """Inscribed radius over longest side (ne,) of triangles (ne, 3, 2), 1 of equilateral ones; negative: inverted."""
    sides = np.roll(corners, -1, axis=1) - corners
    lengths = np.linalg.norm(sides, axis=2)
    areas = 0.5 * (sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    longest = lengths.max(axis=1)
    return 4.0 * np.sqrt(3.0) * areas / np.maximum(longest * lengths.sum(axis=1), np.finfo(float).tiny)


def _qualities(axes: Axes, found: Mapping[str, Any]) -> None:
    """Draws the least quality along the way of the hand, and what is asked of it."""
    ways = [0.0, *(1e3 * way for way in found["ways"])]
    for kind, ends in found["kinds"].items():
        for way, one in ends.items():
            values = [found["quality"], *one["qualities"]]
            axes.plot(ways, values, color=COLOURS[kind], linestyle=LINES[way], linewidth=1.3, label=f"{kind}, {way}")
    axes.axhline(found["floor"], color=FAINT, linewidth=0.8)
    axes.axhline(0.0, color=INK, linewidth=0.8)
    axes.set(xlim=(0.0, ways[-1]), ylim=(-1.0, 1.0), xlabel="way of the hand [mm]", ylabel="least quality")
    axes.legend(loc="upper right", fontsize=7, ncols=2, columnspacing=1.0, handlelength=2.2)
    axes.set_title("least quality along the drag\n\n", loc="left")
