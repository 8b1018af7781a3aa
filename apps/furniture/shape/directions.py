"""Directions in the axes of the room, in words."""

import numpy as np

ALONG = 0.3
"""Least cosine with an axis of the room for a direction to be named by it."""


def room_words(way: np.ndarray) -> str:
    """The axes of the room that a unit vector (3,) goes along."""
    order = [k for k in np.argsort(-np.abs(way), kind="stable") if abs(way[k]) > ALONG]
    return " and ".join(f"{'-' if way[k] < 0.0 else '+'}{'xyz'[k]}" for k in order)
