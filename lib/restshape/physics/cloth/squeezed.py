"""Cloth that starts between bodies which overlap there: none of them can let it out."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations

import numpy as np

from restshape.errors import UserError
from restshape.physics.cloth.contact import Contact
from restshape.physics.cloth.contact_points import ContactPoints
from restshape.scene.bodies import Body

PARTS = 4
"""Parts of a triangle's side between whose ends places are looked at."""
OPPOSED = -0.5
"""Cosine of the angle between the ways out of two bodies below which one leads into the other."""


def refuse_squeezed(contact: Contact, x: np.ndarray, bodies: Mapping[str, Body]) -> None:
    """Refuse cloth at x (n, 3) [m] of which a place is within two bodies that push it towards each other.

    Raises:
        UserError: names both, and the place.
    """
    assert contact.cells is not None, "without triangles there is no cloth"
    places = ContactPoints(contact.cells, np.full(len(contact.cells), PARTS)).place(x)
    found = [body.distance(places)[:2] for body in contact.bodies]
    for (one, (d, n)), (other, (e, m)) in combinations(zip(bodies, found), 2):
        squeezed = np.flatnonzero((d < 0.0) & (e < 0.0) & (np.einsum("pa,pa->p", n, m) < OPPOSED))
        if len(squeezed):
            worst = squeezed[np.argmin(np.maximum(d, e)[squeezed])]
            at = ", ".join(f"{value:.3g}" for value in places[worst])
            raise UserError(
                f"bodies.{one} and bodies.{other} overlap where the cloth starts, and hold it between them at ({at}) m",
                f"bodies.{other}",
                "move one of them, or the cloth by start.move, so that it starts outside of one of them",
            )
