"""Garments that may slide off their bodies: nothing holds them, and no body has friction."""

from __future__ import annotations

from restshape.scene.held_point import hold_of
from restshape.scene.model import Scene


def slipping_words(scene: Scene) -> list[str]:
    """What there is to doubt of a sewn scene whose cloth neither supports nor friction hold."""
    if not scene.seams or not scene.bodies or scene.supports or hold_of(scene) is not None:
        return []
    if any(body.friction != 0.0 for body in scene.bodies.values()):
        return []
    first = next(iter(scene.bodies))
    return [f"no support holds the garment, and no body has friction: it may slide off; set bodies.{first}.friction"]
