"""Names beside what they name, so that none lies on another."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

LETTER, HIGH = 0.7, 1.7
"""Width of a letter and height of a line, over the size of the font."""
NEAR = (0.0, 8.0, 17.0, 28.0, 42.0)
"""Distances from the place that are tried [points]."""
AROUND = np.deg2rad([60.0, 120.0, -60.0, -120.0, 0.0, 180.0, 90.0, -90.0])


class Labels:
    """Puts names into axes whose limits and place in the figure are final."""

    def __init__(self, axes: Axes) -> None:
        self.axes = axes
        figure = axes.figure
        (left, right), (bottom, top) = axes.get_xlim(), axes.get_ylim()
        wide, high = 72.0 * figure.get_size_inches() * axes.get_position().size
        self._scale = np.array([wide / (right - left), high / (top - bottom)])
        self._low, self._room = np.array([left, bottom]), np.array([wide, high])
        self._taken: list[tuple[np.ndarray, np.ndarray]] = []

    def add(
        self,
        place: Sequence[float] | np.ndarray,
        text: str,
        colour: str,
        size: float = 7.5,
        first: np.ndarray | None = None,
        on_it: bool = False,
    ) -> None:
        """Writes a name beside a place (2,), where room is; on it where there is none.

        Args:
            place: in the axes' own coordinates.
            text, colour, size: of the name.
            first: the way (2,) that is tried first.
            on_it: the place itself is tried before all.
        """
        at = (np.asarray(place, dtype=float) - self._low) * self._scale
        half = 0.5 * size * np.array([LETTER * max(map(len, text.split("\n"))), HIGH * (text.count("\n") + 1)])
        shift = self._free(at, half, first, on_it)
        box = {"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 0.4}
        line = {"arrowstyle": "-", "lw": 0.5, "color": colour, "shrinkA": 0, "shrinkB": 1}
        self.axes.annotate(
            text,
            place,
            xytext=tuple(shift),
            textcoords="offset points",
            ha="center",
            va="center",
            color=colour,
            fontsize=size,
            bbox=box,
            zorder=9,
            arrowprops=line if np.linalg.norm(shift) > np.linalg.norm(half) + 6.0 else None,
            annotation_clip=False,
        )

    def _free(self, at: np.ndarray, half: np.ndarray, first: np.ndarray | None, on_it: bool) -> np.ndarray:
        """By how much [points] the middle of a box of these half sides is moved from a place."""
        ways = [np.array([np.cos(angle), np.sin(angle)]) for angle in AROUND]
        ways = [first, *ways] if first is not None else ways
        shifts = [np.zeros(2)] if on_it else []
        shifts += [way * (np.abs(way) @ half + 2.0 + distance) for distance in NEAR for way in ways]
        for shift in shifts:
            low, high = at + shift - half, at + shift + half
            inside = (low >= -4.0).all() and (high <= self._room + 4.0).all()
            if inside and not any((low < top).all() and (high > bottom).all() for bottom, top in self._taken):
                self._taken.append((low, high))
                return shift
        return np.zeros(2)
