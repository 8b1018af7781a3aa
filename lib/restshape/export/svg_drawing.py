"""An outline as SVG paths in true size: lines, arcs and cubic Bézier curves as they are."""

from __future__ import annotations

from pathlib import Path
from xml.sax.saxutils import quoteattr

import numpy as np

from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import EXPORT_MARK
from restshape.shape.drawings.bsplines import beziers_of
from restshape.shape.outline import Outline

MM = 1e3
MARGIN = 0.02
"""Share of the size that is left free around the shape."""
STROKE = 0.002
"""Width of lines, over the size."""
HALF = 1e-9
"""Distance of a bulge from 1 up to which an arc is half a circle."""
SHORT = 1e-12
"""Share by which the radius of half a circle is too short, so that readers take half the chord (SVG, F.6.6): where the
centre is follows from the root of a difference that is rounding else, and would be off by 1e-8 of the radius."""


def svg_head(lower: np.ndarray, upper: np.ndarray, margin: float, width: float) -> list[str]:
    """The first lines of a drawing between two corners (2,), with a margin and a width of lines [mm]; y goes up."""
    (x, y), (w, h) = (lower[0] - margin, -upper[1] - margin), upper - lower + 2.0 * margin
    return [
        '<?xml version="1.0" encoding="UTF-8"?>',
        f"<!-- {EXPORT_MARK} -->",
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{w:.6f}mm" height="{h:.6f}mm" '
        f'viewBox="{x:.6f} {y:.6f} {w:.6f} {h:.6f}" fill="none" stroke="black" stroke-width="{width:.6g}">',
    ]


def write_svg(outline: Outline, path: Path) -> None:
    """Writes a shape: a group a loop and a path an edge, each with its name as ``id``; one unit is a millimetre.

    y goes up, as in the scene. An edge that bounds two loops is in the first one.

    Raises:
        OSError: it cannot be written.
    """
    lower, upper = (MM * corner for corner in outline.bounds())
    margin, width = MARGIN * MM * outline.size, STROKE * MM * outline.size
    lines = svg_head(lower, upper, margin, width)
    drawn: set[int] = set()
    for loop in outline.loops:
        lines.append(f"<g id={quoteattr(loop.name)} class={quoteattr(loop.kind)}>")
        for e, forward in loop.edges:
            if e not in drawn:
                lines.append(
                    f"<path id={quoteattr(outline.edges[e].name)} d={quoteattr(path_of(outline, e, forward))}/>"
                )
                drawn.add(e)
        lines.append("</g>")
    write_whole(path, "\n".join([*lines, "</svg>", ""]))


def path_of(outline: Outline, index: int, forward: bool = True) -> str:
    """The path of an edge in SVG's words, in mm with y down; backwards unless `forward`."""
    edge, bulge = outline.edges[index], float(outline.bulges[index])
    points = outline.points[outline.layout.controls[index]]
    if edge.kind == "spline":
        pieces = beziers_of(points, edge.knots, edge.ends)
        pieces = pieces if forward else pieces[::-1, ::-1]
        return f"M {_words(pieces[0, :1])} C {' '.join(_words(piece[1:]) for piece in pieces)}"
    points = points if forward else points[::-1]
    if edge.kind == "arc" and bulge != 0.0:
        radius = MM * float(np.hypot(*(points[1] - points[0]))) * (1.0 + bulge**2) / (4.0 * abs(bulge))
        if abs(abs(bulge) - 1.0) < HALF:
            radius *= 1.0 - SHORT
        # y is down: what turns counter-clockwise in the scene has the sweep flag 0.
        large, sweep = int(abs(bulge) > 1.0), int((bulge > 0.0) != forward)
        return f"M {_words(points[:1])} A {radius!r} {radius!r} 0 {large} {sweep} {_words(points[1:])}"
    return f"M {_words(points[:1])} L {_words(points[1:])}"


def _words(points: np.ndarray) -> str:
    """Points (n, 2) [m] in mm, y down."""
    return " ".join(f"{float(MM * x)!r},{float(0.0 - MM * y)!r}" for x, y in points)
