"""The numbers on the sheet of a bar."""

from __future__ import annotations

import numpy as np
from restshape_apps.metallophone.rasping.tolerances import tolerances
from restshape_apps.metallophone.workshop.bar import Bar
from restshape_apps.metallophone.workshop.sheet_drawing import thickness_at
from restshape_apps.metallophone.workshop.sheet_page import EDGE, SMALL, SheetPage

from restshape.analysis.modal.pitch import note
from restshape.scene.expressions import Expression

MM, GPA = 1e3, 1e-9
MOST = 7
"""Rows of modes at most."""
ROUND = 0.05
"""Difference of width and height [mm] up to which a hole has one size."""
SHOWN = 3
"""Modes with tolerances."""
HALF, LONGEST = 98.0, 58
"""Width of a column of tables [mm], and of texts in letters."""


def write_tables(page: SheetPage, bar: Bar, y: float) -> None:
    """Write the tables below a height [mm]: tones and places at the left, material and tolerances at the right."""
    left, right = EDGE, EDGE + HALF
    heads = ("mode", "Hz", "tone", "cents", "to the first")
    below = page.table(left, y, (12.0, 22.0, 14.0, 16.0, 20.0), heads, tones(bar), "Tones")
    title = "Places, from the lower left corner of the box"
    page.table(left, below - 2.0, (44.0, 20.0, 20.0), ("", "x [mm]", "y [mm]"), places(bar), title)
    below = page.table(right, y, (24.0, 64.0), (), material(bar), "Material")
    shown = min(SHOWN, len(bar.analysis.frequencies))
    heads = ("cents of mode", *(str(k + 1) for k in range(shown)))
    page.table(right, below - 2.0, (46.0, *[14.0] * shown), heads, tolerated(bar, shown), "Tolerances")


def tones(bar: Bar) -> list[list[str]]:
    """Of each mode its frequency, tone, cents and ratio to the first."""
    rows, first = [], float(bar.analysis.frequencies[0])
    for k, f in enumerate(bar.analysis.frequencies[:MOST].tolist(), 1):
        name, cents = note(f, bar.a4)
        rows.append([str(k), f"{f:.2f}", name, f"{cents:+.1f}", f"{f / first:.3f}"])
    return rows


def places(bar: Bar) -> list[list[str]]:
    """Where the bar is hung, with the diameter of holes, and struck."""
    low, _ = bar.outline.bounds()
    rows = []
    for k, place in enumerate(bar.hanging.places if bar.hanging.found else (), 1):
        x, y = MM * (place - low)
        hole = bar.holes.get(f"hang_{k}")
        rows.append([f"H{k}, hole of {2.0 * MM * hole[1]:g} mm" if hole else f"H{k}, hang", f"{x:.1f}", f"{y:.1f}"])
    rows += own_holes(bar)
    x, y = MM * (bar.strike - low)
    return [*rows, ["strike", f"{x:.0f}", f"{y:.0f}"]]


def own_holes(bar: Bar) -> list[list[str]]:
    """Of each hole that the scene has its name, its size and its middle."""
    rows, corner = [], bar.outline.bounds()[0]
    for loop in bar.outline.loops:
        if loop.kind == "hole" and loop.name not in bar.holes:
            X = np.concatenate([bar.outline.polyline(e) for e, _ in loop.edges])
            low, high = X.min(axis=0), X.max(axis=0)
            wide, tall = MM * (high - low)
            size = f"{wide:.2f}" if abs(wide - tall) < ROUND else f"{wide:.2f} x {tall:.2f}"
            x, y = MM * (0.5 * (low + high) - corner)
            rows.append([f"{loop.name}, hole of {size} mm", f"{x:.1f}", f"{y:.1f}"])
    return rows


def material(bar: Bar) -> list[list[str]]:
    """Of each material its name and numbers; area and mass of the whole."""
    rows = []
    for name, own in bar.analysis.state.scene.material.items():
        rows.append(["name", own.name or name])
        if own.E is not None:
            rows.append(["E, nu", f"{GPA * own.E:.4g} GPa, {own.nu:g}"])
        elif own.orthotropic is not None:
            moduli = ", ".join(f"{GPA * value:.3g}" for value in own.orthotropic.E)
            rows.append(["E 1, 2, 3", f"{moduli} GPa"])
            rows.append(["grain", f"{np.degrees(own.grain):.1f} degrees from x"])
        rows.append(["density", f"{own.rho:.5g} kg/m³"])
        rows.append(["thickness", _thickness(own.thickness)])
        if isinstance(own.thickness, Expression) and (names := own.thickness.parameters):
            known = bar.analysis.state.scene.parameters
            rows.append(["with (SI)", ", ".join(f"{name} = {float(known[name]):.5g}" for name in names)])
    rows.append(["area", f"{1e6 * bar.outline.area():.2f} mm²"])
    volume = volume_of(bar)
    if volume is not None:
        (own,) = bar.analysis.state.scene.material.values()
        rows.append(["mass", f"{1e3 * own.rho * volume:.2f} g"])
    return [[name, _short(text)] for name, text in rows]


def volume_of(bar: Bar) -> float | None:
    """The volume [m^3], of the mesh's triangles with the exact area of the shape; None where materials differ."""
    mesh = bar.analysis.state.space.mesh
    corners = mesh.X[mesh.cells]
    sides = corners[:, 1:] - corners[:, :1]
    areas = 0.5 * np.abs(sides[:, 0, 0] * sides[:, 1, 1] - sides[:, 0, 1] * sides[:, 1, 0])
    middles = 0.5 * (corners + corners[:, [1, 2, 0]])
    h = thickness_at(bar, middles.reshape(-1, 2))
    if h is None:
        return None
    return float(areas @ h.reshape(-1, 3).mean(axis=1)) * bar.outline.area() / float(areas.sum())


def tolerated(bar: Bar, modes: int) -> list[list[str]]:
    """Cents by tolerances, of so many modes."""
    rows = tolerances(bar.analysis).rows()
    return [[what, *(f"{one:+.1f}" if np.isfinite(one) else "–" for one in cents[:modes])] for what, cents in rows]


def write_head(page: SheetPage, bar: Bar, title: str) -> None:
    """Write the tone, what is computed, and what of."""
    f = float(bar.analysis.frequencies[0])
    page.text(EDGE, 281.0, bar.target, 26.0, weight="bold")
    page.text(EDGE + 32.0, 283.5, _short(title), 12.0, weight="bold")
    which = "wanted" if bar.wanted else "the nearest tone"
    words = f"{which}; computed {f:.2f} Hz, {bar.cents:+.1f} cents; A4 = {bar.a4:g} Hz"
    if bar.holes:
        words += f"; bores move it by {bar.drilled_cents:+.2f} cents"
    page.text(EDGE + 32.0, 277.0, words, SMALL + 1.0)
    if not bar.hanging.found:
        page.text(EDGE + 32.0, 272.0, f"no hanging points: {bar.hanging.why}", SMALL)


def _thickness(value: object) -> str:
    if isinstance(value, Expression):
        return f"{value.text} [m]"
    return f"{MM * float(str(value)):.4g} mm"


def _short(text: str) -> str:
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…"
