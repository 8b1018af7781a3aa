"""Parts of cloth that follow from a scene without being named among its effects."""

from restshape.physics.cloth.self_contact.touching_itself import touches_itself
from restshape.physics.elasticity.elasticity_derived_effects import GRAIN
from restshape.scene.derived_effects import MOVING_SUPPORTS, REGIONS, On, cause_of, listed
from restshape.scene.effect import DerivedEffect
from restshape.scene.model import Scene
from restshape.scene.plain_values import Table, tables_in


def _rough(scene: Scene) -> list[str]:
    """Bodies with friction."""
    return [name for name, body in scene.bodies.items() if body.friction != 0]


def _smooth_bodies(raw: Table, _: On) -> Table:
    return {**raw, "bodies": {name: {**body, "friction": 0.0} for name, body in tables_in(raw, "bodies").items()}}


def _mirrors(scene: Scene) -> str:
    return listed("supports", [name for name, support in scene.supports.items() if support.symmetry])


def _through_itself(raw: Table, on: On) -> Table:
    """The scene with cloth that passes through itself; without bodies that nothing touches, as contact is named."""
    effects = tables_in(raw, "effects")
    rest = raw if "contact" in on else {key: value for key, value in raw.items() if key != "bodies"}
    return {**rest, "effects": {**effects, "contact": {**effects.get("contact", {}), "self": False}}}


FRICTION = DerivedEffect(
    "friction of bodies",
    cause_of(lambda scene, _: listed("bodies", _rough(scene)), "anchors hold what touches them"),
    "no body has friction",
    _smooth_bodies,
    needs="contact",
    remembers=True,
)
SYMMETRY = DerivedEffect(
    "planes of symmetry",
    cause_of(lambda scene, _: _mirrors(scene), "half of the cloth stands for both"),
    "no edge is on a plane of symmetry",
)
SELF_CONTACT = DerivedEffect(
    "contact of the cloth with itself",
    lambda scene, _: touches_itself(scene),
    "the outline is held all around, or effects.contact.self is false",
    _through_itself,
)
CLOTH = {
    "friction": FRICTION,
    "self_contact": SELF_CONTACT,
    "grain": GRAIN,
    "symmetry": SYMMETRY,
    "moving_supports": MOVING_SUPPORTS,
    "regions": REGIONS,
}
"""What follows from scenes of cloth."""
