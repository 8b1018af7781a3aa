"""Bodies that leave cloth which begins inside them, where the nearest way out would fold it through itself."""

from __future__ import annotations

import numpy as np

from restshape import _kernels
from restshape.physics.cloth.cloth_problem import ClothProblem
from restshape.physics.cloth.out_of_bodies import LEAST, MARCHES, Bodies
from restshape.scene.bodies import POINTS, Body


def retreats(problem: ClothProblem, placed: np.ndarray, out: np.ndarray) -> np.ndarray | None:
    """Ways (k, 3) [m] by which bodies leave cloth; None where cloth leaves them, or no way of theirs is known.

    A curtain that is too long for its floor is pressed flat by the nearest way out. Here the floor goes down instead,
    and comes up again under the cloth that hangs from its supports. Without supports it would fall meanwhile.

    Args:
        placed: (corners, 3) [m] where the cloth begins; out: where the nearest ways out bring it.
    """
    contact = problem.contact
    if not contact or not problem.self_contact or not len(problem.boundary.constrained):
        return None
    if problem.ordered_layers or np.array_equal(placed, out):
        return None
    if not problem.surface.crosses(out) or problem.surface.crosses(placed):
        return None
    size = float(np.linalg.norm(np.ptp(placed, axis=0)))
    found = [_retreat(body, placed, contact.thickness, size) for body in contact.bodies]
    return None if any(way is None for way in found) else np.array(found)


def _retreat(body: _kernels.Body, x: np.ndarray, thickness: float, most: float) -> np.ndarray | None:
    """The way (3,) [m] on which a body leaves cloth at x (n, 3): against the mean of the cloth's nearest ways out.

    Zero where the cloth is not in it; None where the body is still in it after the way `most` [m].
    """
    alone = Bodies([body])
    distance, away = alone.distance(x)
    inside = distance < 0.0
    if distance.min() > -LEAST * thickness:
        return np.zeros(3)
    way = (distance[inside, None] * away[inside]).sum(axis=0)
    if not (length := float(np.linalg.norm(way))):
        return None
    way, gone = way / length, 0.0
    for _ in range(MARCHES):
        # The body that goes a way meets what cloth meets that goes the opposite one.
        short = thickness - float(alone.distance(x - gone * way)[0].min())
        if short <= 0.0:
            return gone * way
        gone += max(short, LEAST * thickness)
        if gone > most:
            return None
    return None


def shifted(body: Body, way: np.ndarray) -> Body:
    """A body of numbers that has gone a way (3,) [m]."""
    places = {key: tuple(np.array(getattr(body.form, key)) + way) for key in POINTS[body.kind]}
    return body.model_copy(update={body.kind: body.form.model_copy(update=places)})
