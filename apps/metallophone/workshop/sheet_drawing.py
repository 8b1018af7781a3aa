"""The drawing of a bar on its sheet: outline, holes, places, dimensions, and a section along it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from restshape_apps.metallophone.workshop.bar import Bar
from restshape_apps.metallophone.workshop.sheet_page import EDGE, FAINT, HOLE, INK, SIZE, SMALL, WARM, SheetPage

from restshape.arrays import Reals
from restshape.mesh.thickness import Thickness

MM = 1e3
SCALES = (10.0, 5.0, 2.0, 1.0, 0.5, 0.4, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001)
"""Scales of drawings (ISO 5455, and 1:2.5)."""
TOP = 262.0
"""Of what is drawn [mm]."""
ROOM = np.array([171.0, 68.0])
"""Width and height that the outline may take [mm]."""
STEP = 7.0
"""From a dimension to the next [mm]."""
CROSS = 2.0
"""Half the length of the lines of a cross [mm]."""
SECTION_ROOM = 14.0
"""Height of the section with its texts [mm]."""
SAMPLES = 400
SAME = 5e-5
"""Distance [m] up to which places share a dimension."""


@dataclass(frozen=True)
class Placed:
    """Where the shape lies on the paper.

    Args:
        low: (2,) lower corner of its box [m]; at: (2,) on the paper [mm]; scale: paper over shape.
    """

    low: Reals
    at: Reals
    scale: float

    def __call__(self, X: Reals) -> Reals:
        """Places on the paper [mm] of places X (..., 2) [m]."""
        return self.at + MM * self.scale * (X - self.low)


def draw_bar(page: SheetPage, bar: Bar) -> float:
    """Draw the bar with its dimensions and its section; the height [mm] at which all this ends, from above."""
    low, high = bar.outline.bounds()
    scale = next((one for one in SCALES if (MM * one * (high - low) <= ROOM).all()), SCALES[-1])
    size = MM * scale * (high - low)
    placed = Placed(low, np.array([EDGE, TOP - size[1]]), scale)
    _outline(page, bar, placed)
    bottom = _across(page, bar, placed, high)
    _upright(page, bar, placed, high)
    words = f"{scale:g} : 1" if scale >= 1.0 else f"1 : {1.0 / scale:g}"
    page.text(SIZE[0] - EDGE, TOP + 4.0, f"scale {words}, mm", SMALL, ha="right")
    return _section(page, bar, placed, high, bottom - 5.0)


def _outline(page: SheetPage, bar: Bar, placed: Placed) -> None:
    """The curves of the shape, and crosses where it is hung and struck."""
    outline, error = bar.outline, 2e-5 / placed.scale
    for kind, width, colour in (("region", 0.4, FAINT), ("hole", 0.8, HOLE), ("outline", 1.0, INK)):
        for loop in outline.loops:
            if loop.kind == kind:
                page.lines([placed(outline.polyline(e, error)) for e, _ in loop.edges], width, colour)
    strike = placed(bar.strike)
    page.axes.plot(*strike, "o", ms=5, mfc="none", mec=WARM, mew=1.0)
    page.text(strike[0], strike[1] + 3.2, "strike", SMALL, ha="center", color=WARM)
    for k, place in enumerate(placed(bar.hanging.places) if bar.hanging.found else (), 1):
        page.lines([np.array([place - way, place + way]) for way in CROSS * np.eye(2)], 0.6, HOLE)
        page.text(place[0] + 2.2, place[1] + 2.6, f"H{k}", SMALL, color=HOLE)


def _across(page: SheetPage, bar: Bar, placed: Placed, high: Reals) -> float:
    """Dimensions along x, below; the height [mm] of the lowest."""
    base, left, y = placed(placed.low), placed.low[0], float(placed.at[1]) - STEP
    for place in _apart(bar, 0):
        x = float(placed(place)[0])
        page.along_x(float(base[0]), x, y, (float(base[1]), float(placed(place)[1])), f"{MM * (place[0] - left):.1f}")
        y -= STEP
    page.along_x(float(base[0]), float(placed(high)[0]), y, [float(base[1])] * 2, f"{MM * (high[0] - left):.2f}")
    return y


def _upright(page: SheetPage, bar: Bar, placed: Placed, high: Reals) -> None:
    """Dimensions along y, to the right; places at one height have one."""
    base, top, x = placed(placed.low), placed(high), float(placed(high)[0]) + STEP
    for place in _apart(bar, 1):
        y = float(placed(place)[1])
        text = f"{MM * (place[1] - placed.low[1]):.1f}"
        page.along_y(float(base[1]), y, x, (float(top[0]), float(placed(place)[0])), text)
        x += STEP
    text = f"{MM * (high[1] - placed.low[1]):.2f}"
    page.along_y(float(base[1]), float(top[1]), x, [float(top[0])] * 2, text)


def _apart(bar: Bar, axis: int) -> list[Reals]:
    """The places at which the bar is hung in their order along an axis; of those at one height the first."""
    found: list[Reals] = []
    for place in sorted(bar.hanging.places if bar.hanging.found else (), key=lambda place: float(place[axis])):
        if not found or place[axis] - found[-1][axis] > SAME:
            found.append(place)
    return found


def _section(page: SheetPage, bar: Bar, placed: Placed, high: Reals, y: float) -> float:
    """The section along the middle line of the box, its upper face flat; the height [mm] at which it ends."""
    x = np.linspace(placed.low[0], high[0], SAMPLES)
    X = np.column_stack([x, np.full(SAMPLES, 0.5 * (placed.low[1] + high[1]))])
    h = thickness_at(bar, X)
    if h is None:
        return y
    paper = placed(X)[:, 0]
    under = y - MM * placed.scale * h
    ring = np.column_stack([np.concatenate([paper, paper[::-1]]), np.concatenate([np.full(SAMPLES, y), under[::-1]])])
    page.axes.fill(*ring.T, facecolor="#dddddd", edgecolor=INK, lw=0.7)
    low, most = MM * float(h.min()), MM * float(h.max())
    words = f"{most:.2f}" if most - low < 0.005 else f"{low:.2f} to {most:.2f}"
    page.text(float(paper[-1]) + 3.0, y - 0.5 * MM * placed.scale * float(h.mean()), f"thickness {words}", SMALL)
    return min(float(under.min()) - 3.0, y - 5.0)


def thickness_at(bar: Bar, X: Reals) -> Reals | None:
    """The thickness (n,) [m] at places X (n, 2) [m]; None where regions have materials of their own."""
    materials = list(bar.analysis.state.scene.material.values())
    if len(materials) != 1:
        return None
    return Thickness(materials[0].thickness, bar.analysis.state.scene.parameters).at(X)
