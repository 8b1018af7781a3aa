"""Places for people: in a panel's own coordinates, as its scene has them, where the shape is of panels."""

from __future__ import annotations

import math

from restshape.scene.pattern_packing import turned
from restshape.shape.outline import Outline


def place_words(outline: Outline, x: float, y: float, edge: int) -> str:
    """What a place (x, y) [m] of the pattern plane is called in a message about an edge.

    The panel's coordinates are those of its tables, wherever it lies on the sheet.
    """
    panel = outline.piece_names[int(outline.layout.edge_piece[edge])]
    frame = outline.frames.get(panel)
    if frame is None:
        return f"({x:.4g}, {y:.4g}) m"
    own = turned((x - frame[0], y - frame[1]), -frame[2])
    # Rounding makes 1e-17 of what is 0.
    u, v = (0.0 if math.isclose(value, 0.0, abs_tol=1e-9 * outline.size) else value for value in own)
    return f"({u:.4g}, {v:.4g}) m of panel {panel}"
