"""Many short lines as one path: matplotlib would make an object of each, which takes longer than to draw them."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from matplotlib.collections import PathCollection
from matplotlib.path import Path

MOST = 4096
"""Lines of one path: the renderer keeps all pixels that a path touches until it is drawn."""


class Segments(PathCollection):
    """Lines that are put in place again from frame to frame.

    Args:
        look: of a collection of paths: `edgecolors`, `linewidths`, `linestyles`, `visible`.
    """

    def __init__(self, **look: Any) -> None:
        super().__init__([], facecolors="none", **look)

    def show(self, lines: np.ndarray) -> None:
        """Puts lines (n, k, 2) of k points each."""
        self.set_paths([_path(lines[start : start + MOST]) for start in range(0, len(lines), MOST)])

    def trace(self, lines: Iterable[np.ndarray]) -> None:
        """Puts lines (k, 2) of any number of points each; dashes go along the whole of each."""
        self.set_paths([Path(line) for line in lines])


def _path(lines: np.ndarray) -> Path:
    """One path of lines (n, k, 2)."""
    codes = np.full(lines.shape[:2], Path.LINETO, dtype=Path.code_type)
    codes[:, 0] = Path.MOVETO
    return Path(lines.reshape(-1, 2), codes.ravel())
