"""Which planks an edit moves, lengthens or adds."""

import numpy as np
from restshape_apps.furniture.shape.planks import Piece

LEAST = 1e-4
"""The shortest way that has one, in parts of the piece's size."""


def changed_planks(piece: Piece, end: Piece) -> np.ndarray:
    """Which planks (n,) an edit moves, lengthens or adds."""
    moved = [np.abs(a.corners() - b.corners()).max() for a, b in zip(piece.planks, end.planks)]
    added = [np.inf] * (len(end.planks) - len(piece.planks))
    return np.array([*moved, *added]) > LEAST * piece.size
