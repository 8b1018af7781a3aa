"""Names beside what they name, so that none lies on another, and none on a line where there is room beside it."""

from collections.abc import Iterable, Sequence

import numpy as np
from matplotlib.axes import Axes

LETTER, HIGH = 0.7, 1.7
"""Width of a letter and height of a line, over the size of the font."""
NEAR = (0.0, 8.0, 17.0, 28.0, 42.0, 60.0, 84.0, 115.0)
"""Distances from the place that are tried [points]."""
STEP = 2.0
"""Distance between the points of lines that names keep off [points]."""
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
        self._lines = np.empty((0, 2))

    def keep_off(self, lines: Iterable[np.ndarray], wide: float = 0.0) -> None:
        """Have names keep off lines (m, 2), of half a width [points], in the axes' own coordinates."""
        dense = [self._lines]
        for line in lines:
            at = (line - self._low) * self._scale
            along = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(at, axis=0), axis=1))])
            steps = np.linspace(0.0, along[-1], int(along[-1] / STEP) + 2)
            found = np.column_stack([np.interp(steps, along, at[:, k]) for k in (0, 1)])
            dense += [found + shift for shift in ([0.0, 0.0], [wide, 0.0], [-wide, 0.0], [0.0, wide], [0.0, -wide])]
        self._lines = np.concatenate(dense)

    def occupy(self, place: np.ndarray, half: float) -> None:
        """Have names keep off a square mark of this half side [points] at a place (2,)."""
        at = (np.asarray(place, dtype=float) - self._low) * self._scale
        self._taken.append((at - half, at + half))

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
            on_it: the place itself is tried before all; a name that goes elsewhere has a line to it.
        """
        at = (np.asarray(place, dtype=float) - self._low) * self._scale
        half = 0.5 * size * np.array([LETTER * max(map(len, text.split("\n"))), HIGH * (text.count("\n") + 1)])
        shift = self._free(at, half, first, on_it)
        beside = 0.0 if on_it else float(np.linalg.norm(half)) + 6.0
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
            arrowprops=line if np.linalg.norm(shift) > beside else None,
            annotation_clip=False,
        )

    def _free(self, at: np.ndarray, half: np.ndarray, first: np.ndarray | None, on_it: bool) -> np.ndarray:
        """By how much [points] the middle of a box of these half sides is moved from a place."""
        ways = [np.array([np.cos(angle), np.sin(angle)]) for angle in AROUND]
        ways = [first, *ways] if first is not None else ways
        shifts = [np.zeros(2)] if on_it else []
        shifts += [way * (np.abs(way) @ half + 2.0 + distance) for distance in NEAR for way in ways]
        free = [shift for shift in shifts if self._is_free(at + shift - half, at + shift + half)]
        if not free:
            return np.zeros(2)
        # The first that lies on the fewest points of lines.
        shift = free[int(np.argmin([self._covered(at + shift - half, at + shift + half) for shift in free]))]
        self._taken.append((at + shift - half, at + shift + half))
        return shift

    def _is_free(self, low: np.ndarray, high: np.ndarray) -> bool:
        """Whether a box is inside the axes and on no other name."""
        inside = (low >= -4.0).all() and (high <= self._room + 4.0).all()
        return bool(inside) and not any((low < top).all() and (high > bottom).all() for bottom, top in self._taken)

    def _covered(self, low: np.ndarray, high: np.ndarray) -> int:
        """How many points of lines a box covers."""
        return int(((self._lines > low) & (self._lines < high)).all(axis=1).sum())
