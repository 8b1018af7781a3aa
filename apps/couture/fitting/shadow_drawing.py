"""The edge of a shadow as a drawing in millimetres."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from restshape.export.svg_drawing import MM, svg_head
from restshape.outputs.atomic_files import write_whole

MARGIN, WIDTH = 10.0, 0.5
"""Around the outline, and of its line [mm]."""


def write_shadow(points: np.ndarray, path: Path) -> None:
    """Writes points (m, 2) [m] as one closed path; a unit is a millimetre, y goes up as in the scene.

    Raises:
        OSError: it cannot be written.
    """
    lower, upper = MM * points.min(axis=0), MM * points.max(axis=0)
    words = " ".join(f"{MM * x:.4f},{-MM * y:.4f}" for x, y in points)
    lines = [*svg_head(lower, upper, MARGIN, WIDTH), f'<path id="shadow" d="M {words} Z"/>', "</svg>", ""]
    write_whole(path, "\n".join(lines))
