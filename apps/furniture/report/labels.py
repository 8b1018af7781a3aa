"""Words in a picture that keep clear of each other, and of what they are about."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.backend_bases import RendererBase
from matplotlib.text import Annotation, Text

from restshape.outputs.si_numbers import counted

AWAY = (7.0, 13.0, 20.0)
"""How far words are moved at most, in steps [points]."""
AROUND = 16
"""Directions in which they are."""
BLOCKED = 0.6
"""Weight of an area of words over something else drawn, beside that of words over words."""
PATH = 0.02
"""What a pixel of way costs, in parts of an area as high as the words."""
PIECES = 25
"""Boxes that stand for a line."""
COVERED = 0.02
"""Part of its area with which a word may lie on others; one that has no such place is left out."""


class Labels(Artist):
    """Moves words apart, in the pixels of the picture, right before they are drawn.

    What matters most, and of equal ones what is added first, stays nearest to its place. A word that is moved has a
    thin line to its place. One that finds no room is left out, and the picture says how many are.

    Args:
        axes: of the picture.
    """

    zorder = 8.5

    def __init__(self, axes: Axes) -> None:
        super().__init__()
        self._words: list[tuple[int, Annotation, np.ndarray, float]] = []
        self._lines: list[np.ndarray] = []
        axes.add_artist(self)
        self._left_out = axes.text(0.0, 0.0, "", transform=axes.transAxes, fontsize=6.5, style="italic", zorder=9)
        self._left_out.set_in_layout(False)

    def add(self, word: Annotation, most: float = np.inf, rank: int = 0) -> None:
        """Keep a word, whose offset is in points, clear of all others.

        Args:
            word: to be moved.
            most: how far [points]; one with such a limit is never left out.
            rank: words of higher rank give way to those of lower rank.
        """
        self._words.append((rank, word, np.array(word.xyann, dtype=float), most))

    def spare(self, line: np.ndarray) -> None:
        """Keep words off a line (2, 2) in data coordinates."""
        self._lines.append(np.asarray(line, dtype=float))

    def draw(self, renderer: RendererBase) -> None:
        """Move the words; they are drawn after this."""
        lines = [self.axes.transData.transform(line) for line in self._lines]
        steps = np.linspace(0.0, 1.0, PIECES)[:, None]
        blocks = np.array([np.tile(p, 2) for a, b in lines for p in a + steps * (b - a)]).reshape(-1, 4)
        blocks += [-2.0, -2.0, 2.0, 2.0]
        pixels = renderer.points_to_pixels(1.0)
        angles = 2.0 * np.pi * np.arange(AROUND) / AROUND
        ring = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        moves = np.concatenate([np.zeros((1, 2)), *(away * ring for away in AWAY)])
        taken = np.zeros((0, 4))
        far = np.linalg.norm(moves, axis=1)
        left_out = 0
        for _, word, offset, most in sorted(self._words, key=lambda one: one[0]):
            word.set_visible(True)
            word.xyann = tuple(offset)
            # Of the words alone: the line to their place is none of them.
            word.update_positions(renderer)
            box = _text_box(word, renderer)
            boxes = box + np.tile(pixels * moves, 2)
            height = box[3] - box[1]
            on_words = _covered(boxes, taken)
            cost = on_words + BLOCKED * _covered(boxes, blocks)
            cost += np.where(far <= most, PATH * height * pixels * far, np.inf)
            if most == np.inf:
                cost[on_words > COVERED * height * (box[2] - box[0])] = np.inf
            best = int(np.argmin(cost))
            if cost[best] == np.inf:
                word.set_visible(False)
                left_out += 1
                continue
            word.xyann = tuple(offset + moves[best])
            if word.arrow_patch is not None:
                word.arrow_patch.set_visible(best > 0)
            taken = np.vstack([taken, boxes[best]])
        self._left_out.set_text(f"no room for {counted(left_out, 'label')}" if left_out else "")


def _text_box(word: Annotation, renderer: RendererBase) -> np.ndarray:
    """Left, bottom, right and top (4,) of words in pixels, without their line."""
    box = Text.get_window_extent(word, renderer)
    return np.array([box.x0 - 1.0, box.y0 - 1.0, box.x1 + 1.0, box.y1 + 1.0])


def _covered(boxes: np.ndarray, others: np.ndarray) -> np.ndarray:
    """The area (n,) that boxes (n, 4) share with all others (m, 4)."""
    low = np.maximum(boxes[:, None, :2], others[None, :, :2])
    high = np.minimum(boxes[:, None, 2:], others[None, :, 2:])
    return np.maximum(high - low, 0.0).prod(axis=2).sum(axis=1)
