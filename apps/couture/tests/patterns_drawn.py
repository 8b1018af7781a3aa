"""Patterns drawn for tests, in the format of GarmentCode, with areas by closed forms."""

import json
import math
from pathlib import Path

import ezdxf

TUNIC = {
    "pattern": {
        "panels": {
            "front": {
                "translation": [10.0, 20.0, 30.0],
                "rotation": [0.0, 0.0, 0.0],
                "vertices": [[0, 0], [40, 0], [40, 60], [0, 60]],
                "edges": [
                    {"endpoints": [0, 1], "label": "hem"},
                    {"endpoints": [1, 2], "curvature": {"type": "quadratic", "params": [[0.5, 0.1]]}},
                    {"endpoints": [2, 3], "curvature": {"type": "circle", "params": [25.0, 0, 0]}},
                    {"endpoints": [3, 0], "curvature": {"type": "cubic", "params": [[0.25, -0.2], [0.75, -0.2]]}},
                ],
                "label": "body",
            },
            "back": {
                "translation": [10.0, 20.0, -30.0],
                "rotation": [10.0, 150.0, -20.0],
                "vertices": [[0, 0], [40, 0], [40, 60], [0, 60]],
                "edges": [
                    {"endpoints": [0, 1]},
                    {"endpoints": [1, 2], "curvature": [0.5, 0.1]},
                    {"endpoints": [2, 3], "curvature": {"type": "circle", "params": [25.0, 1, 1]}},
                    {"endpoints": [3, 0], "curvature": {"type": "cubic", "params": [[0.2, 0.1], [0.9, -0.2]]}},
                ],
            },
        },
        "stitches": [
            [{"panel": "front", "edge": 1}, {"panel": "back", "edge": 3, "fold": "inwards"}],
            [{"panel": "front", "edge": 3}, {"panel": "back", "edge": 1}],
        ],
        "panel_order": ["back", "front"],
    },
    "parameters": {"ease": 1.5},
    "properties": {"curvature_coords": "relative", "units_in_meter": 100},
}
HALF = math.asin(0.4 / 0.5)
"""Half the angle of an arc of radius 25 cm over 40 cm."""
SEGMENT = 0.25**2 / 2 * (2 * HALF - math.sin(2 * HALF))
"""Area between that arc and its chord [m^2]."""


def under_cubic(a: float, p: float, b: float, q: float) -> float:
    """Area under the cubic Bézier curve from (0, 0) to (1, 0) with handles (a, p) and (b, q), the integral of y dx."""
    return (3.0 * (p + b * p - a * q) + 6.0 * q) / 20.0


AREAS = {
    "front": 0.24 - 0.6 * 0.06 / 3 - SEGMENT - 0.36 * under_cubic(0.25, -0.2, 0.75, -0.2),
    "back": 0.24 - 0.6 * 0.06 / 3 + math.pi * 0.25**2 - SEGMENT - 0.36 * under_cubic(0.2, 0.1, 0.9, -0.2),
}
"""Of the panels [m^2]: what is to the left of an edge is taken away, for they go counter-clockwise."""


def written(folder: Path, pattern: object = TUNIC, name: str = "tunic.json") -> Path:
    """The file of a pattern."""
    path = folder / name
    path.write_text(pattern if isinstance(pattern, str) else json.dumps(pattern, indent=1))
    return path


def changed(*keys: object, value: object) -> dict:
    """The tunic with another value under some keys."""
    found = json.loads(json.dumps(TUNIC))
    inner = found
    for key in keys[:-1]:
        inner = inner[key]
    inner[keys[-1]] = value
    return found


def squares_dxf(folder: Path) -> Path:
    """Two pieces in inches as programs of the trade draw them: one block with all layers, one with a cut line alone."""
    drawing = ezdxf.new("R12")
    space = drawing.modelspace()
    space.add_text("UNITS: ENGLISH", dxfattribs={"layer": "1"})
    front = drawing.blocks.new("B1")
    front.add_text("Piece Name: FRONT", dxfattribs={"layer": "1"})
    front.add_polyline2d([(-1, -1), (11, -1), (11, 11), (-1, 11)], close=True, dxfattribs={"layer": "1"})
    front.add_polyline2d([(0, 0), (10, 0), (10, 10), (0, 10)], close=True, dxfattribs={"layer": "14"})
    front.add_circle((5, 7), 1, dxfattribs={"layer": "11"})
    front.add_polyline2d([(2, 2), (4, 2), (4, 4), (2, 4)], close=True, dxfattribs={"layer": "8"})
    front.add_line((6, 1), (8, 3), dxfattribs={"layer": "8"})
    front.add_line((1, 1), (1, 9), dxfattribs={"layer": "7"})
    for place in ((10, 10), (8, 8), (5, 0)):
        front.add_point(place, dxfattribs={"layer": "4"})
    for place in ((0, 0), (10, 0)):
        front.add_point(place, dxfattribs={"layer": "3"})
    front.add_text("SIZE 38", dxfattribs={"layer": "15"})
    back = drawing.blocks.new("BACK")
    back.add_polyline2d([(0, 0), (4, 0), (4, 5), (0, 5)], close=True, dxfattribs={"layer": "1"})
    space.add_blockref("B1", (100, 0))
    space.add_blockref("BACK", (200, 50))
    path = folder / "squares.dxf"
    drawing.saveas(path)
    return path
