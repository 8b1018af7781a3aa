"""Half-spaces that leave cloth which begins inside them, where the nearest way out would fold it through itself."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.contact.out_of_bodies import LEAST, Bodies
from restshape.scene.bodies import POINTS, Body


def retreats(problem: ClothProblem, forms: Sequence[Body], placed: np.ndarray, out: np.ndarray) -> np.ndarray | None:
    """Ways (k, 3) [m] by which half-spaces leave cloth; None where cloth leaves all bodies by itself.

    A curtain that is too long for its floor is pressed flat by the nearest way out. Here the floor goes down instead,
    and comes up again under the cloth that hangs from its supports. Pieces without supports would fall meanwhile. Other
    bodies stay: on their way back they might come through, for what lies around them goes out on more than one side.

    Args:
        forms: of the bodies, of numbers.
        placed: (corners, 3) [m] where the cloth begins; out: where the nearest ways out bring it.
    """
    contact = problem.contact
    if not contact or not problem.self_contact or problem.ordered_layers or np.array_equal(placed, out):
        return None
    pieces, mask = problem.mesh.node_piece, problem.boundary.mask[problem.corner_number].any(axis=1)
    if len(np.unique(pieces[mask])) < len(np.unique(pieces)):
        return None
    if not problem.surface.crosses(out) or problem.surface.crosses(placed):
        return None
    found, still = np.zeros((len(forms), 3)), []
    for k, form in enumerate(forms):
        distance, away = Bodies(contact.bodies[k : k + 1]).distance(placed)
        if form.kind == "plane":
            found[k] = min(distance.min() - contact.thickness, 0.0) * away[0]
        else:
            still.append(distance.min() > -LEAST * contact.thickness)
    return found if found.any() and all(still) else None


def shifted(body: Body, way: np.ndarray) -> Body:
    """A body of numbers that has gone a way (3,) [m]."""
    places = {key: tuple(np.array(getattr(body.form, key)) + way) for key in POINTS[body.kind]}
    return body.model_copy(update={body.kind: body.form.model_copy(update=places)})
