"""Parts of the physics that follow from a scene without being named among its effects."""

from collections.abc import Callable
from typing import Any

from restshape.application import Implied
from restshape.scene.model import Scene

Tables = dict[str, Any]
On = frozenset[str]

LARGE = "large_deformation"


def _listed(table: str, names: list[str]) -> str:
    """Keys of a table of the scene, for people; empty where there are none."""
    return ", ".join(f"{table}.{name}" for name in names)


def _loads(scene: Scene, kinds: tuple[str, ...]) -> str:
    return _listed("loads", [name for name, load in scene.loads.items() if load.kind in kinds])


def _dead(on: On) -> tuple[str, ...]:
    """The kinds of loads on points and edges that do not follow the boundary."""
    return ("force", "traction") if LARGE in on else ("force", "traction", "pressure")


def _without_loads(raw: Tables, kinds: tuple[str, ...]) -> Tables:
    loads = {name: load for name, load in raw.get("loads", {}).items() if not set(kinds) & set(load)}
    return {**raw, "loads": loads}


def _moved(scene: Scene) -> list[str]:
    """Supports that prescribe a displacement."""
    return [name for name, support in scene.supports.items() if any(value != 0 for value in support.fix.values())]


def _held_still(raw: Tables, _: On) -> Tables:
    supports = {
        name: {**held, "fix": dict.fromkeys(held["fix"], 0.0)} if "fix" in held else held
        for name, held in raw["supports"].items()
    }
    return {**raw, "supports": supports}


def _regions(scene: Scene, _: On) -> str:
    names = [name for name, material in scene.material.items() if material.region]
    return f"{_listed('material', names)} fill regions: each cell has its own material" if names else ""


def _one_material(raw: Tables, _: On) -> Tables:
    """The material outside of regions everywhere; where there is none, the first one."""
    materials = raw["material"]
    rest = next((name for name, material in materials.items() if "region" not in material), next(iter(materials)))
    alone = {key: value for key, value in materials[rest].items() if key != "region"}
    return {**raw, "material": {rest: alone}}


def _grain(scene: Scene, _: On) -> str:
    return _listed("material", [name for name, material in scene.material.items() if material.orthotropic])


def _rough(scene: Scene) -> list[str]:
    """Bodies with friction."""
    return [name for name, body in scene.bodies.items() if body.friction != 0]


def _smooth_bodies(raw: Tables, _: On) -> Tables:
    return {**raw, "bodies": {name: {**body, "friction": 0.0} for name, body in raw.get("bodies", {}).items()}}


def _mirrors(scene: Scene) -> str:
    return _listed("supports", [name for name, support in scene.supports.items() if support.symmetry])


def _stresses(scene: Scene) -> str:
    return _listed("quantities", [name for name, quantity in scene.quantities.items() if quantity.stress])


def _without_stresses(raw: Tables, _: On) -> Tables:
    kept = {name: quantity for name, quantity in raw.get("quantities", {}).items() if "stress" not in quantity}
    return {**raw, "quantities": kept}


def _cause(names: Callable[[Scene, On], str], what: str) -> Callable[[Scene, On], str]:
    """Why a scene calls for a part: the keys that do, and what they make of it; empty where there are none."""

    def cause(scene: Scene, on: On) -> str:
        found = names(scene, on)
        return f"{found}: {what}" if found else ""

    return cause


def _following(scene: Scene, on: On) -> str:
    return _loads(scene, ("pressure",)) if LARGE in on else ""


SURFACE_LOADS = Implied(
    "dead loads on points and edges",
    _cause(lambda scene, on: _loads(scene, _dead(on)), "loads that keep their direction"),
    "the scene has no such load",
    lambda raw, on: _without_loads(raw, _dead(on)),
    drives=True,
)
FOLLOWING_PRESSURE = Implied(
    "pressures that follow the deformed boundary",
    _cause(_following, "under large deformation pressures follow the boundary, and add to the tangent"),
    "it takes a pressure and large deformation",
    lambda raw, _: _without_loads(raw, ("pressure",)),
    drives=True,
    needs=LARGE,
)
BODY_FORCE = Implied(
    "forces on the body by its volume",
    _cause(lambda scene, _: _loads(scene, ("body",)), "forces by volume"),
    "the scene has no body force",
    lambda raw, _: _without_loads(raw, ("body",)),
    drives=True,
)
MOVING_SUPPORTS = Implied(
    "supports that displace what they hold",
    _cause(lambda scene, _: _listed("supports", _moved(scene)), "they displace what they hold"),
    "no support prescribes a displacement",
    _held_still,
    drives=True,
)
REGIONS = Implied("materials of regions", _regions, "one material fills the shape", _one_material)
GRAIN = Implied(
    "materials with a grain", _cause(_grain, "stiffness along and across a grain"), "all materials are isotropic"
)
FRICTION = Implied(
    "friction of bodies",
    _cause(lambda scene, _: _listed("bodies", _rough(scene)), "anchors hold what touches them"),
    "no body has friction",
    _smooth_bodies,
    needs="contact",
)
SYMMETRY = Implied(
    "planes of symmetry",
    _cause(lambda scene, _: _mirrors(scene), "half of the cloth stands for both"),
    "no edge is on a plane of symmetry",
)
STRESSES = Implied(
    "stresses recovered at nodes",
    _cause(lambda scene, _: _stresses(scene), "a stress is asked for"),
    "no quantity is a stress",
    _without_stresses,
)

SOLID = {
    "surface_loads": SURFACE_LOADS,
    "following_pressure": FOLLOWING_PRESSURE,
    "body_force": BODY_FORCE,
    "moving_supports": MOVING_SUPPORTS,
    "regions": REGIONS,
    "stresses": STRESSES,
}
"""What follows from scenes of solids in the plane."""

CLOTH = {
    "friction": FRICTION,
    "grain": GRAIN,
    "symmetry": SYMMETRY,
    "moving_supports": MOVING_SUPPORTS,
    "regions": REGIONS,
}
"""What follows from scenes of cloth."""
