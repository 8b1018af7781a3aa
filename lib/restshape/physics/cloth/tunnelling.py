"""Cloth in bodies: how deep its triangles are below a surface, and bodies that come through."""

import math
from collections.abc import Sequence

import numpy as np

from restshape.physics.cloth.contact import Contact
from restshape.physics.cloth.mesh_bodies import distance_of
from restshape.scene.bodies import Body

TUNNELLING_DEPTH = 0.5
"""Part of a body's smallest size by which it is deeper in a triangle where it comes through; less is a chord's sag."""
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


def penetrations(contact: Contact, x: np.ndarray) -> list[float]:
    """How far [m] the deepest place of the triangles of cloth at x (n, 3) [m] is in each body; 0 where none is."""
    tolerance = EXACT * contact.thickness
    return [max(0.0, -float(body.lowest(x, contact.cells, tolerance)[0])) for body in contact.bodies]


def tunnelling(bodies: Sequence[Body], depths: Sequence[float]) -> list[bool]:
    """Whether each body of numbers, so deep [m] in the cloth, comes through between the corners of its triangles."""
    return [depth > TUNNELLING_DEPTH * size_of(body) for body, depth in zip(bodies, depths)]
