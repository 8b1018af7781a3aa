"""Weights that an edit takes along, for a plank that it makes longer or shorter carries them at parts of its size."""

from __future__ import annotations

import numpy as np
from restshape_apps.furniture.guidance.amounts import amount
from restshape_apps.furniture.shape.directions import room_words
from restshape_apps.furniture.shape.planks import Load, Piece

LEAST = 1e-3
"""How far a weight is taken along at least to be named [m]."""


def weights_along(before: Piece, after: Piece) -> str:
    """Which weights go how far with planks that become longer or shorter, in words; empty where none does.

    Args:
        before, after: an edit, with the same planks first and weights.
    """
    groups: dict[tuple[str, str], list[str]] = {}
    for one, other in zip(before.weights, after.weights):
        size, now = before.planks[one.plank].size, after.planks[other.plank].size
        way = _place(after, other) - _place(before, one)
        far = float(np.linalg.norm(way))
        if far < LEAST or np.abs(now[:2] - size[:2]).max() < LEAST:
            continue
        groups.setdefault((amount(far, "m"), room_words(way / far)), []).append(one.name)
    parts = (f"{' and '.join(names)} taken {far} towards {to}" for (far, to), names in groups.items())
    return ", ".join(parts)


def _place(piece: Piece, load: Load) -> np.ndarray:
    """Where a load acts (3,) [m]."""
    plank = piece.planks[load.plank]
    return plank.centre + plank.axes @ (plank.size * load.place)
