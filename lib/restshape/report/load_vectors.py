"""Which way loads and accelerations act, of a scene at places of its shape."""

from collections.abc import Sequence

import numpy as np

from restshape.application import application_of
from restshape.errors import ReplayProblem, UserError
from restshape.fem.nodal_values import Nodal, evaluate
from restshape.report.entity_outlines import Place
from restshape.scene.model import Load, Scene


def accelerations(scene: Scene) -> dict[str, Sequence[object]]:
    """Accelerations of all bodies, such as gravity, by the effect: vectors of numbers [m/s^2] and formulas."""
    known = {name: effect for name, effect in application_of(scene).effects.items() if effect.acceleration}
    named = {name: effect for name, effect in known.items() if name in scene.effects}
    return {
        name: getattr(one.model.model_validate(scene.effects[name]), one.acceleration) for name, one in named.items()
    }


def in_plane(scene: Scene, name: str, value: Sequence[object]) -> np.ndarray:
    """The components (2,) in the plane of a vector of an effect; 0 where the replay refuses it."""
    try:
        return evaluate(list(value), np.zeros((1, 2)), scene.parameters, f"effects.{name}")[0, :2]
    except (ReplayProblem, UserError):
        return np.zeros(2)


def load_vectors(scene: Scene, key: str, load: Load, place: Place, inside: bool) -> np.ndarray | None:
    """Which way a load acts at the points of a place, or inside it (1, 2); None where it is no vector.

    Its size counts against that at the other points alone.
    """
    value, where = getattr(load, load.kind), f"loads.{key}.{load.kind}"
    at = place.inside[None] if inside else place.at
    try:
        if isinstance(value, tuple | list) and len(value) == 2:
            return evaluate(value, at, scene.parameters, where)
        if load.kind == "pressure":
            return -place.outwards * Nodal(value, scene.parameters, where)(at)[:, None]
    except (ReplayProblem, UserError):
        # The replay refuses it, and says why.
        return None
    return None
