"""Cloth in bodies: nodes below a surface, and bodies that come through between nodes, which alone touch them."""

import math
from collections.abc import Sequence

import numpy as np

from restshape import _kernels
from restshape.scene.bodies import Body

TUNNELLING_DEPTH = 0.5
"""Part of a body's smallest size by which it is deeper in a triangle where it comes through; less is a chord's sag."""
MOST_SAMPLES = 24
"""Places along the side of a triangle that are looked at for a body between its nodes."""


def size_of(body: Body) -> float:
    """The smallest way through a body of numbers, from its middle [m]; infinite for a half-space."""
    form = body.form
    match body.kind:
        case "sphere" | "capsule":
            return form.radius
        case "cylinder":
            return min(form.radius, 0.5 * math.dist(form.start, form.end))
        case "box":
            return min(form.half)
        case _:
            return np.inf


def penetrations(kernels: Sequence[_kernels.Body], x: np.ndarray) -> list[float]:
    """How far [m] the deepest of the nodes x (n, 3) [m] is below the surface of each body; 0 where none is."""
    return [max(0.0, -float(kernel.distance(x)[0].min())) for kernel in kernels]


def tunnelling(bodies: Sequence[Body], kernels: Sequence[_kernels.Body], x: np.ndarray) -> list[bool]:
    """Whether each body is between the corners of one of the triangles x (ne, 3, 3) [m].

    Args:
        bodies: of numbers alone; kernels: the same ones as the kernels take them.
        x: where the corners are.
    """
    return [_comes_through(kernel, size_of(body), x) for body, kernel in zip(bodies, kernels)]


def _comes_through(body: _kernels.Body, size: float, x: np.ndarray) -> bool:
    """Whether a body of this size [m] is between the corners of one of the triangles x (ne, 3, 3) [m]."""
    if not np.isfinite(size):
        return False
    longest = float(np.linalg.norm(x - np.roll(x, 1, axis=1), axis=2).max())
    middles = x.mean(axis=1)
    near = x[body.distance(middles)[0] < longest]
    n = int(np.clip(np.ceil(2.0 * longest / size), 3, MOST_SAMPLES))
    i, j = (part.ravel() for part in np.mgrid[: n + 1, : n + 1])
    inside = np.column_stack([i, j, n - i - j])[i + j <= n] / n
    places = np.einsum("pi,eij->epj", inside, near).reshape(-1, 3)
    return len(places) > 0 and bool(body.distance(places)[0].min() < -TUNNELLING_DEPTH * size)
