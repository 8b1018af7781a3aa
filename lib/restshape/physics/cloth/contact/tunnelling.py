"""Cloth in bodies: how deep its triangles are below a surface, and bodies that come through."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from restshape.physics.cloth.contact.contact import Contact
from restshape.physics.cloth.contact.mesh_bodies import distance_of
from restshape.scene.bodies import Body

TUNNELLING_DEPTH = 0.5
"""Part of a body's smallest size by which it is deeper in a triangle where it comes through; less is a chord's sag."""
MORE = 0.1
"""Part of the thickness of contact by which a body must come deeper into cloth to have come into it."""
EXACT = 1e-3
"""Tolerance of depths, over the thickness of contact."""


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
        case "mesh" | "mannequin":
            return form.scale * distance_of(form).facts.thin
        case _:
            return np.inf


def penetrations(contact: Contact, x: np.ndarray, bodies: Sequence[Any] | None = None) -> list[float]:
    """How far [m] the deepest place of the triangles of cloth at x (n, 3) [m] is in each body; 0 where none is.

    The kernel's bodies are those of the contact where no others are given.
    """
    tolerance = EXACT * contact.thickness
    bodies = contact.bodies if bodies is None else bodies
    return [max(0.0, -float(body.lowest(x, contact.cells, tolerance)[0])) for body in bodies]


def deepened(before: Sequence[float], after: Sequence[float], thickness: float) -> bool:
    """Whether a body is deeper [m] in cloth than a thickness [m], and by a tenth of it deeper than it was."""
    known = [*before, *[0.0] * len(after)]
    return any(new > max(thickness, old + MORE * thickness) for old, new in zip(known, after))


def tunnelling(bodies: Sequence[Body], depths: Sequence[float]) -> list[bool]:
    """Whether each body of numbers, so deep [m] in the cloth, comes through between the corners of its triangles."""
    return [depth > TUNNELLING_DEPTH * size_of(body) for body, depth in zip(bodies, depths)]
