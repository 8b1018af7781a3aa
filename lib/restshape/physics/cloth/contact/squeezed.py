"""Cloth that starts between bodies which overlap there: none of them can let it out."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from restshape import _kernels
from restshape.errors import UserError
from restshape.physics.cloth.contact.contact import Contact
from restshape.physics.cloth.contact.contact_points import ContactPoints
from restshape.scene.bodies import Body

PARTS = 4
"""Parts of a triangle's side between whose ends places are looked at."""
OPPOSED = -0.5
"""Cosine of the angle between the ways out of two bodies below which one leads into the other."""
ROUNDING = 1e-6
"""Depth over the thickness of contact that is rounding: bodies that touch do not overlap."""


def refuse_squeezed(contact: Contact, x: np.ndarray, bodies: Mapping[str, Body]) -> None:
    """Refuse cloth at x (n, 3) [m] of which a place is within two bodies that push it towards each other.

    A place within one of them alone counts too where the shortest way out of that one ends in the other.

    Raises:
        UserError: names both, and the place.
    """
    assert contact.cells is not None, "without triangles there is no cloth"
    places = ContactPoints(contact.cells, np.full(len(contact.cells), PARTS)).place(x)
    found = [body.distance(places)[:2] for body in contact.bodies]
    least = ROUNDING * contact.thickness
    for (one, first), (other, second) in combinations(zip(bodies, range(len(found))), 2):
        (d, n), (e, m) = found[first], found[second]
        within = (d < 0.0) & (e < 0.0) & (np.einsum("pa,pa->p", n, m) < OPPOSED)
        out = _leads_into(contact.bodies[second], places, d, n) < -least
        out |= _leads_into(contact.bodies[first], places, e, m) < -least
        squeezed = np.flatnonzero(within | out)
        if len(squeezed):
            worst = squeezed[np.argmin((d + e)[squeezed])]
            at = ", ".join(f"{value:.3g}" for value in places[worst])
            raise UserError(
                f"bodies.{one} and bodies.{other} overlap where the cloth starts, and hold it between them at ({at}) m",
                f"bodies.{other}",
                "move one of them, or the cloth by start.move, so that it starts outside of one of them",
            )


def _leads_into(body: _kernels.Body, places: np.ndarray, depth: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """The distance (p,) [m] from a body at the ends of ways out of another one that lead towards it; elsewhere inf.

    Args:
        body: that ways may lead into.
        places: (p, 3) [m] where they begin.
        depth, normal: (p,) [m] and (p, 3), signed distance from the other body, and its gradient.
    """
    found, inside = np.full(len(places), np.inf), np.flatnonzero(depth < 0.0)
    if len(inside):
        ends = places[inside] - depth[inside, None] * normal[inside]
        distance, away = body.distance(ends)[:2]
        opposed = np.einsum("pa,pa->p", away, normal[inside]) < OPPOSED
        found[inside] = np.where(opposed, distance, np.inf)
    return found
