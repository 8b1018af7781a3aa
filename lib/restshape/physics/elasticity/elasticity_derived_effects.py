"""Parts of elasticity that follow from a scene without being named among its effects."""

from restshape.scene.derived_effects import (
    MOVING_SUPPORTS,
    REGIONS,
    On,
    cause_of,
    listed,
    loads_of,
    without_loads,
)
from restshape.scene.effect import DerivedEffect
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table, table_in, tables_in

LARGE = "large_deformation"


def _dead(on: On) -> tuple[str, ...]:
    """The kinds of loads on points and edges that do not follow the boundary."""
    return ("force", "traction") if LARGE in on else ("force", "traction", "pressure")


def _grain(scene: Scene, _: On) -> str:
    return listed("material", [name for name, material in scene.material.items() if material.orthotropic])


def _stresses(scene: Scene) -> str:
    return listed("quantities", [name for name, quantity in scene.quantities.items() if quantity.stress])


def _without_stresses(raw: Table, _: On) -> Table:
    stresses = {name for name, quantity in tables_in(raw, "quantities").items() if "stress" in quantity}
    kept = {name: one for name, one in table_in(raw, "quantities").items() if name not in stresses}
    return {**raw, "quantities": kept}


def _follower(scene: Scene, on: On) -> str:
    return loads_of(scene, ("pressure",)) if LARGE in on else ""


SURFACE_LOADS = DerivedEffect(
    "dead loads on points and edges",
    cause_of(lambda scene, on: loads_of(scene, _dead(on)), "loads that keep their direction"),
    "the scene has no such load",
    lambda raw, on: without_loads(raw, _dead(on)),
    drives=True,
)
FOLLOWER_PRESSURE = DerivedEffect(
    "follower loads: pressures on the deformed boundary",
    cause_of(_follower, "under large deformation pressures follow the boundary, and add to the tangent"),
    "it takes a pressure and large deformation",
    lambda raw, _: without_loads(raw, ("pressure",)),
    drives=True,
    needs=LARGE,
)
BODY_FORCE = DerivedEffect(
    "forces on the body by its volume",
    cause_of(lambda scene, _: loads_of(scene, ("body",)), "forces by volume"),
    "the scene has no body force",
    lambda raw, _: without_loads(raw, ("body",)),
    drives=True,
)
GRAIN = DerivedEffect(
    "materials with a grain", cause_of(_grain, "stiffness along and across a grain"), "all materials are isotropic"
)
STRESSES = DerivedEffect(
    "stresses recovered at nodes",
    cause_of(lambda scene, _: _stresses(scene), "a stress is asked for"),
    "no quantity is a stress",
    _without_stresses,
)

SOLID = {
    "surface_loads": SURFACE_LOADS,
    "following_pressure": FOLLOWER_PRESSURE,
    "body_force": BODY_FORCE,
    "moving_supports": MOVING_SUPPORTS,
    "regions": REGIONS,
    "stresses": STRESSES,
}
"""What follows from scenes of solids in the plane."""
