"""Whether a scene's cloth may touch itself, and from which distance on."""

from typing import Any

from restshape.scene.model import Scene

THICKNESS = 2e-3
"""Distance [m] at which contact begins where neither the scene nor a fine mesh says less."""
FINE = 10.0
"""Mesh size over the distance at which contact begins: folds of cloth are rounder than that by far."""
DIRECTIONS = frozenset("xyz")


def constrained_all_around(scene: Scene) -> bool:
    """Whether supports hold all of the outline where it is."""
    names: set[str] = set()
    for support in scene.supports.values():
        if support.fix.keys() >= DIRECTIONS:
            names |= {support.on} if isinstance(support.on, str) else set(support.on)
    return bool(names & {"outline", "all"}) or bool(scene.shape.outline and set(scene.shape.outline) <= names)


def touches_itself(scene: Scene) -> str:
    """Why the cloth of a scene may touch itself, for people; empty where it cannot, or is not to."""
    wanted = scene.effects.get("contact", {}).get("self")
    if wanted is not None:
        return "the scene says so in effects.contact.self" if wanted else ""
    return "" if constrained_all_around(scene) else "the outline is not held all around: parts of the cloth may meet"


def layer_thickness(scene: Scene, settings: Any) -> float:
    """Distance [m] at which contact of the cloth with itself begins.

    Args:
        scene: of cloth.
        settings: of contact; None: the scene has none.
    """
    if settings and settings.self_thickness is not None:
        return settings.self_thickness
    usual = settings.thickness if settings else THICKNESS
    return min(usual, scene.mesh.size / FINE) if scene.mesh.size else usual
