"""The outer side of edges, and the angle of texts along them."""

from __future__ import annotations

import numpy as np

from restshape.arrays import Reals
from restshape.shape.outline import Outline


def outward_of(outline: Outline, edge: int, forward: bool, s: float) -> Reals:
    """The direction (2,) away from the piece at a parameter of an edge, which has the piece on its left."""
    tangent = outline.tangent(edge, s)[0] * (1.0 if forward else -1.0)
    tangent = tangent / float(np.hypot(*tangent))
    return np.array([tangent[1], -tangent[0]])


def text_angle(outward: Reals) -> float:
    """The angle [rad] of a text along an edge, by the direction (2,) away from the piece, to be read from below."""
    angle = float(np.arctan2(outward[0], -outward[1]))
    return (angle + 0.5 * np.pi) % np.pi - 0.5 * np.pi
